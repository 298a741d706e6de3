// Grafting: patches that are copied from the net, kept, and set elsewhere after a look at what changes.
import { ChevronsRight, FlipHorizontal2, Pencil, RotateCw, Trash2 } from "lucide-react";
import { useMemo, useState } from "react";
import { useStore } from "zustand";
import { differentialTells } from "../document/figures";
import { type Grafting, grafting, type Place, putAway } from "../document/grafting";
import { kindColour } from "../document/palettes";
import {
  applyGraft,
  changePlace,
  copyPatch,
  freeName,
  mayApply,
  placesSeenFrom,
  selectBestAnchor,
  takePatch,
  turnGhost,
} from "../document/planning";
import { ask, store } from "../document/store";
import type { GraftFigures, PatchEntry } from "../protocol/messages";
import "./graft.css";
import { inDigits, inFull } from "../document/scale";
import { toggleLock } from "./graftCommands";
import { Choice, Hint, IconButton, NameField, type Option, Section } from "./parts";
import { useStudio } from "./use";

export function useGrafting<T>(what: (state: Grafting) => T): T {
  return useStore(grafting, what);
}

export function GraftPanel() {
  return (
    <>
      <Copying />
      <Library />
      <Setting />
      <Symmetry />
    </>
  );
}

function Copying() {
  const selection = useStudio((state) => state.selection);
  const net = useStudio((state) => state.net);
  const count = selection.kind === "cells" ? selection.keys.length : 0;
  // biome-ignore lint/correctness/useExhaustiveDependencies: they are read from the store
  const options = useMemo(() => placesSeenFrom(), [selection, net]);
  const [from, setFrom] = useState("");
  const [typed, setTyped] = useState("");
  const seen = options.find(({ value }) => value === from) ?? options[0];
  const free = useGrafting(freeName);
  const name = typed || free;
  const valid = /^[a-z][a-z0-9_]*$/.test(name);
  const copy = async () => {
    if (await copyPatch(name, seen)) setTyped("");
  };
  return (
    <Section
      title="Copy a patch"
      aside={<span className="aside">{count ? `${inFull(count)} cells selected` : ""}</span>}
    >
      {count === 0 ? (
        <>
          <p className="explain">
            Select cells, by a lasso (⇧L) or in rings round an anchor (O), also of an individual of
            a run. What is copied can be set elsewhere, in other nets too.
          </p>
          <div className="row">
            <Hint text="Selects two rings of cells round the anchor where the largest force is least: worth copying to the others">
              <button type="button" className="button" onClick={selectBestAnchor}>
                Rings round the best anchor
              </button>
            </Hint>
          </div>
        </>
      ) : (
        <>
          <Choice label="Seen from" value={seen.value} options={options} onTake={setFrom} />
          <label className="number-field">
            <span>Name</span>
            <input
              value={name}
              aria-invalid={!valid}
              onChange={(event) => setTyped(event.target.value)}
            />
          </label>
          {!valid && <p className="warning">A lower-case letter, then letters, digits and _.</p>}
          <div className="row">
            <button type="button" className="button primary" disabled={!valid} onClick={copy}>
              Copy patch
            </button>
          </div>
        </>
      )}
    </Section>
  );
}

function Library() {
  const patches = useGrafting((state) => state.patches);
  return (
    <Section
      title="Patches"
      aside={
        <span className="aside" title={patches?.folder}>
          kept for all nets
        </span>
      }
    >
      {patches?.patches.length ? (
        <ul className="patches">
          {patches.patches.map((patch) => (
            <PatchCard key={patch.name} patch={patch} />
          ))}
        </ul>
      ) : (
        <p className="explain">None yet.</p>
      )}
    </Section>
  );
}

