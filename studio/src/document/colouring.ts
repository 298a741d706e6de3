// The colours of all springs, and the legend that explains them.
import type { Motion } from "./motion";
import type { Net } from "./net";
import {
  brokenColour,
  type Colour,
  kindColour,
  noneColour,
  type PaletteId,
  slackColour,
  type Theme,
  tableOf,
  writeColour,
} from "./palettes";
import { kindOf, type QuantityId, quantityOf } from "./quantities";
import { placeOn, type Scale, type ScaleChoice, scaleOf } from "./scale";

/** What a person chose to see. */
export interface ColourChoice extends ScaleChoice {
  by: QuantityId;
  palette: PaletteId;
}

/** Colours of springs and what they mean. */
export interface Colouring {
  /** Red, green, blue, (3 m). */
  colours: Uint8Array;
  legend: ScaleLegend | KindLegend;
}

export interface ScaleLegend {
  shows: "scale";
  scale: Scale;
  /** Smallest and largest value of all springs. */
  least: number;
  most: number;
  slack: number;
  /** Springs that don't have it, such as strain without an unstressed length. */
  none: number;
  broken: number;
}

export interface KindLegend {
  shows: "kinds";
  entries: { name: string; colour: Colour; count: number }[];
}

/** A force below this share of the largest counts as none. */
const SLACK_SHARE = 1e-9;

export function colouringOf(
  net: Net,
  motion: Motion,
  choice: ColourChoice,
  theme: Theme,
): Colouring {
  const kind = kindOf(choice.by);
  if (kind) {
    const values = kind.values(net);
    const names = kind.names(net);
    const palette = names.map((_, number) =>
      kindColour(number, names.length, theme, kind.id === "level"),
    );
    const counts = new Array<number>(names.length).fill(0);
    const colours = new Uint8Array(3 * values.length);
    for (let spring = 0; spring < values.length; spring++) {
      colours.set(palette[values[spring]], 3 * spring);
      counts[values[spring]]++;
    }
    const entries = names.map((name, number) => ({
      name,
      colour: palette[number],
      count: counts[number],
    }));
    return {
      colours,
      legend: { shows: "kinds", entries: entries.filter(({ count }) => count > 0) },
    };
  }
  const values = quantityOf(choice.by)!.values(net, motion);
  const scale = scaleOf(values, choice);
  const table = tableOf(choice.palette, theme);
  const colours = new Uint8Array(3 * values.length);
  const legend: ScaleLegend = {
    shows: "scale",
    scale,
    least: Number.POSITIVE_INFINITY,
    most: Number.NEGATIVE_INFINITY,
    slack: 0,
    none: 0,
    broken: 0,
  };
  let largest = 0;
  for (const force of motion.forces) largest = Math.max(largest, Math.abs(force));
  for (let spring = 0; spring < values.length; spring++) {
    const value = values[spring];
    if (!Number.isFinite(value) && Number.isFinite(motion.forces[spring])) {
      legend.none++;
      colours.set(noneColour(theme), 3 * spring);
    } else if (!Number.isFinite(value)) {
      legend.broken++;
      colours.set(brokenColour(theme), 3 * spring);
    } else if (Math.abs(motion.forces[spring]) <= SLACK_SHARE * largest) {
      legend.slack++;
      colours.set(slackColour(theme), 3 * spring);
    } else {
      writeColour(table, placeOn(scale, value), colours, 3 * spring);
    }
    if (value < legend.least) legend.least = value;
    if (value > legend.most) legend.most = value;
  }
  return { colours, legend };
}
