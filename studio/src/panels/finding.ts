// Which commands are found by what somebody types, the likeliest first.

interface Named {
  label: string;
  /** Other words that people look for it by. */
  words?: string;
}

const wordsIn = (text: string) => text.split(/[^\p{L}\p{N}]+/u).filter(Boolean);

/** How well a command matches what is looked for: less is better, null not at all. */
function rankOf({ label, words = "" }: Named, wanted: string): number | null {
  const name = label.toLowerCase();
  if (name === wanted) return 0;
  if (name.startsWith(wanted)) return 1;
  const own = wordsIn(name);
  const parts = wordsIn(wanted);
  if (parts.every((part) => own.includes(part))) return 2;
  if (parts.every((part) => own.some((word) => word.startsWith(part)))) return 3;
  const all = [...own, ...wordsIn(words)];
  return parts.every((part) => all.some((word) => word.startsWith(part))) ? 4 : null;
}

/**
 * Those whose label is what was typed, then begins with it, then has it as whole words, then as beginnings of words,
 * its own before others; what can't be done now comes last.
 */
export function found<T extends Named>(all: T[], typed: string, refused: (one: T) => boolean): T[] {
  const wanted = typed.trim().toLowerCase();
  const matches = all.flatMap((one) => {
    const rank = rankOf(one, wanted);
    return rank === null ? [] : [{ one, rank, last: Number(refused(one)) }];
  });
  matches.sort((a, b) => a.last - b.last || a.rank - b.rank);
  return matches.map(({ one }) => one);
}
