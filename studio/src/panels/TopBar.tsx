// The bar at the top: the document, undo and redo, and what concerns the whole page.
import {
  CircleHelp,
  FolderOpen,
  ImageDown,
  Moon,
  Redo2,
  Save,
  Search,
  Snowflake,
  Sun,
  Undo2,
} from "lucide-react";
import { commandOf } from "./commands";
import { DocumentMenu } from "./DocumentMenu";
import { useDialogs } from "./dialogs";
import { useGrafting } from "./GraftPanel";
import { toggleLock } from "./graftCommands";
import { Hint, IconButton, Keys } from "./parts";
import { perform } from "./performing";
import { useStage, useStudio } from "./use";

export function TopBar() {
  const document = useStudio((state) => state.document);
  const theme = useStudio((state) => state.theme);
  const dialogs = useDialogs();
  return (
    <header className="top-bar">
      <div className="brand">
        <Mark />
        spring<b>FORM</b>
      </div>
      {document && (
        <>
          <CommandButton id="start" label="Open another document">
            <FolderOpen />
          </CommandButton>
          <Title />
          <div className="gap" />
          <CommandButton id="undo">
            <Undo2 />
          </CommandButton>
          <CommandButton id="redo">
            <Redo2 />
          </CommandButton>
          <Hint text="Every command by its name" keys="Ctrl+K">
            <button
              type="button"
              className="search-button"
              aria-label="Find a command"
              onClick={() => dialogs.open("palette")}
            >
              <Search />
              <span className="words">Find a command</span>
              <Keys keys="Ctrl+K" />
            </button>
          </Hint>
          <div className="gap" />
          <LockButton />
          <CommandButton id="save">
            <Save />
          </CommandButton>
          <CommandButton id="picture">
            <ImageDown />
          </CommandButton>
        </>
      )}
      {!document && <div className="gap" />}
      <CommandButton id="theme" label={theme === "dark" ? "Light" : "Dark"}>
        {theme === "dark" ? <Sun /> : <Moon />}
      </CommandButton>
      <CommandButton id="keys">
        <CircleHelp />
      </CommandButton>
    </header>
  );
}

/** Whether edits go to whole orbits. */
function LockButton() {
  const lock = useGrafting((state) => state.lock);
  return (
    <IconButton
      label="Symmetry lock: edit whole orbits"
      keys="Y"
      pressed={lock}
      onClick={toggleLock}
    >
      <Snowflake />
    </IconButton>
  );
}

/** A button for a command, with its name and keys as the tooltip. */
export function CommandButton({
  id,
  label,
  side,
  children,
}: {
  id: string;
  label?: string;
  side?: "top" | "right" | "bottom" | "left";
  children: React.ReactNode;
}) {
  const command = commandOf(id);
  const refused = useStudio((state) => command.refused?.(state) ?? null);
  const viewport = useStage()?.viewport ?? null;
  const dialogs = useDialogs();
  return (
    <IconButton
      label={label ?? command.label}
      keys={command.keys}
      {...(side ? { side } : {})}
      aria-disabled={refused !== null}
      onClick={() => perform(command, { viewport, dialogs })}
    >
      {children}
    </IconButton>
  );
}

function Title() {
  const document = useStudio((state) => state.document)!;
  const line = useStudio((state) => state.line);
  const file = document.file?.split("/").pop();
  const state =
    line !== "open"
      ? "waiting for the engine …"
      : file
        ? document.saved
          ? `saved as ${file}`
          : `kept; ${file} is older`
        : "kept on this machine";
  return (
    <div className="title">
      <DocumentMenu />
      <span className={line === "open" ? "" : "warning"}>{state}</span>
    </div>
  );
}

function Mark() {
  return (
    <svg
      viewBox="0 0 24 24"
      width="20"
      height="20"
      fill="none"
      stroke="currentColor"
      strokeWidth="1.7"
      strokeLinejoin="round"
      aria-hidden="true"
    >
      <path d="M12 2.5 21.5 12 12 21.5 2.5 12Z" />
      <path d="M12 2.5V21.5M2.5 12H21.5" />
      <path d="M7.2 7.2 16.8 16.8M16.8 7.2 7.2 16.8" opacity=".5" />
    </svg>
  );
}
