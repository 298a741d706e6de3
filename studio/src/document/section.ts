// A section: a plane square to an axis, beyond which nothing of the net is drawn.

/** How the net is cut, as chosen. */
export interface Section {
  axis: 0 | 1 | 2;
  /** Where, as a share of the net's extent along the axis. */
  share: number;
  /** Whether what lies below the plane is left out instead of what lies above. */
  flipped: boolean;
}

/** The plane itself: kept is where `sign * (coordinate - at)` is at most 0. */
export interface Cut {
  axis: number;
  at: number;
  sign: number;
}

/** The plane of a section through a net at positions. */
export function cutOf(section: Section | null, positions: Float32Array): Cut | null {
  if (!section) return null;
  let low = Number.POSITIVE_INFINITY;
  let high = Number.NEGATIVE_INFINITY;
  for (let place = section.axis; place < positions.length; place += 3) {
    low = Math.min(low, positions[place]);
    high = Math.max(high, positions[place]);
  }
  const at = low + section.share * (high - low);
  return { axis: section.axis, at, sign: section.flipped ? -1 : 1 };
}

/** Whether a node is drawn. */
export function keeps(cut: Cut | null, positions: Float32Array, node: number): boolean {
  return !cut || cut.sign * (positions[3 * node + cut.axis] - cut.at) <= 0;
}

/** Springs as lines: six coordinates, three bytes of colour and a width each. */
export interface Lines {
  count: number;
  ends: Float32Array;
  colours: Uint8Array;
  widths: Float32Array | number;
}

/** What is left of lines, those that cross the plane shortened to it. */
export function clipped(cut: Cut | null, lines: Lines): Lines {
  if (!cut) return lines;
  const ends = new Float32Array(lines.ends.length);
  const colours = new Uint8Array(lines.colours.length);
  const widths = typeof lines.widths === "number" ? lines.widths : new Float32Array(lines.count);
  let count = 0;
  for (let line = 0; line < lines.count; line++) {
    const from = 6 * line;
    const a = cut.sign * (lines.ends[from + cut.axis] - cut.at);
    const b = cut.sign * (lines.ends[from + 3 + cut.axis] - cut.at);
    if (a > 0 && b > 0) continue;
    const to = 6 * count;
    ends.set(lines.ends.subarray(from, from + 6), to);
    if (a > 0 || b > 0) {
      const share = a / (a - b);
      for (let axis = 0; axis < 3; axis++) {
        const start = lines.ends[from + axis];
        const met = start + share * (lines.ends[from + 3 + axis] - start);
        ends[to + axis + (a > 0 ? 0 : 3)] = met;
      }
    }
    colours.set(lines.colours.subarray(3 * line, 3 * line + 3), 3 * count);
    if (typeof widths !== "number") widths[count] = (lines.widths as Float32Array)[line];
    count++;
  }
  return { count, ends, colours, widths };
}
