// Evolution: its parameters, its course, all individuals, and what becomes of them.
import { Columns2, Images, Pin, PinOff } from "lucide-react";
import { compare } from "../document/comparing";
import { lookAt, pinOfSide, shownSide, togglePin } from "../document/pins";
import { inDigits, inFull } from "../document/scale";
import { changeableOf } from "../document/starting";
import { ask, store } from "../document/store";
import { ClusterSection, LineageSection } from "./Choosing";
import { takeOver } from "./confirming";
import { LiveSection } from "./LivePanel";
import { ParallelCoordinates } from "./ParallelCoordinates";
import { PinnedSection } from "./Pins";
import { IconButton, Section } from "./parts";
import { RunSection } from "./RunSection";
import { Scatter } from "./Scatter";
import { RankLegend, SortControl } from "./Sorting";
import { useStudio } from "./use";

export function EvolvePanel() {
  const run = useStudio((state) => state.run);
  return (
    <>
      <LiveSection />
      <RunSection />
      <PinnedSection />
      {run && run.rows.length > 0 && (
        <Section title="Individuals" aside={<GalleryButton />}>
          <SortControl label="Sorted by" />
          <RankLegend />
          <Scatter />
          <ParallelCoordinates />
        </Section>
      )}
      <LineageSection />
      {run && run.rows.length > 0 && <ClusterSection />}
    </>
  );
}

function GalleryButton() {
  const open = useStudio((state) => state.gallery);
  return (
    <button
      type="button"
      className="button icon"
      aria-pressed={open}
      onClick={() => store.setState({ gallery: !open })}
    >
      <Images /> {open ? "Hide pictures" : "Pictures"}
    </button>
  );
}

/** Over the net, while something else than the design is shown. */
export function LookingBanner() {
  const looking = useStudio((state) => state.document?.looking ?? null);
  const figures = useStudio((state) => state.document?.figures);
  const own = useStudio((state) => state.document?.own);
  const run = useStudio((state) => state.run);
  const shown = useStudio((state) => shownSide(state.document));
  const pinned = useStudio((state) => pinOfSide(state, shown) !== null);
  if (!looking || !figures || !own) return null;
  return (
    <div className="looking" role="status">
      <span>
        <b>{looking.label}</b>
        {inFull(figures.springs)} springs, force differential{" "}
        {inDigits(figures.force_differential, 4)}
        <small>
          My design: {inFull(own.springs)} and {inDigits(own.force_differential, 4)}
        </small>
      </span>
      <button type="button" className="button primary" onClick={takeOver}>
        Take over as my design
      </button>
      <button
        type="button"
        className="button"
        onClick={() =>
          ask(
            { type: "evolve", side: shown, parameters: changeableOf(run?.state.parameters ?? {}) },
            "Starting the run",
          )
        }
      >
        Breed from this
      </button>
      <button type="button" className="button" onClick={() => lookAt("design")}>
        Back to my design
      </button>
      <IconButton
        label={pinned ? "Unpin it" : "Pin it"}
        keys="P"
        pressed={pinned}
        onClick={() => togglePin(shown)}
      >
        {pinned ? <PinOff /> : <Pin />}
      </IconButton>
      <IconButton
        label="Compare with my design"
        keys="Shift+P"
        onClick={() => compare("design", shown)}
      >
        <Columns2 />
      </IconButton>
    </div>
  );
}
