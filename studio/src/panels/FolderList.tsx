// Folders of this machine: to look for something to open, or a place to save in.
import { ArrowUp, Boxes, FileText, Folder as FolderIcon } from "lucide-react";
import { useEffect, useState } from "react";
import { fetchFolder } from "../protocol/fetching";
import type { Folder, FolderEntry } from "../protocol/messages";

const ICONS = { folder: <FolderIcon />, run: <Boxes />, design: <FileText /> };

export function FolderList({
  onEnter,
  onPick,
}: {
  /** Told of the folder that is shown. */
  onEnter?(path: string): void;
  /** Told of a design or a run that was clicked. */
  onPick(path: string): void;
}) {
  const [folder, setFolder] = useState<Folder | null>(null);
  const [problem, setProblem] = useState("");
  const enter = (path: string) =>
    fetchFolder(path).then(
      (found) => {
        setFolder(found);
        setProblem("");
        if (path) onEnter?.(found.path);
      },
      (error: Error) => setProblem(error.message),
    );
  // biome-ignore lint/correctness/useExhaustiveDependencies: begins where the engine was started, once
  useEffect(() => void enter(""), []);
  const take = ({ name, kind }: FolderEntry) => {
    const path = `${folder!.path === "/" ? "" : folder!.path}/${name}`;
    if (kind === "folder") enter(path);
    else onPick(path);
  };
  return (
    <div className="folder-list">
      <div className="folder-path">
        <button
          type="button"
          className="icon-button"
          aria-label="The folder above"
          disabled={!folder?.parent}
          onClick={() => folder?.parent && enter(folder.parent)}
        >
          <ArrowUp />
        </button>
        <span>
          <bdi>{folder?.path ?? ""}</bdi>
        </span>
      </div>
      {problem && (
        <p className="problem" role="alert">
          {problem}
        </p>
      )}
      <ul aria-label={`Folder ${folder?.path ?? ""}`}>
        {folder?.entries.map((entry) => (
          <li key={entry.name}>
            <button type="button" onClick={() => take(entry)}>
              {ICONS[entry.kind]}
              <span>{entry.name}</span>
              {entry.kind === "run" && <small>run</small>}
            </button>
          </li>
        ))}
        {folder && !folder.entries.length && (
          <li className="folder-empty">No designs or folders here.</li>
        )}
      </ul>
    </div>
  );
}
