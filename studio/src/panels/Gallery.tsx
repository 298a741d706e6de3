// All individuals of a run as pictures: a row a generation, or one ranking; only what is in sight is there.
import { useVirtualizer } from "@tanstack/react-virtual";
import { Columns2, Pin, Rows3, X } from "lucide-react";
import { memo, type RefObject, useEffect, useMemo, useRef, useState } from "react";
import { byGeneration, measureOf, placeOnAxis, type Sort } from "../document/choosing";
import {
  pathOfSide,
  pinnedRows,
  type Side,
  shownSide,
  sideOfRow,
  togglePin,
} from "../document/pins";
import { type Individuals, placeOf } from "../document/run";
import { inDigits, inFull } from "../document/scale";
import { store } from "../document/store";
import { clickSide, compareMarked, IndividualMenu, keyOnSide } from "./IndividualMenu";
import { IconButton } from "./parts";
import { SortControl, useRanking } from "./Sorting";
import { Thumbnail } from "./Thumbnail";
import { useStudio } from "./use";

const WIDTH = 116; // px
const HEIGHT = 108; // px
const MARGIN = 44; // px

/** Individuals in rows, as they are shown. */
interface Shelves {
  count: number;
  /** Most individuals in a row. */
  longest: number;
  labelOf(at: number): number;
  rowsOf(at: number): Uint32Array;
}

export function Gallery() {
  const individuals = useStudio((state) => state.individuals);
  const sort = useStudio((state) => state.sort);
  const { rows, generations } = useShown();
  const box = useRef<HTMLDivElement>(null);
  const inRow = useColumns(box);
  const shelves = useMemo<Shelves>(() => {
    if (sort.byGeneration) {
      const parted = byGeneration(individuals, rows);
      return {
        count: parted.generations.length,
        longest: individuals.population,
        labelOf: (at) => parted.generations[at],
        rowsOf: (at) => parted.rows.subarray(parted.starts[at], parted.starts[at + 1]),
      };
    }
    return {
      count: Math.ceil(rows.length / inRow),
      longest: Math.min(inRow, rows.length),
      labelOf: (at) => at * inRow + 1,
      rowsOf: (at) => rows.subarray(at * inRow, (at + 1) * inRow),
    };
  }, [individuals, rows, sort.byGeneration, inRow]);
  return (
    <section className="gallery" aria-label="Individuals">
      <Header
        words={`${inFull(rows.length)} in ${inFull(generations)} generation${generations === 1 ? "" : "s"}${sort.byGeneration ? ", the newest first" : ", ranked"}`}
      />
      {individuals.springs.length === 0 && (
        <p className="explain">The first generation is on its way.</p>
      )}
      <Body box={box} shelves={shelves} />
    </section>
  );
}

/** Rows of what is brushed, and pinned if only that is to be shown, in the order of the sort key. */
function useShown(): { rows: Uint32Array; generations: number } {
  const individuals = useStudio((state) => state.individuals);
  const pins = useStudio((state) => state.pins);
  const only = useStudio((state) => state.pinnedOnly);
  const name = useStudio((state) => state.run?.state.name ?? "");
  const ranking = useRanking();
  return useMemo(() => {
    const pinned = only ? new Set(pinnedRows(individuals, pins, name)) : null;
    const rows = pinned ? ranking.rows.filter((row) => pinned.has(row)) : ranking.rows;
    return { rows, generations: byGeneration(individuals, rows).generations.length };
  }, [individuals, ranking, pins, only, name]);
}

/** How many pictures stand side by side in a ranking. */
function useColumns(box: RefObject<HTMLDivElement | null>): number {
  const [width, setWidth] = useState(MARGIN + 8 * WIDTH);
  useEffect(() => {
    const observer = new ResizeObserver(([{ contentRect }]) => setWidth(contentRect.width));
    observer.observe(box.current!);
    return () => observer.disconnect();
  }, [box]);
  return Math.max(1, Math.floor((width - MARGIN) / WIDTH));
}

const PLAIN = "Differential";

/** The measure that is written under each individual: what it is sorted by, unless that is there anyway. */
function measureUnder(sort: Sort): string {
  const told = ["force_differential", "springs", "generation"].includes(sort.by);
  return told ? PLAIN : measureOf(sort).name;
}

function Header({ words }: { words: string }) {
  const rows = useStudio((state) => state.sort.byGeneration);
  const only = useStudio((state) => state.pinnedOnly);
  const marked = useStudio((state) => state.marked);
  const read = useStudio(({ sort }) => `${measureUnder(sort).toLowerCase()} · springs`);
  return (
    <header>
      <h2>Individuals</h2>
      <span>{words}</span>
      <span className="gallery-reading">below: {read}</span>
      <div className="gap" />
      {marked.length > 0 && (
        <button
          type="button"
          className={marked.length === 2 ? "button icon primary" : "button icon"}
          disabled={marked.length < 2}
          onClick={compareMarked}
        >
          <Columns2 /> {marked.length === 2 ? "Compare" : "Mark another one"}
        </button>
      )}
      <SortControl label="Sorted by" />
      <IconButton
        label="A row a generation"
        side="top"
        pressed={rows}
        onClick={() =>
          store.setState(({ sort }) => ({ sort: { ...sort, byGeneration: !sort.byGeneration } }))
        }
      >
        <Rows3 />
      </IconButton>
      <IconButton
        label="Pinned only"
        side="top"
        pressed={only}
        onClick={() => store.setState({ pinnedOnly: !only })}
      >
        <Pin />
      </IconButton>
      <IconButton
        label="Close the individuals"
        side="top"
        onClick={() => store.setState({ gallery: false })}
      >
        <X />
      </IconButton>
    </header>
  );
}

