// What opens over the page: the command palette, the sheet of keys, and saving.
import { Command as Palette } from "cmdk";
import { Dialog } from "radix-ui";
import { type FormEvent, useState } from "react";
import { askQuietly } from "../document/store";
import { COMMANDS, type Command, GROUPS } from "./commands";
import { useDialogs } from "./dialogs";
import { FolderList } from "./FolderList";
import { found } from "./finding";
import { KeySheet } from "./KeySheet";
import { Busy, Keys } from "./parts";
import { perform } from "./performing";
import { useStage, useStudio } from "./use";

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
  const [typed, setTyped] = useState("");
  const run = (command: Command) => {
    onClose();
    perform(command, { viewport, dialogs });
  };
  const commands = COMMANDS.filter(({ id }) => id !== "palette");
  const refusal = (command: Command) => command.refused?.(state) ?? null;
  const item = (command: Command) => {
    const refused = refusal(command);
    return (
      <Palette.Item
        key={command.id}
        value={command.id}
        disabled={refused !== null}
        onSelect={() => run(command)}
      >
        {command.label}
        {refused ? <small>{refused}</small> : command.keys && <Keys keys={command.keys} />}
      </Palette.Item>
    );
  };
  return (
    <Dialog.Content className="dialog palette" aria-describedby={undefined}>
      <Dialog.Title className="visually-hidden">Find a command</Dialog.Title>
      <Palette label="Find a command" shouldFilter={false}>
        <Palette.Input
          placeholder="What do you want to do?"
          value={typed}
          onValueChange={setTyped}
        />
        <Palette.List>
          <Palette.Empty>No command is called that.</Palette.Empty>
          {typed.trim()
            ? found(commands, typed, (command) => refusal(command) !== null).map(item)
            : GROUPS.map((group) => (
                <Palette.Group key={group} heading={group}>
                  {commands.filter((command) => command.group === group).map(item)}
                </Palette.Group>
              ))}
        </Palette.List>
      </Palette>
    </Dialog.Content>
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
    try {
      await askQuietly({ type: "save", path, replace }, "Saving");
      onClose();
    } catch (error) {
      setProblem((error as Error).message);
    }
  };
  return (
    <Dialog.Content className="dialog save" aria-describedby={undefined}>
      <Dialog.Title>Save as a design file</Dialog.Title>
      <form onSubmit={save}>
        <p className="explain">
          The studio keeps everything anyway; a file is for the command line, and for others. The
          net takes the file's name; without an ending it is a .toml file.
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
        <FolderList
          onEnter={(folder) => setPath(`${folder}/${path.split("/").pop()}`)}
          onPick={setPath}
        />
        {problem && (
          <p className="problem" role="alert">
            {problem}
          </p>
        )}
        <div className="row end">
          <Busy />
          <Dialog.Close className="button">Cancel</Dialog.Close>
          <button type="submit" className="button primary">
            Save
          </button>
        </div>
      </form>
    </Dialog.Content>
  );
}
