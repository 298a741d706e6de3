// What is fetched rather than streamed: scenes, documents and their pictures.
import { engineAddress } from "./address";
import { decodeFrame, type Frame } from "./frames";
import type {
  Brushes,
  Clusters,
  Compared,
  Comparing,
  CurvePoints,
  Folder,
  Lineage,
  Opened,
  Opening,
  Refusal,
  Shelf,
} from "./messages";
import { waited } from "./waits";

interface Fetching {
  /** What somebody waits for meanwhile. */
  label: string;
  options?: RequestInit;
  query?: string;
}

/** Fetches something from the engine and reads it. Throws `Error`: the engine refuses, or is not there. */
function fetched<T>(
  path: string,
  { label, options = {}, query = "" }: Fetching,
  read: (answer: Response) => Promise<T>,
): Promise<T> {
  return waited(label, answer(path, options, query).then(read));
}

async function answer(path: string, options: RequestInit, query: string): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(engineAddress(path) + query, options);
  } catch {
    throw new Error("the engine does not answer; start it again with: springform studio");
  }
  if (response.ok) return response;
  const refusal = (await response.json().catch(() => null)) as Refusal | null;
  throw new Error(refusal?.problem ?? `the engine answered with ${response.status}`);
}

const asJson = <T>(answer: Response) => answer.json() as Promise<T>;

/** Posts a message and returns the answer. */
function posted<T>(path: string, label: string, message: object): Promise<T> {
  const options = { method: "POST", body: JSON.stringify(message) };
  return fetched(path, { label, options }, asJson<T>);
}

/** Scenes and documents that can be opened. */
export function fetchShelf(): Promise<Shelf> {
  return fetched("/api/shelf", { label: "Looking for documents" }, asJson<Shelf>);
}

/** What a folder of this machine holds; an empty path is where the engine was started. */
export function fetchFolder(path: string): Promise<Folder> {
  const query = `&path=${encodeURIComponent(path)}`;
  return fetched("/api/folder", { label: "Reading the folder", query }, asJson<Folder>);
}

/** Removes a document for good; its design file stays. */
export function removeDocument(id: string): Promise<void> {
  const options = { method: "DELETE" };
  return fetched(`/api/documents/${id}`, { label: "Removing", options }, async () => {});
}

/** Opens a scene or a design file as a document. */
export function openSource(source: string): Promise<Opened> {
  return posted("/api/documents", `Opening ${source}`, { source } satisfies Opening);
}

/** The net and the state of a picture, such as `/api/scenes/sheet/picture`. */
export function fetchPicture(path: string): Promise<[net: Frame, motion: Frame]> {
  return fetched(path, { label: "Rebuilding nets" }, async (answer) => {
    const buffer = await answer.arrayBuffer();
    const length = new DataView(buffer).getUint32(0, true);
    return [decodeFrame(buffer, 4), decodeFrame(buffer, 4 + length)];
  });
}

/** All individuals of a document's run from a generation on. */
export function fetchTable(document: string, first: number): Promise<Frame> {
  const asked = { label: "Reading individuals", query: `&from=${first}` };
  return fetched(`/api/documents/${document}/run`, asked, async (answer) =>
    decodeFrame(await answer.arrayBuffer()),
  );
}

/** A document's model as a file. */
export function fetchModel(document: string, format: string): Promise<Blob> {
  const path = `/api/documents/${document}/export/${format}`;
  return fetched(path, { label: "Writing the file" }, (answer) => answer.blob());
}

/** The test points in a CSV file with a measured curve. */
export function fetchCurve(file: File): Promise<CurvePoints> {
  const query = `&name=${encodeURIComponent(file.name)}`;
  const options = { method: "POST", body: file };
  const asked = { label: `Reading ${file.name}`, options, query };
  return fetched("/api/curve", asked, asJson<CurvePoints>);
}

/** Clusters of the individuals that are brushed. */
export function fetchClusters(document: string, brushes: Brushes): Promise<Clusters> {
  return posted(`/api/documents/${document}/run/clusters`, "Grouping", brushes);
}

/** Two nets, compared. */
export function fetchCompared(document: string, comparing: Comparing): Promise<Compared> {
  return posted(`/api/documents/${document}/compare`, "Comparing", comparing);
}

/** Where a parent, or an individual, came from. */
export function fetchLineage(
  document: string,
  generation: number,
  individual: number | null,
): Promise<Lineage> {
  const place = individual === null ? generation : `${generation}/${individual}`;
  const path = `/api/documents/${document}/lineage/${place}`;
  return fetched(path, { label: "Looking for ancestors" }, asJson<Lineage>);
}