function PatchCard({ patch }: { patch: PatchEntry }) {
  const chosen = useGrafting((state) => state.chosen === patch.name);
  const [naming, setNaming] = useState(false);
  const rename = (name: string) => {
    setNaming(false);
    if (name !== patch.name) ask({ type: "rename_patch", patch: patch.name, name }, "Renaming");
  };
  const put = () => {
    if (chosen) store.setState({ tool: "pull" });
    else takePatch(patch.name);
  };
  return (
    <li className={chosen ? "patch chosen" : "patch"}>
      <button
        type="button"
        className="patch-take"
        aria-pressed={chosen}
        aria-label={`Graft ${patch.name}`}
        disabled={!!patch.problem}
        onClick={put}
      >
        <Tiles patch={patch} />
      </button>
      <div className="patch-words">
        {naming ? (
          <NameField label="New name" name={patch.name} most={60} onDone={rename} />
        ) : (
          <b className="patch-name">{patch.name}</b>
        )}
        {patch.problem ? (
          <span className="warning" title={patch.problem}>
            can’t be read: {patch.problem}
          </span>
        ) : (
          <>
            <span>
              {inFull(patch.tiles.length)} cells in {inFull(patch.top_level)}
              {patch.anchored ? ", at an anchor" : ""}
            </span>
            <span title={patch.origin}>{patch.origin}</span>
          </>
        )}
        <div className="patch-actions">
          <span className="button patch-do" aria-hidden="true">
            {chosen ? "Put away" : "Graft"}
          </span>
          <IconButton
            label={`Rename ${patch.name}`}
            side="left"
            className="icon-button small"
            onClick={() => setNaming(true)}
          >
            <Pencil />
          </IconButton>
          <IconButton
            label={`Delete ${patch.name}`}
            side="left"
            className="icon-button small"
            onClick={() => ask({ type: "delete_patch", patch: patch.name }, "Deleting")}
          >
            <Trash2 />
          </IconButton>
        </div>
      </div>
    </li>
  );
}

function Tiles({ patch }: { patch: PatchEntry }) {
  const theme = useStudio((state) => state.theme);
  const { tiles } = patch;
  if (!tiles.length) return <span className="patch-empty">?</span>;
  const left = Math.min(...tiles.map(({ x }) => x));
  const bottom = Math.min(...tiles.map(({ y }) => y));
  const right = Math.max(...tiles.map(({ x, size }) => x + size));
  const top = Math.max(...tiles.map(({ y, size }) => y + size));
  const size = Math.max(right - left, top - bottom);
  const kinds = [...new Set(tiles.map(({ kind }) => kind))].sort();
  const box = [
    (left + right - size) / 2 - 0.06 * size,
    -(top + bottom + size) / 2 - 0.06 * size,
    1.12 * size,
    1.12 * size,
  ];
  return (
    <svg viewBox={box.join(" ")} width="60" height="60" aria-hidden="true">
      {tiles.map(({ x, y, size: side, kind }) => (
        <rect
          key={`${x} ${y} ${side}`}
          x={x}
          y={-y - side}
          width={side}
          height={side}
          fill={`rgb(${kindColour(kinds.indexOf(kind), kinds.length, theme, false).join(" ")} / 35%)`}
          stroke="currentColor"
          strokeWidth={size / 70}
        />
      ))}
      {patch.anchored && <circle cx={0} cy={0} r={size / 16} className="patch-anchor" />}
    </svg>
  );
}

const PLACES: Option<Place>[] = [
  { value: "one", name: "one place", explains: "the cell or the anchor that is clicked" },
  {
    value: "orbit",
    name: "all places alike (orbit)",
    explains: "where it is clicked, and at its images under the symmetries",
  },
  { value: "anchors", name: "all anchors", explains: "round every anchor where it fits" },
];

