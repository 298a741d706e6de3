// What an action would do, over the net while its springs are shown as a ghost.
import { inDigits, inFull } from "../document/scale";
import { useStudio } from "./use";

export function PreviewCard() {
  const preview = useStudio((state) => state.preview);
  const now = useStudio((state) => state.document?.figures);
  if (!preview || !now) return null;
  const { label, state, problem } = preview;
  return (
    <div className="floating preview-card" role="status">
      <b>Would do: {label}</b>
      {state ? (
        <>
          <span className="preview-counts">
            <Count sign="+" count={state.springs_added} of="spring" />
            <Count sign="−" count={state.springs_removed} of="spring" />
            <Count sign="+" count={state.cells_added} of="cell" />
            <Count sign="−" count={state.cells_removed} of="cell" />
            {state.springs_added + state.springs_removed === 0 && <span>no other springs</span>}
          </span>
          <span>
            force differential {inDigits(now.force_differential)} →{" "}
            {inDigits(state.figures.force_differential)}, largest force {inDigits(now.force_max)} →{" "}
            {inDigits(state.figures.force_max)} N
          </span>
        </>
      ) : (
        <span className="warning">{problem}</span>
      )}
    </div>
  );
}

function Count({ sign, count, of }: { sign: "+" | "−"; count: number; of: string }) {
  if (!count) return null;
  return (
    <span className={sign === "+" ? "coming" : "going"}>
      {sign}
      {inFull(count)} {count === 1 ? of : `${of}s`}
    </span>
  );
}
