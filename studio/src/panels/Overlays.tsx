// What opens over the page: the command palette, the sheet of keys, and saving.
import { Command as Palette } from "cmdk";
import { Dialog } from "radix-ui";
import { type FormEvent, type ReactNode, useState } from "react";
import { ask, store } from "../document/store";
import { COMMANDS, type Command, type Group } from "./commands";
import { useDialogs } from "./dialogs";
import { Keys } from "./parts";
import { useStage, useStudio } from "./use";

const GROUPS: Group[] = [
  "Net",
  "Cells",
  "Selecting",
  "Grafting",
  "Choosing",
  "Springs and nodes",
  "Tools",
  "View",
  "Document",
];

export type OpenDialog = "palette" | "keys" | "save" | null;

export function Overlays({ open, onClose }: { open: OpenDialog; onClose(): void }) {
  return (
    <Dialog.Root open={open !== null} onOpenChange={(stays) => !stays && onClose()}>
      <Dialog.Portal>
        <Dialog.Overlay className="veil" />
        {open === "palette" && <CommandPalette onClose={onClose} />}
        {open === "keys" && <KeySheet />}
        {open === "save" && <SaveDialog onClose={onClose} />}
      </Dialog.Portal>
    </Dialog.Root>
  );
}

function CommandPalette({ onClose }: { onClose(): void }) {
  const state = useStudio((all) => all);
  const viewport = useStage()?.viewport ?? null;
  const dialogs = useDialogs();
  const run = (command: Command) => {
    onClose();
    command.run({ viewport, dialogs });
  };
  return (
    <Dialog.Content className="dialog palette" aria-describedby={undefined}>
      <Dialog.Title className="visually-hidden">Find a command</Dialog.Title>
      <Palette label="Find a command">
        <Palette.Input placeholder="What do you want to do?" />
        <Palette.List>
          <Palette.Empty>No command is called that.</Palette.Empty>
          {GROUPS.map((group) => (
            <Palette.Group key={group} heading={group}>
              {COMMANDS.filter(
                (command) => command.group === group && command.id !== "palette",
              ).map((command) => {
                const refused = command.refused?.(state) ?? null;
                return (
                  <Palette.Item
                    key={command.id}
                    value={command.label}
                    disabled={refused !== null}
                    onSelect={() => run(command)}
                  >
                    {command.label}
                    {refused ? (
                      <small>{refused}</small>
                    ) : (
                      command.keys && <Keys keys={command.keys} />
                    )}
                  </Palette.Item>
                );
              })}
            </Palette.Group>
          ))}
        </Palette.List>
      </Palette>
    </Dialog.Content>
  );
}

const MOUSE: [string, string][] = [
  ["Drag a node", "pull the net; let go and it returns"],
  ["Drag an anchor", "move it"],
  ["Drag an arm", "move along x, y or z"],
  ["⇧ while dragging", "up and down only"],
  ["Ctrl while dragging", "level only"],
  ["Click, ⇧ click", "select, add to the selection"],
  ["Right button", "what can be done here"],
  ["Drag beside the net", "orbit"],
  ["Middle drag, ⇧ drag", "pan"],
  ["Wheel", "zoom to the pointer"],
  ["⇧ click an individual", "mark it for a comparison"],
];

function KeySheet() {
  return (
    <Dialog.Content className="dialog sheet" aria-describedby={undefined}>
      <Dialog.Title>Keys and mouse</Dialog.Title>
      <div className="sheet-columns">
        <SheetPart title="Mouse">
          {MOUSE.map(([what, does]) => (
            <SheetLine key={what} what={does} keys={<b>{what}</b>} />
          ))}
        </SheetPart>
        {GROUPS.map((group) => (
          <SheetPart key={group} title={group}>
            {COMMANDS.filter((command) => command.group === group && command.keys).map(
              ({ id, label, keys }) => (
                <SheetLine key={id} what={label} keys={<Keys keys={keys!} />} />
              ),
            )}
          </SheetPart>
        ))}
      </div>
      <Dialog.Close className="button">Close</Dialog.Close>
    </Dialog.Content>
  );
}

function SheetPart({ title, children }: { title: string; children: ReactNode }) {
  return (
    <section>
      <h3>{title}</h3>
      {children}
    </section>
  );
}

function SheetLine({ what, keys }: { what: string; keys: ReactNode }) {
  return (
    <div className="sheet-line">
      <span>{what}</span>
      {keys}
    </div>
  );
}

function SaveDialog({ onClose }: { onClose(): void }) {
  const document = useStudio((state) => state.document);
  const [path, setPath] = useState(
    document?.file ?? `${document?.name.replaceAll(" ", "-") ?? "net"}.toml`,
  );
  const [replace, setReplace] = useState(false);
  const [problem, setProblem] = useState("");
  const save = async (event: FormEvent) => {
    event.preventDefault();
    const before = store.getState().notice;
    const reply = await ask({ type: "save", path, replace }, "Saving");
    const { notice } = store.getState();
    if (reply) onClose();
    else if (notice && notice !== before) setProblem(notice.text);
  };
  return (
    <Dialog.Content className="dialog save" aria-describedby={undefined}>
      <Dialog.Title>Save as a design file</Dialog.Title>
      <form onSubmit={save}>
        <p className="explain">
          The studio keeps everything anyway; a file is for the command line, and for others. It
          ends in .toml or .json.
        </p>
        <label className="path-field">
          Path on this machine
          <input value={path} onChange={(event) => setPath(event.target.value)} />
        </label>
        <label className="check">
          <input
            type="checkbox"
            checked={replace}
            onChange={(event) => setReplace(event.target.checked)}
          />
          Replace a file that is there
        </label>
        {problem && (
          <p className="problem" role="alert">
            {problem}
          </p>
        )}
        <div className="row end">
          <Dialog.Close className="button">Cancel</Dialog.Close>
          <button type="submit" className="button primary">
            Save
          </button>
        </div>
      </form>
    </Dialog.Content>
  );
}