function Setting() {
  const { chosen, place, plan, pinned, problem, rotate, mirror, patches } = useGrafting(
    (state) => state,
  );
  if (!chosen) return null;
  const turns = plan?.turns ?? 4;
  const step = ((rotate % turns) + turns) % turns;
  const cells = patches?.patches.find(({ name }) => name === chosen)?.top_level ?? 0;
  return (
    <Section title={`Graft ${chosen}`}>
      <Choice label="To" value={place} options={PLACES} onTake={changePlace} />
      <div className="row">
        <button
          type="button"
          className="button icon"
          disabled={turns === 1}
          onClick={() => turnGhost({ rotate: 1 })}
        >
          <RotateCw /> Rotate{step ? ` (${step} of ${turns})` : ""}
        </button>
        <button
          type="button"
          className="button icon"
          aria-pressed={mirror}
          onClick={() => turnGhost({ mirror: true })}
        >
          <FlipHorizontal2 /> Mirror
        </button>
      </div>
      <div className="row">
        <button
          type="button"
          className="button primary"
          disabled={!mayApply({ plan, pinned, place })}
          onClick={() => applyGraft()}
        >
          Apply
        </button>
        <button
          type="button"
          className="button"
          onClick={() => {
            putAway();
            store.setState({ tool: "pull" });
          }}
        >
          Cancel
        </button>
      </div>
      {turns === 1 && (
        <p className="explain">
          Turned any further round {place === "anchors" ? "these anchors" : "this anchor"}, part of
          the patch would fall off the net.
        </p>
      )}
      {problem && (
        <p className="problem graft-problem" role="alert">
          {problem}
        </p>
      )}
      {!plan && !problem && (
        <p className="explain graft-explain">
          Move over a cell or an anchor; a click keeps the ghost there.
        </p>
      )}
      {plan && !plan.before && !pinned && (
        <p className="explain graft-explain">A click keeps it there and compares.</p>
      )}
      {plan?.before && plan.after && <Comparison before={plan.before} after={plan.after} />}
      {plan && (
        <p className="explain">
          {inFull(plan.placed.length)} {plan.placed.length === 1 ? "place" : "places"},{" "}
          {inFull(plan.placed.reduce((sum, { cells: here }) => sum + here.length, 0))} of{" "}
          {inFull(plan.placed.length * cells)} top-level cells
          {plan.skipped.length > 0 && (
            <span className="warning" title={plan.skipped.join("\n")}>
              {" "}
              · {inFull(plan.skipped.length)} do not fit: {plan.skipped[0]}
            </span>
          )}
        </p>
      )}
    </Section>
  );
}

function Comparison({ before, after }: { before: GraftFigures; after: GraftFigures }) {
  const tells = differentialTells(after, before);
  const inFour = (value: number | null) => inDigits(value, 4);
  const rows: [string, string, keyof GraftFigures, boolean, (value: number | null) => string][] = [
    ["Springs", "", "springs", false, inFull],
    ["Force differential", "", "force_differential", true, inFour],
    ["Largest force", "N", "force_max", true, inFour],
    ["Smallest force", "N", "force_min", false, inFour],
    ["Dangling nodes", "", "dangling", true, inFull],
  ];
  return (
    <table className="comparison">
      <thead>
        <tr>
          <th scope="col">At equilibrium</th>
          <th scope="col">before</th>
          <th scope="col">after</th>
        </tr>
      </thead>
      <tbody>
        {rows.map(([name, unit, key, less, said]) => {
          const [old, now] = [before[key] as number | null, after[key] as number | null];
          const better =
            old !== null &&
            now !== null &&
            old !== now &&
            less &&
            (key !== "force_differential" || tells)
              ? now < old
                ? "good"
                : "bad"
              : "";
          return (
            <tr key={key}>
              <th scope="row">
                {name}
                {unit && <span className="unit"> {unit}</span>}
              </th>
              <td>{said(old)}</td>
              <td className={better}>{said(now)}</td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}

function Symmetry() {
  const lock = useGrafting((state) => state.lock);
  return (
    <Section title="Symmetry">
      <label className="check">
        <input type="checkbox" checked={lock} onChange={toggleLock} />
        Lock: edit all cells and springs that are alike
      </label>
      <p className="explain">
        <SymmetryWords />
      </p>
    </Section>
  );
}

/** Which symmetry the framework has, in words. */
export function SymmetryWords() {
  const symmetry = useGrafting((state) => state.symmetry);
  if (!symmetry) return <>Symmetries are not known yet.</>;
  if (symmetry.problem) return <span className="warning">{symmetry.problem}</span>;
  const { rotations, mirrors, broken } = symmetry;
  const words =
    rotations + mirrors === 1
      ? "The framework has no symmetry."
      : `The framework has ${inFull(rotations)} rotations${mirrors ? ` and ${inFull(mirrors)} mirrors` : ""}.`;
  return (
    <>
      {words} {broken && <span className="warning">The net does not: {broken}.</span>}
    </>
  );
}

/** The outline of a box or a lasso over the net. */
export function OutlineOverlay() {
  const outline = useGrafting((state) => state.outline);
  if (outline.length < 2) return null;
  return (
    <svg className="outline" aria-hidden="true">
      <polygon points={outline.map((point) => point.join(",")).join(" ")} />
    </svg>
  );
}

/** Over the net while edits go to whole orbits. */
export function LockState() {
  const lock = useGrafting((state) => state.lock);
  if (!lock) return null;
  return (
    <p className="lock-state" role="status">
      <ChevronsRight />{" "}
      <span>
        <b>Symmetry lock.</b> <SymmetryWords />
      </span>
    </p>
  );
}
