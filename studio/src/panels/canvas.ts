// Canvases of pictures in panels: small, drawn once in a while, and many at a time.

/** Pixels of the screen to a pixel of the page. */
export function pixelRatio(): number {
  return Math.min(devicePixelRatio, 2);
}

/**
 * What draws on a canvas of a size [px]; it is cleared. Such canvases are kept in main memory: thousands of
 * lines that are drawn once would keep a graphics processor, and the page that waits for it, busy for long.
 */
export function penOf(
  canvas: HTMLCanvasElement,
  width: number,
  height: number,
): CanvasRenderingContext2D | null {
  const ratio = pixelRatio();
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const pen = canvas.getContext("2d", { willReadFrequently: true });
  pen?.scale(ratio, ratio);
  return pen;
}

const jobs: (() => void)[] = [];
let asked = false;

/** Draws in one of the next frames, one picture in each: together they would block the page. Returns what calls it off. */
export function drawSoon(job: () => void): () => void {
  jobs.push(job);
  if (!asked) requestAnimationFrame(drawNext);
  asked = true;
  return () => {
    const at = jobs.indexOf(job);
    if (at >= 0) jobs.splice(at, 1);
  };
}

function drawNext(): void {
  jobs.shift()?.();
  asked = jobs.length > 0;
  if (asked) requestAnimationFrame(drawNext);
}
