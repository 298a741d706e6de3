// Colours of springs: two sequential palettes (perceptually uniform, safe for the colour-blind), and kinds.

export type Theme = "dark" | "light";
export type PaletteId = "plasma" | "viridis";

/** Seventeen even steps of each palette, from dark to bright (matplotlib, van der Walt & Smith, 2015). */
const STEPS: Record<PaletteId, string> = {
  plasma:
    "0d0887 310597 4c02a1 6600a7 7e03a8 9511a1 aa2395 bc3587 cc4778 da5a6a e66c5c f0804e f89540 fdac33 fdc527 f8df25 f0f921",
  viridis:
    "440154 48186a 472d7b 424086 3b528b 33638d 2c728e 26828e 21918c 1fa088 28ae80 3fbc73 5ec962 84d44b addc30 d8e219 fde725",
};

export const PALETTES: { id: PaletteId; name: string; explains: string }[] = [
  { id: "plasma", name: "Plasma", explains: "purple to yellow; even to the eye" },
  {
    id: "viridis",
    name: "Viridis",
    explains: "blue to yellow; told apart by colour-blind eyes, too",
  },
];

/** The part of a palette that can be seen on the ground; the strongest springs stand out most. */
const SHOWN: Record<Theme, [low: number, high: number]> = {
  dark: [0.28, 1],
  light: [0.8, 0],
};

const KIND_COLOURS: Record<Theme, string[]> = {
  dark: ["5b8def", "f0a13c", "4cc38a", "e5678f", "b48cf2", "46c3d9", "d8c34a", "9aa4b2"],
  light: ["2f62c9", "b86b00", "15804f", "b93162", "7644c4", "0b7f96", "7d6b00", "5a6472"],
};

const SLACK: Record<Theme, Colour> = { dark: [92, 101, 114], light: [170, 178, 188] };
const NONE: Record<Theme, Colour> = { dark: [50, 57, 70], light: [208, 213, 220] };
const BROKEN: Record<Theme, Colour> = { dark: [255, 77, 79], light: [214, 32, 36] };

/** Red, green and blue, 0 to 255. */
export type Colour = [number, number, number];

const SIZE = 256;
const tables = new Map<string, Uint8Array>();

/** 256 colours of a palette, flat. */
export function tableOf(palette: PaletteId, theme: Theme): Uint8Array {
  const name = `${palette} ${theme}`;
  const known = tables.get(name);
  if (known) return known;
  const steps = STEPS[palette].split(" ").map(fromHex);
  const [low, high] = SHOWN[theme];
  const table = new Uint8Array(3 * SIZE);
  for (let shade = 0; shade < SIZE; shade++) {
    const place = (low + ((high - low) * shade) / (SIZE - 1)) * (steps.length - 1);
    const step = Math.min(Math.floor(place), steps.length - 2);
    for (let part = 0; part < 3; part++) {
      const from = steps[step][part];
      table[3 * shade + part] = from + (steps[step + 1][part] - from) * (place - step);
    }
  }
  tables.set(name, table);
  return table;
}

/** Writes the colour at a place of a palette, 0 to 1, into `target` at `at`. */
export function writeColour(
  table: Uint8Array,
  place: number,
  target: Uint8Array,
  at: number,
): void {
  const shade = 3 * Math.round(place * (SIZE - 1));
  target[at] = table[shade];
  target[at + 1] = table[shade + 1];
  target[at + 2] = table[shade + 2];
}

/** The colour of a kind by its number; ordered kinds, such as levels, run along a palette. */
export function kindColour(number: number, count: number, theme: Theme, ordered: boolean): Colour {
  if (ordered) {
    const target = new Uint8Array(3);
    writeColour(tableOf("viridis", theme), count > 1 ? number / (count - 1) : 0.5, target, 0);
    return [target[0], target[1], target[2]];
  }
  const colours = KIND_COLOURS[theme];
  return fromHex(colours[number % colours.length]);
}

/** Springs that carry nothing. */
export function slackColour(theme: Theme): Colour {
  return SLACK[theme];
}

/** Springs that don't have what is shown. */
export function noneColour(theme: Theme): Colour {
  return NONE[theme];
}

/** Springs whose force is undefined. */
export function brokenColour(theme: Theme): Colour {
  return BROKEN[theme];
}

/** A colour as CSS writes it. */
export function cssColour([red, green, blue]: Colour): string {
  return `rgb(${red} ${green} ${blue})`;
}

/** A palette as a CSS gradient. */
export function cssGradient(palette: PaletteId, theme: Theme): string {
  const table = tableOf(palette, theme);
  const stops = Array.from({ length: 9 }, (_, stop) => {
    const at = 3 * Math.round((stop / 8) * (SIZE - 1));
    return cssColour([table[at], table[at + 1], table[at + 2]]);
  });
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

function fromHex(text: string): Colour {
  const number = Number.parseInt(text, 16);
  return [number >> 16, (number >> 8) & 255, number & 255];
}
