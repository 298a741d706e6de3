// The start: scenes with their pictures, documents worked on before, and a file by its path.
import { Trash2 } from "lucide-react";
import { type FormEvent, useEffect, useState } from "react";
import { toast } from "sonner";
import { ask } from "../document/store";
import { documentInAddress } from "../protocol/address";
import { fetchShelf, openSource, removeDocument } from "../protocol/fetching";
import type { DocumentEntry, Shelf } from "../protocol/messages";
import { FolderList } from "./FolderList";
import { Hint } from "./parts";
import { Thumbnail } from "./Thumbnail";

const FEW = 6;

export function StartPage() {
  const [shelf, setShelf] = useState<Shelf | null>(null);
  const [problem, setProblem] = useState("");
  const [fileProblem, setFileProblem] = useState("");
  const [opening, setOpening] = useState(false);
  const [path, setPath] = useState("");
  const [all, setAll] = useState(false);
  useEffect(() => {
    fetchShelf().then(setShelf, (error: Error) => setProblem(error.message));
  }, []);
  const open = async (source: string, tell: (problem: string) => void) => {
    setOpening(true);
    tell("");
    try {
      const { id, went_on } = await openSource(source);
      location.hash = id;
      if (went_on) tellWentOn(source.split("/").pop() ?? source);
    } catch (error) {
      tell((error as Error).message);
    }
    setOpening(false);
  };
  const remove = async (id: string) => {
    try {
      await removeDocument(id);
      setShelf(await fetchShelf());
    } catch (error) {
      setProblem((error as Error).message);
    }
  };
  const submit = (event: FormEvent) => {
    event.preventDefault();
    if (path.trim()) open(path.trim(), setFileProblem);
  };
  return (
    <main className="start">
      <div className="start-inner">
        <h1>Start with a net</h1>
        <p className="lead">
          Pull it, cut it, refine it: the net finds its equilibrium while you work. Everything you
          do is kept at once and can be undone, today or next week.
        </p>
        {problem && (
          <p className="problem" role="alert">
            {problem}
          </p>
        )}
        {shelf && shelf.documents.length > 0 && (
          <section aria-labelledby="recent">
            <h2 id="recent">Go on with</h2>
            <ul className="recent">
              {shelf.documents.slice(0, all ? undefined : FEW).map((entry) => (
                <Recent key={entry.id} entry={entry} onRemove={remove} />
              ))}
            </ul>
            {!all && shelf.documents.length > FEW && (
              <button type="button" className="button" onClick={() => setAll(true)}>
                All {shelf.documents.length} documents
              </button>
            )}
          </section>
        )}
        {shelf && (
          <section aria-labelledby="scenes">
            <h2 id="scenes">New from a scene</h2>
            <ul className="scenes">
              {shelf.scenes.map(({ name, description }) => (
                <li key={name}>
                  <button type="button" onClick={() => open(name, setProblem)} disabled={opening}>
                    <Thumbnail path={`/api/scenes/${name}/picture`} width={256} height={172} />
                    <b>{name.replaceAll("-", " ")}</b>
                    <small>{description}</small>
                  </button>
                </li>
              ))}
            </ul>
          </section>
        )}
        <section aria-labelledby="file">
          <h2 id="file">Open a file</h2>
          <form className="open-file" onSubmit={submit}>
            <input
              aria-label="Path of a design file or a run folder on this machine"
              placeholder="Path of a design (.toml, .json) or a run folder"
              value={path}
              onChange={(event) => setPath(event.target.value)}
            />
            <button type="submit" className="button primary" disabled={!path.trim() || opening}>
              Open
            </button>
          </form>
          {fileProblem && (
            <p className="problem" role="alert" ref={intoView}>
              {fileProblem}
            </p>
          )}
          <FolderList onPick={(found) => open(found, setFileProblem)} />
        </section>
      </div>
    </main>
  );
}

/** A document; its picture, and a button that removes it when it is pressed twice. */
function Recent({ entry, onRemove }: { entry: DocumentEntry; onRemove(id: string): void }) {
  const { id, name, file, changed } = entry;
  const [sure, setSure] = useState(false);
  return (
    <li>
      <a href={`${location.search}#${id}`} aria-current={id === documentInAddress()}>
        <Thumbnail
          path={`/api/documents/${id}/picture`}
          revision={String(changed)}
          width={72}
          height={52}
        />
        <span>
          <b>{name}</b>
          <small>{file ?? "kept on this machine"}</small>
          <time dateTime={new Date(changed * 1000).toISOString()}>{ago(changed)}</time>
        </span>
      </a>
      <Hint text={sure ? "It can't be brought back; its file stays" : `Remove ${name}`}>
        <button
          type="button"
          className={sure ? "button remove" : "icon-button remove"}
          aria-label={sure ? `Remove ${name} for good` : `Remove ${name}`}
          onBlur={() => setSure(false)}
          onClick={() => (sure ? onRemove(id) : setSure(true))}
        >
          {sure ? "Remove" : <Trash2 />}
        </button>
      </Hint>
    </li>
  );
}

function intoView(element: HTMLElement | null): void {
  element?.scrollIntoView({ block: "nearest" });
}

/** Says that a document is ahead of its file, and offers to go back to it. */
function tellWentOn(file: string): void {
  toast.message(`You went on after ${file} was saved: this is what you made of it.`, {
    action: {
      label: "Back to the file",
      onClick: () => void ask({ type: "revert" }, "Reading the file"),
    },
    duration: 15_000,
  });
}

function ago(seconds: number): string {
  const past = Date.now() / 1000 - seconds;
  if (past < 60) return "just now";
  if (past < 3600) return `${Math.round(past / 60)} min ago`;
  if (past < 86_400) return `${Math.round(past / 3600)} h ago`;
  return new Date(seconds * 1000).toLocaleDateString("en", {
    day: "numeric",
    month: "short",
    year: "numeric",
  });
}
