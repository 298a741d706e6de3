// Laws of springs: how force follows length, with the constant that says how much, its unit and its meaning.
import type { Net } from "./net";

/** Keys of laws, as design files write them. */
export type LawKey = "stiffness" | "axial_stiffness" | "force_density" | "force" | "curve";

export interface Law {
  key: LawKey | "rod";
  name: string;
  formula: string;
  /** The constant of the law. */
  constant: { name: string; symbol: string; unit: string };
  /** What has to be known to read the constant. */
  explains: string;
  /** Whether the law knows an unstressed length. */
  elastic: boolean;
  value(net: Net, spring: number): number;
}

const rate = (net: Net, spring: number) => net.stiffness[spring];
const axial = (net: Net, spring: number) => net.stiffness[spring] * net.restLength[spring];

/** By number, as the engine tells it. */
export const LAWS: Law[] = [
  {
    key: "stiffness",
    name: "Stiffness",
    formula: "F = k (L − L0)",
    constant: { name: "Stiffness", symbol: "k", unit: "N/m" },
    explains: "k is force per length. Without an unstressed length L0 is 0, as in the paper.",
    elastic: true,
    value: rate,
  },
  {
    key: "axial_stiffness",
    name: "Axial stiffness",
    formula: "F = EA (L − L0) / L0",
    constant: { name: "Axial stiffness", symbol: "EA", unit: "N" },
    explains: "EA refers to the unstressed length L0, not to the length now.",
    elastic: true,
    value: axial,
  },
  {
    key: "force_density",
    name: "Force density",
    formula: "F = q L",
    constant: { name: "Force density", symbol: "q", unit: "N/m" },
    explains: "q is force over length; there is no unstressed length.",
    elastic: false,
    value: rate,
  },
  {
    key: "force",
    name: "Constant force",
    formula: "F = T",
    constant: { name: "Constant force", symbol: "T", unit: "N" },
    explains: "T is the force whatever the length; a negative one pushes.",
    elastic: false,
    value: (net, spring) => net.constantForce[spring],
  },
  {
    key: "curve",
    name: "Measured curve",
    formula: "F = g((L − L0) / L0)",
    constant: { name: "EA at the last point", symbol: "EA", unit: "N" },
    explains: "g is the measured curve; its strain refers to the unstressed length L0.",
    elastic: true,
    value: axial,
  },
  {
    key: "rod",
    name: "Rod",
    formula: "F = EA (L − L0) / L0",
    constant: { name: "Axial stiffness", symbol: "EA", unit: "N" },
    explains: "A link of a rod; EA refers to the unstressed length L0.",
    elastic: true,
    value: axial,
  },
];

/** What springs do, by number. */
export const SENSES = [
  { key: "tension", name: "pulls only", explains: "a cord: it goes slack rather than push" },
  { key: "both", name: "pulls and pushes", explains: "as a bar does" },
  { key: "compression", name: "pushes only", explains: "a strut: it lets go rather than pull" },
] as const;

/** The law of a spring. */
export function lawOf(net: Net, spring: number): Law {
  return LAWS[net.law[spring]];
}

/** The formula of a spring, without what is zero in it. */
export function formulaOf(net: Net, spring: number): string {
  const law = lawOf(net, spring);
  return law.key === "stiffness" && net.restLength[spring] === 0 ? "F = k L" : law.formula;
}

/** The one value that springs share; null if they differ. */
export function shared<T>(springs: ArrayLike<number>, read: (spring: number) => T): T | null {
  if (!springs.length) return null;
  const first = read(springs[0]);
  for (let at = 1; at < springs.length; at++) {
    const value = read(springs[at]);
    const same =
      typeof value === "number" && typeof first === "number"
        ? Math.abs(value - first) <= 1e-6 * Math.max(Math.abs(value), Math.abs(first))
        : value === first;
    if (!same) return null;
  }
  return first;
}
