// What the page waits for, in words: told of everything that is asked for, once it does not come at once.

const AT_ONCE = 200; // ms

/** What is under way for so long that it is told, the latest last. */
const told = new Set<{ label: string }>();
let listener: (label: string) => void = () => {};

/** Has somebody told what is waited for; an empty label says that nothing is. */
export function onWaits(tell: (label: string) => void): void {
  listener = tell;
}

/** Tells that something is waited for, while it is. */
export async function waited<T>(label: string, work: Promise<T>): Promise<T> {
  const own = { label };
  const tell = () => listener([...told].at(-1)?.label ?? "");
  const timer = setTimeout(() => {
    told.add(own);
    tell();
  }, AT_ONCE);
  try {
    return await work;
  } finally {
    clearTimeout(timer);
    if (told.delete(own)) tell();
  }
}
