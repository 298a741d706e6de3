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

async function answer(path: string, options: RequestInit = {}, query = ""): Promise<Response> {
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

/** Scenes and documents that can be opened. */
export async function fetchShelf(): Promise<Shelf> {
  return (await answer("/api/shelf")).json() as Promise<Shelf>;
}

/** What a folder of this machine holds; an empty path is where the engine was started. */
export async function fetchFolder(path: string): Promise<Folder> {
  const query = `&path=${encodeURIComponent(path)}`;
  return (await answer("/api/folder", {}, query)).json() as Promise<Folder>;
}

/** Removes a document for good; its design file stays. */
export async function removeDocument(id: string): Promise<void> {
  await answer(`/api/documents/${id}`, { method: "DELETE" });
}

/** Opens a scene or a design file as a document. */
export async function openSource(source: string): Promise<Opened> {
  const body = JSON.stringify({ source } satisfies Opening);
  return (await answer("/api/documents", { method: "POST", body })).json() as Promise<Opened>;
}

/** The net and the state of a picture, such as `/api/scenes/sheet/picture`. */
export async function fetchPicture(path: string): Promise<[net: Frame, motion: Frame]> {
  const buffer = await (await answer(path)).arrayBuffer();
  const length = new DataView(buffer).getUint32(0, true);
  return [decodeFrame(buffer, 4), decodeFrame(buffer, 4 + length)];
}

/** All individuals of a document's run from a generation on. */
export async function fetchTable(document: string, first: number): Promise<Frame> {
  const response = await answer(`/api/documents/${document}/run`, {}, `&from=${first}`);
  return decodeFrame(await response.arrayBuffer());
}

/** A document's model as a file. */
export async function fetchModel(document: string, format: string): Promise<Blob> {
  return (await answer(`/api/documents/${document}/export/${format}`)).blob();
}

/** The test points in a CSV file with a measured curve. */
export async function fetchCurve(file: File): Promise<CurvePoints> {
  const query = `&name=${encodeURIComponent(file.name)}`;
  const options = { method: "POST", body: file };
  return (await answer("/api/curve", options, query)).json() as Promise<CurvePoints>;
}

/** Clusters of the individuals that are brushed. */
export async function fetchClusters(document: string, brushes: Brushes): Promise<Clusters> {
  const body = JSON.stringify(brushes);
  const path = `/api/documents/${document}/run/clusters`;
  return (await answer(path, { method: "POST", body })).json() as Promise<Clusters>;
}

/** Two nets, compared. */
export async function fetchCompared(document: string, comparing: Comparing): Promise<Compared> {
  const body = JSON.stringify(comparing);
  const path = `/api/documents/${document}/compare`;
  return (await answer(path, { method: "POST", body })).json() as Promise<Compared>;
}

/** Where a parent, or an individual, came from. */
export async function fetchLineage(
  document: string,
  generation: number,
  individual: number | null,
): Promise<Lineage> {
  const place = individual === null ? generation : `${generation}/${individual}`;
  return (await answer(`/api/documents/${document}/lineage/${place}`)).json() as Promise<Lineage>;
}
