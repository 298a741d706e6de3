// The colours of all springs, and the legend that explains them.
import { type Conditions, conditionOf, conditionsOf } from "./conditions";
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
  /** What the form of springs tells. */
  conditions: Conditions;
}

export interface ScaleLegend {
  shows: "scale";
  scale: Scale;
  /** Smallest and largest value of all springs. */
  least: number;
  most: number;
  /** Springs that don't have it, such as strain without an unstressed length. */
  none: number;
}

export interface KindLegend {
  shows: "kinds";
  entries: { name: string; colour: Colour; count: number }[];
}

export function colouringOf(
  net: Net,
  motion: Motion,
  choice: ColourChoice,
  theme: Theme,
): Colouring {
  const kind = kindOf(choice.by);
  const conditions = conditionsOf(motion);
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
      conditions,
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
    none: 0,
  };
  for (let spring = 0; spring < values.length; spring++) {
    const value = values[spring];
    const condition = conditionOf(conditions, spring);
    if (condition === "broken") {
      colours.set(brokenColour(theme), 3 * spring);
    } else if (!Number.isFinite(value)) {
      legend.none++;
      colours.set(noneColour(theme), 3 * spring);
    } else if (condition === "slack") {
      colours.set(slackColour(theme), 3 * spring);
    } else {
      writeColour(table, placeOn(scale, value), colours, 3 * spring);
    }
    if (value < legend.least) legend.least = value;
    if (value > legend.most) legend.most = value;
  }
  return { colours, legend, conditions };
}
