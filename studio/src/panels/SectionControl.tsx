// A section through the net: square to an axis, at a place that is slid.
import { FlipHorizontal2, Slice } from "lucide-react";
import { changeView, store } from "../document/store";
import { IconButton } from "./parts";
import { useStudio } from "./use";

const START = { axis: 1 as const, share: 0.5, flipped: false };

export function SectionButton() {
  const section = useStudio((state) => state.view.section);
  return (
    <IconButton
      label="Section through the net"
      keys="K"
      side="left"
      pressed={section !== null}
      onClick={toggleSection}
    >
      <Slice />
    </IconButton>
  );
}

export function toggleSection(): void {
  changeView({ section: current() ? null : START });
}

export function SectionControl() {
  const section = useStudio((state) => state.view.section);
  if (!section) return null;
  return (
    <fieldset className="floating section-control" aria-label="Section">
      {(["x", "y", "z"] as const).map((name, axis) => (
        <button
          key={name}
          type="button"
          className="icon-button small"
          aria-label={`Section across ${name}`}
          aria-pressed={section.axis === axis}
          onClick={() => changeView({ section: { ...section, axis: axis as 0 | 1 | 2 } })}
        >
          <span className="letter">{name}</span>
        </button>
      ))}
      <input
        type="range"
        min={0}
        max={1}
        step={0.005}
        value={section.share}
        aria-label="Place of the section"
        onChange={(event) =>
          changeView({ section: { ...section, share: Number(event.target.value) } })
        }
      />
      <IconButton
        label="The other side"
        side="top"
        pressed={section.flipped}
        onClick={() => changeView({ section: { ...section, flipped: !section.flipped } })}
      >
        <FlipHorizontal2 />
      </IconButton>
    </fieldset>
  );
}

function current() {
  return store.getState().view.section;
}
