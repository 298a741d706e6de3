// Help with choosing: clusters of what is brushed, and where the individual that is looked at came from.
import { useEffect, useState } from "react";
import { pathOfSide, type Side, sideOf } from "../document/pins";
import { inDigits, inFull } from "../document/scale";
import { notify, select, store } from "../document/store";
import { documentInAddress } from "../protocol/address";
import { fetchClusters, fetchLineage } from "../protocol/fetching";
import type { Clusters, Lineage } from "../protocol/messages";
import { clickSide, IndividualMenu, keyOnSide } from "./IndividualMenu";
import { NumberField, Section } from "./parts";
import { Thumbnail } from "./Thumbnail";
import { useStudio } from "./use";

export function ClusterSection() {
  const brushes = useStudio((state) => state.brushes);
  const folder = useStudio((state) => state.run?.state.folder ?? "");
  const [count, setCount] = useState(6);
  const [found, setFound] = useState<Clusters | null>(null);
  const [menu, setMenu] = useState<Side | null>(null);
  const group = () =>
    fetchClusters(documentInAddress(), { brushes, count }).then(setFound, (error: Error) =>
      notify(error.message),
    );
  const document = documentInAddress();
  return (
    <Section
      title="Clusters"
      aside={
        <button type="button" className="button" onClick={group}>
          Group
        </button>
      }
    >
      <NumberField label="Groups" value={count} least={1} whole onTake={setCount} />
      {!found && (
        <p className="explain">
          Groups what is brushed by springs, differential and largest force, and shows the
          individual in the middle of each.
        </p>
      )}
      <IndividualMenu
        side={menu}
        onOpen={setMenu}
        sideUnder={(event) =>
          (event.target as Element).closest<HTMLElement>("[data-side]")?.dataset.side ?? null
        }
      >
        <div className="clusters">
          {found?.clusters.map(({ generation, individual, size }, at) => (
            <button
              key={`${generation} ${individual}`}
              type="button"
              className="gallery-cell"
              aria-label={`Representative ${at + 1} of ${size} individuals: generation ${generation}, individual ${individual}`}
              data-side={sideOf(generation, individual)}
              onClick={(event) => clickSide(event, sideOf(generation, individual))}
              onKeyDown={(event) => keyOnSide(event, sideOf(generation, individual))}
            >
              <Thumbnail
                path={pathOfSide(document, sideOf(generation, individual))}
                revision={folder}
                width={82}
                height={66}
              />
              <small>
                <b>{inFull(size)}</b> alike
              </small>
            </button>
          ))}
        </div>
      </IndividualMenu>
    </Section>
  );
}

/** What every mutation on the way to the individual changed; a click shows its cells. */
export function LineageSection() {
  const looking = useStudio((state) => state.document?.looking ?? null);
  const [lineage, setLineage] = useState<Lineage | null>(null);
  useEffect(() => {
    let wanted = true;
    setLineage(null);
    if (looking?.generation)
      fetchLineage(documentInAddress(), looking.generation, looking.individual).then(
        (found) => wanted && setLineage(found),
        (error: Error) => notify(error.message),
      );
    return () => {
      wanted = false;
    };
  }, [looking]);
  if (!looking || !lineage) return null;
  const steps = [...lineage.steps].reverse().slice(0, 60);
  return (
    <Section
      title="Lineage"
      aside={<span className="aside">{inFull(lineage.steps.length)} ancestors</span>}
    >
      <ol className="lineage">
        {steps.map((step) => (
          <li key={step.generation}>
            <button
              type="button"
              title={step.edits.join("\n")}
              onClick={() => showCells(step.edits)}
            >
              <b>{inFull(step.generation)}</b>
              <span>{wordsOf(step.edits)}</span>
              <span>{inDigits(step.force_differential, 3)}</span>
            </button>
          </li>
        ))}
      </ol>
      <p className="explain">Click a step to see the cells that its mutation changed.</p>
    </Section>
  );
}

/** Selects the cells that edits changed, as far as they are there now: themselves, or what descends from them. */
function showCells(edits: string[]): void {
  const { net } = store.getState();
  const changed = edits.map((edit) => edit.split(" ")[0]);
  const keys = (net?.addresses ?? []).filter((cell) =>
    changed.some((one) => `${cell}.`.startsWith(`${one}.`)),
  );
  select({ kind: "cells", keys });
}

function wordsOf(edits: string[]): string {
  const count = (word: string) => edits.filter((edit) => edit.split(" ")[1] === word).length;
  const parts = [
    [count("subdivide"), "divided"],
    [count("retype"), "retyped"],
    [count("off"), "off"],
    [count("on"), "on"],
  ] as const;
  return parts.flatMap(([n, word]) => (n ? [`${n} ${word}`] : [])).join(", ") || "nothing";
}
