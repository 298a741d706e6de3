// The address of the page: the token that the engine printed, and the document that is open.

/** The token in the address of the page. */
export function token(): string {
  return new URLSearchParams(location.search).get("token") ?? "";
}

/** Id of the document in the address; empty on the start page. */
export function documentInAddress(): string {
  return location.hash.slice(1);
}

/** An address of the engine, with the token. */
export function engineAddress(path: string, scheme: "http" | "ws" = "http"): string {
  return `${scheme}://${location.host}${path}?token=${encodeURIComponent(token())}`;
}
