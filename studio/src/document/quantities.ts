// What springs can be coloured by: quantities with unit and formula, and kinds with names.
import { typeName } from "./cellTypes";
import type { Motion } from "./motion";
import { groupOf, type Net } from "./net";

export type QuantityId =
  | "force"
  | "density"
  | "length"
  | "strain"
  | "stress"
  | "level"
  | "type"
  | "part";

/** A number of every spring. */
export interface Quantity {
  id: QuantityId;
  name: string;
  /** What it is, in words. */
  explains: string;
  symbol: string;
  unit: string;
  formula: string;
  values(net: Net, motion: Motion): Float32Array;
  /** Whether any spring of a net has it; without it all have. */
  applies?(net: Net): boolean;
}

/** A kind that every spring is of. */
export interface Kind {
  id: QuantityId;
  name: string;
  /** What it is, in words. */
  explains: string;
  values(net: Net): Uint8Array;
  /** Names of the kinds by number. */
  names(net: Net): string[];
}

export const QUANTITIES: Quantity[] = [
  {
    id: "force",
    name: "Force",
    explains: "what a spring pulls with",
    symbol: "F",
    unit: "N",
    formula: "tension positive",
    values: (_, motion) => motion.forces,
  },
  {
    id: "density",
    name: "Force density",
    explains: "force for each metre of its length",
    symbol: "q",
    unit: "N/m",
    formula: "q = F / L",
    values: (net, motion) => {
      const lengths = lengthsOf(net, motion);
      return motion.forces.map((force, spring) => force / lengths[spring]);
    },
  },
  {
    id: "length",
    name: "Length",
    explains: "as long as it is now",
    symbol: "L",
    unit: "m",
    formula: "L between the end nodes",
    values: lengthsOf,
  },
  {
    id: "strain",
    name: "Strain",
    explains: "how far it is stretched beyond its unstressed length",
    symbol: "ε",
    unit: "",
    formula: "ε = (L − L0) / L0",
    applies: (net) => net.restLength.some((rest) => rest > 0),
    values: (net, motion) => {
      const lengths = lengthsOf(net, motion);
      return lengths.map((length, spring) => {
        const rest = net.restLength[spring];
        return rest > 0 ? (length - rest) / rest : Number.NaN;
      });
    },
  },
  {
    id: "stress",
    name: "Stress",
    explains: "force on its cross-section",
    symbol: "σ",
    unit: "N/mm²",
    formula: "σ = F / A",
    applies: (net) => net.area.some((area) => area > 0),
    values: (net, motion) =>
      motion.forces.map((force, spring) => stressOf(force, net.area[spring])),
  },
];

/** Stress of a force in a cross-section [N/mm²]; NaN where the cross-section is unknown. */
export function stressOf(force: number, area: number): number {
  return area > 0 ? force / area / 1e6 : Number.NaN;
}

export const KINDS: Kind[] = [
  {
    id: "level",
    name: "Level",
    explains: "how often its cell was subdivided",
    values: (net) => net.springLevel,
    names: (net) =>
      Array.from(
        { length: net.springLevel.reduce((a, b) => Math.max(a, b), 0) + 1 },
        (_, level) => `Level ${level}`,
      ),
  },
  {
    id: "type",
    name: "Cell type",
    explains: "type of the finest cell that holds it",
    values: (net) => springTypes(net).numbers,
    names: (net) => springTypes(net).names,
  },
  {
    id: "part",
    name: "Cylinder",
    explains: "part of the framework that it lies on",
    values: (net) => net.springPart,
    names: (net) => net.parts,
  },
];

export function quantityOf(id: QuantityId): Quantity | undefined {
  return QUANTITIES.find((quantity) => quantity.id === id);
}

export function kindOf(id: QuantityId): Kind | undefined {
  return KINDS.find((kind) => kind.id === id);
}

/** Length of every spring [m]. */
export function lengthsOf(net: Net, { positions }: Motion): Float32Array {
  const count = net.ends.length / 2;
  const lengths = new Float32Array(count);
  for (let spring = 0; spring < count; spring++) {
    const a = 3 * net.ends[2 * spring];
    const b = 3 * net.ends[2 * spring + 1];
    lengths[spring] = Math.hypot(
      positions[b] - positions[a],
      positions[b + 1] - positions[a + 1],
      positions[b + 2] - positions[a + 2],
    );
  }
  return lengths;
}

/** The plain type of a cell as written: without its turn. */
export function plainType(type: string): string {
  return type.split("@")[0];
}

const typesOfNets = new WeakMap<Net, { numbers: Uint8Array; names: string[] }>();

/** The type of the deepest cell of every spring. */
function springTypes(net: Net): { numbers: Uint8Array; names: string[] } {
  const known = typesOfNets.get(net);
  if (known) return known;
  const words = [...new Set(net.types.map(plainType))].sort();
  const numbers = new Uint8Array(net.ends.length / 2);
  const order = net.addresses
    .map((_, cell) => cell)
    .sort((a, b) => net.cellLevel[a] - net.cellLevel[b]);
  for (const cell of order) {
    const number = words.indexOf(plainType(net.types[cell]));
    for (const spring of groupOf(net.own, cell)) numbers[spring] = number;
  }
  const found = { numbers, names: words.map((word) => `Type ${typeName(word)}`) };
  typesOfNets.set(net, found);
  return found;
}

/** What a quantity is, in a line. */
export function formulaText({ symbol, formula }: Quantity): string {
  return formula.startsWith(symbol) ? formula : `${symbol}: ${formula}`;
}
