// The sheet of keys: all that mouse and keys do, in columns, found by a word or by a key.
import { Search, X } from "lucide-react";
import { Dialog } from "radix-ui";
import { type ReactNode, useState } from "react";
import { COMMANDS, type Group } from "./commands";
import { IconButton, Keys } from "./parts";

const MOUSE: [does: string, what: string][] = [
  ["Pull the net; it returns when let go", "Drag a node"],
  ["Move an anchor", "Drag it"],
  ["Move along x, y or z", "Drag an arm"],
  ["Up and down only", "⇧ drag"],
  ["Level only", "Ctrl drag"],
  ["Select", "Click"],
  ["Add to the selection", "⇧ click"],
  ["What can be done here", "Right button"],
  ["Orbit", "Drag beside the net"],
  ["Pan", "Middle drag"],
  ["Zoom to the pointer", "Wheel"],
  ["Mark an individual for a comparison", "⇧ click it"],
];

/** The columns of the sheet, each about as long as the others. */
const COLUMNS: (Group | "Mouse")[][] = [
  ["Mouse", "Springs and nodes"],
  ["Selecting", "Cells"],
  ["Tools", "Grafting", "Net"],
  ["View", "Document"],
];

interface Line {
  does: string;
  /** How, as it is printed and as it is searched for. */
  how: ReactNode;
  words: string;
}

export function KeySheet() {
  const [wanted, setWanted] = useState("");
  const columns = COLUMNS.map((titles) =>
    titles
      .map((title) => ({ title, lines: linesOf(title).filter((line) => matches(line, wanted)) }))
      .filter(({ lines }) => lines.length > 0),
  );
  const nothing = columns.every((parts) => parts.length === 0);
  return (
    <Dialog.Content className="dialog sheet" aria-describedby={undefined}>
      <header className="sheet-head">
        <Dialog.Title>Keys and mouse</Dialog.Title>
        <label className="sheet-search">
          <Search aria-hidden="true" />
          <input
            value={wanted}
            placeholder="Find an action or a key"
            aria-label="Find an action or a key"
            onChange={(event) => setWanted(event.target.value)}
          />
        </label>
        <Dialog.Close asChild>
          <IconButton label="Close" keys="Escape">
            <X />
          </IconButton>
        </Dialog.Close>
      </header>
      {nothing ? (
        <p className="sheet-empty" role="status">
          No key or mouse action is called that. All actions can be found by name:{" "}
          <Keys keys="Ctrl+K" />
        </p>
      ) : (
        <div className="sheet-columns">
          {columns.map((parts, at) => (
            <div key={COLUMNS[at][0]}>
              {parts.map(({ title, lines }) => (
                <section key={title} aria-label={title}>
                  <h3>{title}</h3>
                  {lines.map(({ does, how }) => (
                    <div key={does} className="sheet-line">
                      <span>{does}</span>
                      {how}
                    </div>
                  ))}
                </section>
              ))}
            </div>
          ))}
        </div>
      )}
    </Dialog.Content>
  );
}

function linesOf(title: Group | "Mouse"): Line[] {
  if (title === "Mouse")
    return MOUSE.map(([does, what]) => ({ does, how: <b>{what}</b>, words: what }));
  return COMMANDS.filter(({ group, keys }) => group === title && keys).map(({ label, keys }) => ({
    does: label,
    how: <Keys keys={keys!} />,
    words: keys!.replace("Shift", "Shift ⇧"),
  }));
}

/** Whether a line is asked for: all words are in what it does or how; a single letter is a key. */
function matches({ does, words }: Line, wanted: string): boolean {
  const asked = wanted.trim().toLowerCase();
  if (asked.length === 1) return words.toLowerCase().split("+").includes(asked);
  const text = `${does} ${words}`.toLowerCase();
  return asked.split(/[\s+]+/).every((word) => text.includes(word));
}
