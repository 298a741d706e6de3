// What cell types are called wherever they are read: by number and name.

/** Names of the built-in types, by number. */
const BUILT_IN = ["null", "quad", "braced", "diagonal", "strip", "inscribed", "dynamic"];

/** A type as it is written in a net, such as 6@1, for people: types of one's own have only their name. */
export function typeName(written: string): string {
  const [word, turn] = written.split("@");
  const name = BUILT_IN[Number(word)];
  const whole = name === undefined ? word : `${word} ${name}`;
  return turn ? `${whole}, turned ${90 * Number(turn)}°` : whole;
}

/** Types with commas between, as parameters list them. */
export function typeNames(list: string): string {
  const words = list.split(",").map((word) => word.trim());
  return words.filter(Boolean).map(typeName).join(", ");
}
