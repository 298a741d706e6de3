// What cell types are called wherever they are read, by number and name, and what they hold.

/** Names of the built-in types and what springs they hold, by number. */
const BUILT_IN: { name: string; springs: string }[] = [
  { name: "null", springs: "no springs" },
  { name: "quad", springs: "its sides" },
  { name: "braced", springs: "its sides, and the centre to its corners" },
  { name: "diagonal", springs: "its sides, and one diagonal" },
  { name: "strip", springs: "its sides, and the middles of two that lie opposite" },
  { name: "inscribed", springs: "its sides, and a ring through their middles" },
  { name: "dynamic", springs: "the centre to every node round it, and no sides of its own" },
];

/** A type as it is written in a net, such as 6@1, for people: types of one's own have only their name. */
export function typeName(written: string): string {
  const [word, turn] = written.split("@");
  const name = BUILT_IN[Number(word)]?.name;
  const whole = name === undefined ? word : `${word} ${name}`;
  return turn ? `${whole}, turned ${90 * Number(turn)}°` : whole;
}

/** Types with commas between, as parameters list them. */
export function typeNames(list: string): string {
  const words = list.split(",").map((word) => word.trim());
  return words.filter(Boolean).map(typeName).join(", ");
}

/** The springs of a cell type. */
export function springsOfType(word: string): string {
  return BUILT_IN[Number(word)]?.springs ?? "as the design file says";
}
