// What can be said of a screenshot: how much of it is not ground, and where its colours are.
import type { Page } from "@playwright/test";
import { PNG } from "pngjs";

/** A picture of the net, to be asked. */
export interface Picture {
  colours: number;
  /** Share that is not ground. */
  lit: number;
  hash: number;
  /** Where the colours are that are nearest to a wanted one, best first [px of the page]. */
  nearest(colour: [number, number, number]): { x: number; y: number }[];
  /** Share of pixels near a colour. */
  share(colour: [number, number, number], reach: number): number;
}

/** The strongest springs in the dark. */
export const STRONGEST: [number, number, number] = [240, 249, 33];

/** Springs of middling force in the dark. */
export const MIDDLING: [number, number, number] = [204, 71, 120];

export async function pictureOf(page: Page): Promise<Picture> {
  const viewport = page.locator("main.viewport");
  const box = (await viewport.boundingBox())!;
  const { data, width } = PNG.sync.read(await viewport.screenshot());
  const pixels = new Uint32Array(data.buffer, data.byteOffset, data.length / 4);
  const ground = pixels[40 * width + 10];
  let lit = 0;
  let hash = 0;
  // What lies over the net is no part of it: tool help, legend, buttons, the section's slider.
  const height = pixels.length / width;
  const inside = (pixel: number) => {
    const [x, y] = [pixel % width, Math.floor(pixel / width)];
    return x > 260 && x < width - 80 && y > 60 && y < height - 60;
  };
  pixels.forEach((pixel, at) => {
    if (!inside(at)) return;
    if (pixel !== ground) lit++;
    hash = (Math.imul(hash, 31) + pixel) | 0;
  });
  const distance = (pixel: number, colour: [number, number, number]) =>
    Math.hypot(...colour.map((part, at) => part - data[4 * pixel + at]));
  return {
    colours: new Set(pixels).size,
    lit: lit / pixels.length,
    hash,
    nearest(colour) {
      const found = [...pixels.keys()].filter((pixel) => inside(pixel));
      const near = found.filter((pixel) => distance(pixel, colour) < 90);
      near.sort((a, b) => distance(a, colour) - distance(b, colour));
      return near.map((pixel) => ({
        x: box.x + (pixel % width),
        y: box.y + Math.floor(pixel / width),
      }));
    },
    share(colour, reach) {
      let near = 0;
      for (let pixel = 0; pixel < pixels.length; pixel++)
        if (inside(pixel) && distance(pixel, colour) < reach) near++;
      return near / pixels.length;
    },
  };
}
