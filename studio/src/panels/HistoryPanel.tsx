// All that was done, in order; a click goes back or forth to it.
import { GitBranch } from "lucide-react";
import { useEffect, useRef } from "react";
import { ask } from "../document/store";
import { Hint } from "./parts";
import { useStudio } from "./use";

export function HistoryPanel() {
  const { history, position } = useStudio((state) => state.document)!;
  const current = useRef<HTMLButtonElement>(null);
  // biome-ignore lint/correctness/useExhaustiveDependencies: brought into sight when the position changes
  useEffect(() => {
    current.current?.scrollIntoView({ block: "nearest" });
  }, [position]);
  const travel = (to: number) => ask({ type: "travel", position: to }, "Going through the history");
  const first = history[0]?.number ?? 1;
  const entries = [
    ...(first === 1 ? [{ number: 0, label: "Start", origin: null }] : []),
    ...history,
  ];
  return (
    <>
      <p className="explain">
        Kept as you work, and still here after the studio was closed. Click to go back or forth.
      </p>
      <ol className="history" aria-label="History">
        {entries.map(({ number, label, origin }) => (
          <li key={number}>
            <button
              type="button"
              ref={number === position ? current : null}
              aria-current={number === position ? "step" : undefined}
              className={number > position ? "undone" : ""}
              onClick={() => travel(number)}
            >
              <span className="number">{number || ""}</span>
              {label}
              {origin && (
                <Hint text={`Bred in ${origin.run}; its net became the design here`} side="left">
                  <GitBranch
                    className="branch"
                    role="img"
                    aria-label={`branched from ${origin.run}`}
                  />
                </Hint>
              )}
            </button>
          </li>
        ))}
      </ol>
    </>
  );
}
