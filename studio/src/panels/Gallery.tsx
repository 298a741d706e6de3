// All individuals of a run as pictures, a row a generation, the best first; only what is in sight is there.
import { useVirtualizer } from "@tanstack/react-virtual";
import { X } from "lucide-react";
import { useMemo, useRef, useState } from "react";
import { maskOf } from "../document/choosing";
import type { Individuals } from "../document/run";
import { inDigits } from "../document/scale";
import { ask, store } from "../document/store";
import { Choice, IconButton } from "./parts";
import { Thumbnail } from "./Thumbnail";
import { useStudio } from "./use";

const WIDTH = 116; // px
const HEIGHT = 108; // px

type Order = "differential" | "springs" | "number";

export function Gallery() {
  const individuals = useStudio((state) => state.individuals);
  const folder = useStudio((state) => state.run?.state.folder ?? "");
  const document = useStudio((state) => state.document?.document ?? "");
  const looking = useStudio((state) => state.document?.looking ?? null);
  const [order, setOrder] = useState<Order>("differential");
  const box = useRef<HTMLDivElement>(null);
  const generations = Math.floor(individuals.springs.length / individuals.population);
  const brushes = useStudio((state) => state.brushes);
  const mask = useMemo(() => maskOf(individuals, brushes), [individuals, brushes]);
  /** Generations with somebody to show, the newest first. */
  const shown = useMemo(() => {
    const all = Array.from({ length: generations }, (_, at) => generations - at);
    const { population } = individuals;
    return mask
      ? all.filter((one) => mask.subarray((one - 1) * population, one * population).includes(1))
      : all;
  }, [generations, individuals, mask]);
  const chosen = mask
    ? mask.reduce((sum, one) => sum + one, 0)
    : generations * individuals.population;
  const rows = useVirtualizer({
    count: shown.length,
    getScrollElement: () => box.current,
    estimateSize: () => HEIGHT,
    overscan: 1,
  });
  const columns = useVirtualizer({
    count: individuals.population,
    getScrollElement: () => box.current,
    estimateSize: () => WIDTH,
    horizontal: true,
    overscan: 2,
    paddingStart: 44,
  });
  // biome-ignore lint/correctness/useExhaustiveDependencies: made anew when there are more, or another order
  const orders = useMemo(() => new Map<number, number[]>(), [individuals, order, mask]);
  const orderOf = (generation: number) => {
    let found = orders.get(generation);
    if (!found) {
      found = ordered(individuals, generation, order, mask);
      orders.set(generation, found);
    }
    return found;
  };
  return (
    <section className="gallery" aria-label="Individuals">
      <header>
        <h2>Individuals</h2>
        <span>
          {chosen.toLocaleString("en")} in {shown.length} generations, the newest first
        </span>
        <div className="gap" />
        <Choice
          label="Order within a generation"
          value={order}
          options={[
            { value: "differential", name: "Force differential" },
            { value: "springs", name: "Springs" },
            { value: "number", name: "Number" },
          ]}
          onTake={(taken: Order) => setOrder(taken)}
        />
        <IconButton
          label="Close the individuals"
          side="top"
          onClick={() => store.setState({ gallery: false })}
        >
          <X />
        </IconButton>
      </header>
      {generations === 0 && <p className="explain">The first generation is on its way.</p>}
      <div className="gallery-box" ref={box}>
        <div
          style={{
            height: rows.getTotalSize(),
            width: columns.getTotalSize(),
            position: "relative",
          }}
        >
          {rows.getVirtualItems().map((row) => {
            const generation = shown[row.index];
            const order = orderOf(generation);
            return (
              <div
                key={generation}
                className="gallery-row"
                style={{ transform: `translateY(${row.start}px)`, height: HEIGHT }}
              >
                <b>{generation}</b>
                {columns.getVirtualItems().map((column) => {
                  const individual = order[column.index];
                  if (individual === undefined) return null;
                  const at = (generation - 1) * individuals.population + individual;
                  const differential = inDigits(individuals.differential[at]);
                  const current =
                    looking?.generation === generation && looking.individual === individual;
                  return (
                    <button
                      key={individual}
                      type="button"
                      className="gallery-cell"
                      aria-pressed={current}
                      aria-label={`Generation ${generation}, individual ${individual}: ${individuals.springs[at]} springs, force differential ${differential}`}
                      style={{
                        transform: `translateX(${column.start}px)`,
                        width: WIDTH - 6,
                        height: HEIGHT - 6,
                      }}
                      onClick={() =>
                        ask({ type: "look", generation, individual }, "Rebuilding the individual")
                      }
                    >
                      <Thumbnail
                        path={`/api/documents/${document}/run/${generation}/${individual}`}
                        revision={folder}
                        width={WIDTH - 14}
                        height={HEIGHT - 34}
                      />
                      <small>
                        <b>{differential}</b> · {individuals.springs[at]}
                      </small>
                    </button>
                  );
                })}
              </div>
            );
          })}
        </div>
      </div>
    </section>
  );
}

function ordered(
  { population, springs, differential }: Individuals,
  generation: number,
  order: Order,
  mask: Uint8Array | null,
): number[] {
  const first = (generation - 1) * population;
  const numbers = Array.from({ length: population }, (_, number) => number).filter(
    (number) => !mask || mask[first + number],
  );
  if (order === "number") return numbers;
  const value = (number: number) => {
    const found = (order === "springs" ? springs : differential)[first + number];
    return Number.isFinite(found) ? found : Number.POSITIVE_INFINITY;
  };
  const values = new Map(numbers.map((number) => [number, value(number)]));
  return numbers.sort((a, b) => {
    const [first, second] = [values.get(a)!, values.get(b)!];
    return first === second ? a - b : first < second ? -1 : 1;
  });
}
