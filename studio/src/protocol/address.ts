// The address of the page: the token that the engine printed, the document that is open, and what is compared in it.

/** The token in the address of the page. */
export function token(): string {
  return new URLSearchParams(location.search).get("token") ?? "";
}

/** Id of the document in the address; empty on the start page. */
export function documentInAddress(): string {
  return parts()[0];
}

/** Two nets of the document, and the run that their individuals are of. */
export interface ComparedInAddress {
  sides: [string, string];
  run: string;
}

/** What is compared, as the address says; null: nothing is. */
export function comparedInAddress(): ComparedInAddress | null {
  const said = new URLSearchParams(parts()[1]);
  const [first, second] = said.get("compare")?.split(",") ?? [];
  return first && second ? { sides: [first, second], run: said.get("run") ?? "" } : null;
}

/** Has the address say what is compared, so that it survives a reload; nothing is added to go back to. */
export function putComparedInAddress(compared: ComparedInAddress | null): void {
  const [document] = parts();
  const said = compared && new URLSearchParams({ compare: `${compared.sides}`, run: compared.run });
  history.replaceState(history.state, "", `#${document}${said ? `?${said}` : ""}`);
}

function parts(): [document: string, said: string] {
  const [document, said = ""] = location.hash.slice(1).split("?");
  return [document, said];
}

/** An address of the engine, with the token. */
export function engineAddress(path: string, scheme: "http" | "ws" = "http"): string {
  return `${scheme}://${location.host}${path}?token=${encodeURIComponent(token())}`;
}
