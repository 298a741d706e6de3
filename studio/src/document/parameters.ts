// Parameters of evolution as people set them: what they are called, what they mean, what they are as text.

/** One parameter. */
export interface Parameter {
  label: string;
  /** What it means, for whoever rests on it. */
  explanation: string;
  kind: "number" | "text" | "choice" | "check";
  options?: { value: string; name: string; explains: string }[];
  /** Whether it can be without: 0 as text. */
  limit?: boolean;
}

const ALL = {
  population: {
    label: "Mutants a generation",
    explanation:
      "Mutants that every generation makes of its parent; the best of them is the next parent. More of them find better nets, and take longer.",
    kind: "number",
  },
  insertions: {
    label: "Cells subdivided",
    explanation:
      "First step of a mutation: so many cells are divided into four. A number such as 3, or a share such as 5%.",
    kind: "text",
  },
  switches: {
    label: "Cells that change type",
    explanation:
      "Second step of a mutation: so many cells draw another type and turn. A number such as 3, or a share such as 5%.",
    kind: "text",
  },
  toggles: {
    label: "Subdivisions turned off or on",
    explanation:
      "Third step of a mutation: so many subdivisions are turned off, or on again. A number such as 1, or a share such as 5%.",
    kind: "text",
  },
  types: {
    label: "Types that are drawn",
    explanation:
      "Cell types that a mutation gives to cells, with commas between; only those that the method allows.",
    kind: "text",
  },
  weighting: {
    label: "Cells are drawn",
    explanation:
      "Which cells a mutation draws rather than others. Evenly by area makes up for it that each subdivision makes four cells of one.",
    kind: "choice",
    options: [
      { value: "unweighted", name: "evenly", explains: "every cell alike" },
      {
        value: "linear",
        name: "rather coarse ones",
        explains: "the less a cell was subdivided, the more often",
      },
      {
        value: "exponential",
        name: "evenly by area",
        explains: "a quarter as often with every subdivision",
      },
      {
        value: "deep",
        name: "rather fine ones",
        explains: "the more a cell was subdivided, the more often",
      },
      { value: "stress", name: "by their force", explains: "where springs carry most" },
    ],
  },
  fitness: {
    label: "Best is the least",
    explanation:
      "What mutants are compared by. Spring utilization: how much the force differential rose for every spring that came since the start. Force differential: the largest force over the smallest, however many springs there are.",
    kind: "choice",
    options: [
      {
        value: "suf",
        name: "spring utilization",
        explains: "rise of the differential for every spring that came: denser nets",
      },
      {
        value: "differential",
        name: "force differential",
        explains: "largest over smallest force: the evenest net, dense or not",
      },
    ],
  },
  selection: {
    label: "The parent",
    explanation:
      "Always gives way: the best mutant is the next parent even if it is worse than its own, which leads out of dead ends, and away from good nets. Stays while it is best: only a better mutant replaces it.",
    kind: "choice",
    options: [
      {
        value: "comma",
        name: "always gives way",
        explains: "to the best mutant, even a worse one: out of dead ends",
      },
      {
        value: "plus",
        name: "stays while it is best",
        explains: "only a better mutant takes its place",
      },
    ],
  },
  symmetry: {
    label: "Keep the framework’s symmetries",
    explanation:
      "Mutations change all cells that are alike under the framework’s rotations and mirrors together. The net has to be symmetric.",
    kind: "check",
  },
  max_springs: {
    label: "At most springs (0: no limit)",
    explanation:
      "Mutants with more springs can’t become parents: a full net goes on evolving as others of its size.",
    kind: "number",
    limit: true,
  },
  until_springs: {
    label: "End at springs (0: never)",
    explanation: "The goal is reached once the parent has so many springs.",
    kind: "number",
    limit: true,
  },
  until_differential: {
    label: "End at force differential (0: never)",
    explanation:
      "The goal is reached once the parent’s force differential comes down, or up, to this from where it began.",
    kind: "number",
    limit: true,
  },
  generations: {
    label: "End at generation",
    explanation: "Most generations that are made.",
    kind: "number",
  },
  seed: {
    label: "Seed",
    explanation: "Number of the random draws: the same seed makes the same run.",
    kind: "number",
  },
} satisfies Record<string, Parameter>;

export type ParameterName = keyof typeof ALL;

/** How mutants are made and chosen, in runs and in live evolution alike. */
export const MAKING = [
  "population",
  "insertions",
  "switches",
  "toggles",
  "types",
  "weighting",
  "fitness",
  "selection",
  "symmetry",
] as const satisfies ParameterName[];

/** Every parameter that people set, described once. */
export const PARAMETERS: Record<ParameterName, Parameter> = ALL;

/** Texts of parameters. */
export type Texts = Partial<Record<ParameterName, string>>;

/** A value as its field shows it. */
export function textOf(name: ParameterName, value: unknown): string {
  if (Array.isArray(value)) return value.join(",");
  if (value === null || value === undefined) return PARAMETERS[name].limit ? "0" : "";
  return String(value);
}

/** The value that a text says. What is no number stays text: the engine says what is wrong with it. */
export function valueSaid(name: ParameterName, text: string): unknown {
  const { kind, limit } = PARAMETERS[name];
  const plain = kind === "number" ? text.trim().replace(",", ".") : text.trim();
  if (kind === "check") return text === "true";
  if (limit && (plain === "" || plain === "0")) return null;
  if (kind !== "number" || plain === "") return plain;
  return Number.isFinite(Number(plain)) ? Number(plain) : plain;
}
