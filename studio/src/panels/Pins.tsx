// What is pinned: a strip of nets with their figures, kept with the document.
import { Columns2, Pencil, Pin, PinOff } from "lucide-react";
import { useRef, useState } from "react";
import { compareWith } from "../document/comparing";
import {
  labelOfSide,
  lookAt,
  pathOfSide,
  pinOfSide,
  renamePin,
  type Side,
  shownSide,
  sideOf,
  toggleMark,
  togglePin,
} from "../document/pins";
import { inDigits, inFull } from "../document/scale";
import type { PinState } from "../protocol/messages";
import { commandOf } from "./commands";
import { Hint, IconButton, NameField, Section } from "./parts";
import { Thumbnail } from "./Thumbnail";
import { useStudio } from "./use";

const RENAME_KEY = "F2";

/** Pins what is shown, or lets it go. */
function PinButton() {
  const shown = useStudio((state) => shownSide(state.document));
  const pinned = useStudio((state) => pinOfSide(state, shown) !== null);
  return (
    <Hint text={pinned ? "Let it go" : "Keep what is shown at hand"} keys={commandOf("pin").keys}>
      <button
        type="button"
        className="button icon"
        aria-pressed={pinned}
        onClick={() => togglePin(shown)}
      >
        {pinned ? <PinOff /> : <Pin />} {pinned ? "Unpin" : "Pin"}
      </button>
    </Hint>
  );
}

export function PinnedSection() {
  const pins = useStudio((state) => state.pins);
  return (
    <Section title={pins.length ? `Pinned (${pins.length})` : "Pinned"} aside={<PinButton />}>
      {pins.length === 0 && (
        <p className="explain">
          A pinned net stays at hand with this document, whatever becomes of its run.
        </p>
      )}
      <ul className="pins" aria-label="Pinned nets">
        {pins.map((pin) => (
          <PinLine key={pin.number} pin={pin} />
        ))}
      </ul>
    </Section>
  );
}

function PinLine({ pin }: { pin: PinState }) {
  const document = useStudio((state) => state.document?.document ?? "");
  const side: Side = `pin/${pin.number}`;
  const current = useStudio(
    (state) => pinOfSide(state, shownSide(state.document))?.number === pin.number,
  );
  const marked = useStudio((state) => state.marked.includes(side));
  const { figures, suf } = pin;
  const origin = originOf(pin);
  const look = useRef<HTMLButtonElement>(null);
  const [naming, setNaming] = useState(false);
  const named = (name: string, byKey: boolean) => {
    setNaming(false);
    if (byKey) look.current?.focus();
    renamePin(pin, name);
  };
  return (
    <li className={marked ? "marked" : ""}>
      <button
        ref={look}
        type="button"
        className="pin-look"
        aria-pressed={current}
        aria-label={`Look at ${pin.label}`}
        onClick={(event) =>
          event.ctrlKey || event.metaKey || event.shiftKey ? toggleMark(side) : lookAt(side)
        }
        onKeyDown={(event) => {
          if (event.key === RENAME_KEY) setNaming(true);
        }}
      >
        <Thumbnail path={pathOfSide(document, side)} width={72} height={56} />
      </button>
      <div>
        {naming ? (
          <NameField label="Name of the pin" name={pin.label} most={80} onDone={named} />
        ) : (
          <b>{pin.label}</b>
        )}
        {origin !== pin.label && <small>{origin}</small>}
        <dl>
          <dt>Springs</dt>
          <dd>{inFull(figures.springs)}</dd>
          <dt>Differential</dt>
          <dd>{inDigits(figures.force_differential)}</dd>
          {suf !== null && (
            <>
              <dt>SUF</dt>
              <dd>{inDigits(suf)}</dd>
            </>
          )}
          <dt>Area</dt>
          <dd>{inDigits(figures.area)} m²</dd>
        </dl>
      </div>
      <div className="pin-buttons">
        <IconButton label={`Compare ${pin.label}`} side="left" onClick={() => compareWith(side)}>
          <Columns2 />
        </IconButton>
        <IconButton
          label={`Rename ${pin.label}`}
          keys={RENAME_KEY}
          side="left"
          onClick={() => setNaming(true)}
        >
          <Pencil />
        </IconButton>
        <IconButton label={`Unpin ${pin.label}`} side="left" onClick={() => togglePin(side)}>
          <PinOff />
        </IconButton>
      </div>
    </li>
  );
}

/** What a pin of a run would be called by itself. */
function originOf({ label, place }: PinState): string {
  return place === null || place.individual === null
    ? label
    : labelOfSide([], sideOf(place.generation, place.individual));
}
