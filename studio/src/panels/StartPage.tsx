// The start: scenes with their pictures, documents worked on before, and a file by its path.
import { FileText, LoaderCircle } from "lucide-react";
import { type FormEvent, useEffect, useState } from "react";
import { documentInAddress } from "../protocol/address";
import { fetchShelf, openSource } from "../protocol/fetching";
import type { Shelf } from "../protocol/messages";
import { Thumbnail } from "./Thumbnail";

export function StartPage() {
  const [shelf, setShelf] = useState<Shelf | null>(null);
  const [problem, setProblem] = useState("");
  const [fileProblem, setFileProblem] = useState("");
  const [opening, setOpening] = useState("");
  const [path, setPath] = useState("");
  useEffect(() => {
    fetchShelf().then(setShelf, (error: Error) => setProblem(error.message));
  }, []);
  const open = async (source: string, tell: (problem: string) => void) => {
    setOpening(source);
    tell("");
    try {
      location.hash = await openSource(source);
    } catch (error) {
      tell((error as Error).message);
    }
    setOpening("");
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
        {!shelf && !problem && (
          <p className="busy">
            <LoaderCircle /> Loading …
          </p>
        )}
        {shelf && shelf.documents.length > 0 && (
          <section aria-labelledby="recent">
            <h2 id="recent">Go on with</h2>
            <ul className="recent">
              {shelf.documents.slice(0, 6).map(({ id, name, file, changed }) => (
                <li key={id}>
                  <a href={`${location.search}#${id}`} aria-current={id === documentInAddress()}>
                    <FileText />
                    <span>
                      <b>{name}</b>
                      <small>{file ?? "kept on this machine"}</small>
                    </span>
                    <time dateTime={new Date(changed * 1000).toISOString()}>{ago(changed)}</time>
                  </a>
                </li>
              ))}
            </ul>
          </section>
        )}
        {shelf && (
          <section aria-labelledby="scenes">
            <h2 id="scenes">New from a scene</h2>
            <ul className="scenes">
              {shelf.scenes.map(({ name, description }) => (
                <li key={name}>
                  <button
                    type="button"
                    onClick={() => open(name, setProblem)}
                    disabled={opening !== ""}
                  >
                    <Thumbnail path={`/api/scenes/${name}/picture`} width={256} height={172} />
                    <b>
                      {name.replaceAll("-", " ")}
                      {opening === name && <LoaderCircle />}
                    </b>
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
            <button
              type="submit"
              className="button primary"
              disabled={!path.trim() || opening !== ""}
            >
              Open
            </button>
          </form>
          {fileProblem && (
            <p className="problem" role="alert">
              {fileProblem}
            </p>
          )}
        </section>
      </div>
    </main>
  );
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