function Body({ box, shelves }: { box: RefObject<HTMLDivElement | null>; shelves: Shelves }) {
  const individuals = useStudio((state) => state.individuals);
  const only = useStudio((state) => state.pinnedOnly);
  const [hovered, setHovered] = useState<number | null>(null);
  const [menu, setMenu] = useState<Side | null>(null);
  const pinned = usePinned();
  const generations = useStudio((state) => state.run?.rows);
  const folder = useStudio((state) => state.run?.state.folder ?? "");
  const document = useStudio((state) => state.document?.document ?? "");
  const sort = useStudio((state) => state.sort);
  const current = useStudio((state) => shownSide(state.document));
  const marked = useStudio((state) => state.marked);
  const rows = useVirtualizer({
    count: shelves.count,
    getScrollElement: () => box.current,
    estimateSize: () => HEIGHT,
    overscan: 1,
  });
  const columns = useVirtualizer({
    count: shelves.longest,
    getScrollElement: () => box.current,
    estimateSize: () => WIDTH,
    horizontal: true,
    overscan: 1,
    paddingStart: MARGIN,
  });
  return (
    <IndividualMenu
      side={menu}
      onOpen={setMenu}
      sideUnder={(event) =>
        (event.target as Element).closest<HTMLElement>("[data-side]")?.dataset.side ?? null
      }
    >
      <div className="gallery-box" ref={box} onPointerLeave={() => setHovered(null)}>
        {only && shelves.count === 0 && (
          <p className="explain">Nothing of this run is pinned and brushed.</p>
        )}
        <div
          style={{
            height: rows.getTotalSize(),
            width: columns.getTotalSize(),
            position: "relative",
          }}
        >
          {rows.getVirtualItems().map((row) => {
            const shelf = shelves.rowsOf(row.index);
            return (
              <div
                key={row.key}
                className="gallery-row"
                style={{ transform: `translateY(${row.start}px)`, height: HEIGHT }}
              >
                <b>
                  {inFull(shelves.labelOf(row.index))}
                  {sort.byGeneration &&
                    generations?.[shelves.labelOf(row.index) - 1]?.winner === null && (
                      <small title="No mutant of this generation was better: its parent is of an earlier one">
                        parent stays
                      </small>
                    )}
                </b>
                {columns.getVirtualItems().map((column) => {
                  const at = shelf[column.index];
                  if (at === undefined) return null;
                  const side = sideOfRow(individuals, at);
                  const place = placeOf(individuals, at);
                  const chosen = generations?.[place.generation - 1]?.winner === place.individual;
                  return (
                    <Cell
                      key={at}
                      individuals={individuals}
                      row={at}
                      side={side}
                      path={pathOfSide(document, side)}
                      folder={folder}
                      sort={sort}
                      current={side === current}
                      marked={marked.includes(side)}
                      chosen={chosen}
                      start={column.start}
                      pinned={pinned.has(at)}
                      hovered={hovered === at}
                      onHover={setHovered}
                    />
                  );
                })}
              </div>
            );
          })}
        </div>
      </div>
    </IndividualMenu>
  );
}

/** Rows that are pinned. */
function usePinned(): Set<number> {
  const individuals = useStudio((state) => state.individuals);
  const pins = useStudio((state) => state.pins);
  const name = useStudio((state) => state.run?.state.name ?? "");
  return useMemo(() => new Set(pinnedRows(individuals, pins, name)), [individuals, pins, name]);
}

const Cell = memo(function Cell({
  individuals,
  row,
  side,
  path,
  folder,
  sort,
  current,
  marked,
  chosen,
  start,
  pinned,
  hovered,
  onHover,
}: {
  individuals: Individuals;
  row: number;
  side: Side;
  path: string;
  folder: string;
  sort: Sort;
  /** Whether it is looked at. */
  current: boolean;
  marked: boolean;
  /** Whether it became the parent. */
  chosen: boolean;
  start: number;
  pinned: boolean;
  hovered: boolean;
  onHover(row: number): void;
}) {
  const { generation, individual } = placeOf(individuals, row);
  const springs = individuals.springs[row];
  const differential = inDigits(individuals.differential[row]);
  const plain = measureUnder(sort) === PLAIN;
  const value = plain ? differential : inDigits(placeOnAxis(individuals, sort.by, row));
  return (
    <>
      <button
        type="button"
        className={marked ? "gallery-cell marked" : "gallery-cell"}
        data-side={side}
        aria-pressed={current}
        aria-label={`Generation ${generation}, individual ${individual}: ${inFull(springs)} springs, force differential ${differential}${chosen ? ", the parent" : ""}${pinned ? ", pinned" : ""}${marked ? ", marked" : ""}`}
        style={{ transform: `translateX(${start}px)`, width: WIDTH - 6, height: HEIGHT - 6 }}
        onClick={(event) => clickSide(event, side)}
        onKeyDown={(event) => keyOnSide(event, side)}
        onPointerEnter={() => onHover(row)}
        onFocus={() => onHover(row)}
      >
        <Thumbnail path={path} revision={folder} width={WIDTH - 14} height={HEIGHT - 34} />
        <small>
          <b>{value}</b> {!plain && measureOf(sort).unit} · {inFull(springs)}
        </small>
        {chosen && <em className="gallery-parent">parent</em>}
      </button>
      {(pinned || hovered) && (
        <button
          type="button"
          className={pinned ? "gallery-pin pinned" : "gallery-pin"}
          data-side={side}
          tabIndex={-1}
          aria-label={`${pinned ? "Unpin" : "Pin"} generation ${generation}, individual ${individual}`}
          style={{ transform: `translateX(${start + WIDTH - 34}px)` }}
          onClick={() => togglePin(side)}
        >
          <Pin />
        </button>
      )}
    </>
  );
});
