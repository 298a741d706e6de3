// Which commands are found by what somebody types, the likeliest first.

interface Named {
  label: string;
}

/** How well a label matches what is looked for: less is better, null not at all. */
type Measure = (label: string, wanted: string) => number | null;

const wordsIn = (text: string) => text.split(/[^\p{L}\p{N}]+/u).filter(Boolean);

const byWords: Measure = (label, wanted) => {
  if (label === wanted) return 0;
  if (label.startsWith(wanted)) return 1;
  const words = wordsIn(label);
  const parts = wordsIn(wanted);
  if (parts.every((part) => words.includes(part))) return 2;
  return parts.every((part) => words.some((word) => word.startsWith(part))) ? 3 : null;
};

const byLetters: Measure = (label, wanted) => {
  let from = 0;
  for (const letter of wanted.replaceAll(" ", "")) {
    from = label.indexOf(letter, from) + 1;
    if (from === 0) return null;
  }
  return 0;
};

/**
 * Those whose label is what was typed, then begins with it, then has it as whole words, then as beginnings of words;
 * what can't be done now comes last. Letters that are merely in order count only if nothing else matches.
 */
export function found<T extends Named>(all: T[], typed: string, refused: (one: T) => boolean): T[] {
  const wanted = typed.trim().toLowerCase();
  for (const measure of [byWords, byLetters]) {
    const matches = all.flatMap((one) => {
      const rank = measure(one.label.toLowerCase(), wanted);
      return rank === null ? [] : [{ one, rank, last: Number(refused(one)) }];
    });
    matches.sort((a, b) => a.last - b.last || a.rank - b.rank);
    if (matches.length) return matches.map(({ one }) => one);
  }
  return [];
}
