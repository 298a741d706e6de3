// Files for others: the picture as the canvas shows it, and the model as the engine writes it.
import { formulaText, quantityOf } from "../document/quantities";
import { inDigits } from "../document/scale";
import { busyWith, store } from "../document/store";
import { documentInAddress } from "../protocol/address";
import { fetchModel } from "../protocol/fetching";
import type { Viewport } from "../viewport/scene";

/** Files of the model, by the name that the engine knows. */
export const MODELS = [
  { name: "toml", label: "Design file (TOML)" },
  { name: "json", label: "Design file (JSON)" },
  { name: "obj", label: "Lines at equilibrium (OBJ)" },
  { name: "tables", label: "Tables of nodes and springs (ZIP)" },
] as const;

export async function exportPicture(viewport: Viewport): Promise<void> {
  const address = URL.createObjectURL(await viewport.picture());
  download(address, `${name()}.png`);
  URL.revokeObjectURL(address);
}

export function exportDrawing(viewport: Viewport): void {
  const { view, theme } = store.getState();
  const quantity = quantityOf(view.colour.by);
  const shown = viewport.colouring?.legend;
  const legend =
    quantity && shown?.shows === "scale"
      ? {
          title: `${quantity.name}${quantity.unit && ` [${quantity.unit}]`}${shown.scale.logarithmic ? ", log" : ""}`,
          formula: formulaText(quantity),
          low: inDigits(shown.scale.low),
          high: inDigits(shown.scale.high),
          palette: view.colour.palette,
          theme,
        }
      : null;
  const address = URL.createObjectURL(viewport.drawing(legend));
  download(address, `${name()}.svg`);
  URL.revokeObjectURL(address);
}

export async function exportModel(format: (typeof MODELS)[number]["name"]): Promise<void> {
  const content = await busyWith("Writing the file", fetchModel(documentInAddress(), format));
  if (!content) return;
  const address = URL.createObjectURL(content);
  const suffix = format === "tables" ? "zip" : format;
  download(address, `${name()}.${suffix}`);
  URL.revokeObjectURL(address);
}

function download(href: string, file: string): void {
  Object.assign(document.createElement("a"), { href, download: file }).click();
}

function name(): string {
  return (store.getState().document?.name ?? "net").replaceAll(" ", "-");
}
