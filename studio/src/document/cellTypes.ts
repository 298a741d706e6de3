// What the built-in cell types hold, in words.

const WORDS: Record<string, string> = {
  "0": "no springs",
  "1": "its sides",
  "2": "its sides, and the centre to its corners",
  "3": "its sides, and one diagonal",
  "4": "its sides, and the middles of two that lie opposite",
  "5": "its sides, and a ring through their middles",
  "6": "the centre to every node round it, and no sides of its own",
};

/** The springs of a cell type. */
export function springsOfType(word: string): string {
  return WORDS[word] ?? "as the design file says";
}
