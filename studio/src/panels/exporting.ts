// Files for others: the picture as the canvas shows it, and the model as the engine writes it.
import { comparing, isComparing, sharedColour, sharedQuantity } from "../document/comparing";
import { formulaText, kindOf, type Quantity, quantityOf } from "../document/quantities";
import { inDigits, type Scale, scaleOf } from "../document/scale";
import { orNotice, store } from "../document/store";
import { documentInAddress } from "../protocol/address";
import { fetchModel } from "../protocol/fetching";
import { waited } from "../protocol/waits";
import type { Viewport } from "../viewport/scene";
import type { Legend } from "../viewport/vector";

/** Files of the model, by the name that the engine knows, and other words that people look for them by. */
export const MODELS = [
  { name: "toml", label: "Design file (TOML)", words: "" },
  { name: "json", label: "Design file (JSON)", words: "" },
  {
    name: "obj",
    label: "Lines at equilibrium (OBJ)",
    words: "rhino 3dm dxf cad mesh model curves",
  },
  { name: "tables", label: "Tables of nodes and springs (ZIP)", words: "csv excel" },
] as const;

export async function exportPicture(viewport: Viewport): Promise<void> {
  const legend = isComparing() ? sharedLegend() : legendOf(viewport);
  const picture = await orNotice(waited("Drawing the picture", viewport.picture(legend)));
  if (picture) save(picture, "png");
}

export function exportDrawing(viewport: Viewport): void {
  save(viewport.drawing(legendOf(viewport)), "svg");
}

/** What the colours of the net mean. */
function legendOf(viewport: Viewport): Legend | null {
  const { colour } = store.getState().view;
  const shown = viewport.colouring?.legend;
  if (shown?.shows === "kinds")
    return { title: kindOf(colour.by)?.name ?? "", kinds: shown.entries };
  const quantity = quantityOf(colour.by);
  return quantity && shown ? scaleLegend(quantity, shown.scale) : null;
}

/** What the colours of both nets mean. */
function sharedLegend(): Legend {
  const { colour } = store.getState().view;
  const shared = sharedColour(comparing.getState().nets, colour);
  return scaleLegend(sharedQuantity(colour), scaleOf(new Float32Array(), shared));
}

function scaleLegend(quantity: Quantity, { low, high, logarithmic }: Scale): Legend {
  const { view, theme } = store.getState();
  return {
    title: `${quantity.name}${quantity.unit && ` [${quantity.unit}]`}${logarithmic ? ", log" : ""}`,
    formula: formulaText(quantity),
    low: inDigits(low),
    high: inDigits(high),
    palette: view.colour.palette,
    theme,
  };
}

export async function exportModel(format: (typeof MODELS)[number]["name"]): Promise<void> {
  const content = await orNotice(fetchModel(documentInAddress(), format));
  if (content) save(content, format === "tables" ? "zip" : format);
}

function save(content: Blob, suffix: string): void {
  const href = URL.createObjectURL(content);
  const name = (store.getState().document?.name ?? "net").replaceAll(" ", "-");
  Object.assign(document.createElement("a"), { href, download: `${name}.${suffix}` }).click();
  URL.revokeObjectURL(href);
}
