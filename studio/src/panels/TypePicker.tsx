// The type of the selected cells: each that can be given, with its picture, tried while the pointer rests on it.
import { typeName } from "../document/cellTypes";
import { grafting } from "../document/grafting";
import type { CellTypeChoice } from "../protocol/messages";
import { retype } from "./commands";
import { foreseen } from "./foreseen";

/** Points of a cell on a square of 20: corners, middles of sides, centre. */
const POINTS: Record<string, [number, number]> = {
  c0: [2, 18],
  c1: [18, 18],
  c2: [18, 2],
  c3: [2, 2],
  m0: [10, 18],
  m1: [18, 10],
  m2: [10, 2],
  m3: [2, 10],
  x: [10, 10],
};

/** Springs of the built-in types within their outline, from point to point. */
const WITHIN: Record<string, string> = {
  "1": "",
  "2": "x-c0 x-c1 x-c2 x-c3",
  "3": "c0-c2",
  "4": "m0-m2",
  "5": "m0-m1 m1-m2 m2-m3 m3-m0",
  "6": "x-c0 x-c1 x-c2 x-c3 x-m0 x-m1 x-m2 x-m3",
};

export function TypePicker({
  cells,
  kind,
  types,
}: {
  cells: string[];
  /** Type that all of them have; empty if they differ. */
  kind: string;
  types: CellTypeChoice[];
}) {
  return (
    <fieldset className="types" aria-label="Type">
      <legend>Type{kind ? "" : ": mixed"}</legend>
      {types.map(({ word }) => (
        <button
          key={word}
          type="button"
          className="type"
          aria-pressed={word === kind}
          {...(word === kind
            ? {}
            : foreseen(`type ${typeName(word)}`, {
                type: "edit_cells",
                what: "retype",
                cells,
                kind: word,
                orbit: grafting.getState().lock,
              }))}
          onClick={() => word !== kind && retype(word)}
        >
          <TypePicture word={word} />
          <span>{typeName(word)}</span>
        </button>
      ))}
    </fieldset>
  );
}

function TypePicture({ word }: { word: string }) {
  const springs = (WITHIN[word] ?? "").split(" ").filter(Boolean);
  return (
    <svg viewBox="0 0 20 20" width="20" height="20" aria-hidden="true">
      <rect
        x="2"
        y="2"
        width="16"
        height="16"
        // What is empty, or of one's own, has no springs that are known here.
        strokeDasharray={word in WITHIN ? undefined : "2 2"}
      />
      {springs.map((spring) => {
        const [from, to] = spring.split("-").map((point) => POINTS[point]);
        return <line key={spring} x1={from[0]} y1={from[1]} x2={to[0]} y2={to[1]} />;
      })}
    </svg>
  );
}
