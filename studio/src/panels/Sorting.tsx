// One sort key for the gallery, the scatter and the parallel coordinates, and what its colours mean.
import { ArrowDownNarrowWide, ArrowDownWideNarrow } from "lucide-react";
import { useMemo } from "react";
import { MEASURES, measureOf, placeOnAxis, type Ranking, rankingOf } from "../document/choosing";
import { cssGradient, type Theme, tableOf } from "../document/palettes";
import { inDigits, inFull } from "../document/scale";
import { store } from "../document/store";
import { Choice, IconButton } from "./parts";
import { useStudio } from "./use";

/** The ranking of what is brushed. */
export function useRanking(): Ranking {
  const individuals = useStudio((state) => state.individuals);
  const brushes = useStudio((state) => state.brushes);
  const sort = useStudio((state) => state.sort);
  return useMemo(() => rankingOf(individuals, sort, brushes), [individuals, brushes, sort]);
}

export function sortBy(by: string): void {
  store.setState(({ sort }) => ({ sort: { ...sort, by } }));
}

export function turnSort(): void {
  store.setState(({ sort }) => ({ sort: { ...sort, descending: !sort.descending } }));
}

export function SortControl({ label }: { label: string }) {
  const sort = useStudio((state) => state.sort);
  return (
    <div className="sort">
      <Choice
        label={label}
        value={sort.by}
        options={MEASURES.map(({ id, name, explains }) => ({ value: id, name, explains }))}
        onTake={sortBy}
      />
      <IconButton
        label={sort.descending ? "The largest first" : "The smallest first"}
        side="top"
        onClick={turnSort}
      >
        {sort.descending ? <ArrowDownWideNarrow /> : <ArrowDownNarrowWide />}
      </IconButton>
    </div>
  );
}

const SHADES = 24;

/** The palette of ranks: those of springs stay for forces. */
const PALETTE = "viridis";

/** Colour of a place in a ranking, 0 (first) to 1, in steps that can be drawn together. */
export function shadeOf(share: number): number {
  return Math.round(share * (SHADES - 1));
}

export function colourOfShade(shade: number, theme: Theme): string {
  const at = 3 * Math.round(255 * (1 - shade / (SHADES - 1)));
  const table = tableOf(PALETTE, theme);
  return `rgb(${table[at]} ${table[at + 1]} ${table[at + 2]})`;
}

/** The same as a pixel of an image: alpha, blue, green and red, from the highest byte. */
export function pixelOfShare(share: number, theme: Theme): number {
  const table = tableOf(PALETTE, theme);
  const at = 3 * Math.round(255 * (1 - share));
  return ((0xff << 24) | (table[at + 2] << 16) | (table[at + 1] << 8) | table[at]) >>> 0;
}

/** What the colours in scatter and parallel coordinates mean. */
export function RankLegend() {
  const individuals = useStudio((state) => state.individuals);
  const sort = useStudio((state) => state.sort);
  const theme = useStudio((state) => state.theme);
  const ranking = useRanking();
  const { unit, counts } = measureOf(sort);
  if (!ranking.known) return null;
  const value = (at: number) => {
    const known = placeOnAxis(individuals, sort.by, ranking.rows[at]);
    return counts ? inFull(known) : inDigits(known, 4);
  };
  return (
    <div className="rank-legend" title="Coloured by rank; the first are drawn on top">
      <span>
        first <b>{value(0)}</b>
      </span>
      <i style={{ background: cssGradient(PALETTE, theme).replace("to right", "to left") }} />
      <span>
        <b>{value(ranking.known - 1)}</b> {unit} last
      </span>
    </div>
  );
}
