// The canvas, and what lies over it: names of anchors, what the pointer is on, legend, views.
import { Anchor, CircleDot, Grid2x2, Maximize, MoveUpRight, Spline } from "lucide-react";
import { ContextMenu } from "radix-ui";
import { type ReactNode, useEffect, useRef, useState } from "react";
import { comparing } from "../document/comparing";
import { positionOf } from "../document/motion";
import type { Pictured } from "../document/pictured";
import { inDigits } from "../document/scale";
import { cutOf, keeps } from "../document/section";
import { clicked, springKey } from "../document/selection";
import { changeView, select, store } from "../document/store";
import { Hands } from "../tools/hands";
import type { StandardView } from "../viewport/camera";
import { Viewport } from "../viewport/scene";
import { HoverCard } from "./HoverCard";
import { Legend } from "./Legend";
import { NetMenu } from "./NetMenu";
import { PreviewCard } from "./PreviewCard";
import { IconButton } from "./parts";
import { SectionButton, SectionControl } from "./SectionControl";
import { type Stage, useStage, useStudio } from "./use";

/** Names of anchors are shown while they leave room for the net. */
const MOST_NAMES = 40;

/** Width that the buttons take at the right edge [px]. */
const BUTTONS = 60;

export function ViewportPane({
  onStage,
  children,
}: {
  onStage(stage: Stage | null): void;
  children?: ReactNode;
}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const names = useRef<HTMLDivElement>(null);
  const pull = useRef<HTMLDivElement>(null);
  const [failed, setFailed] = useState(false);
  useEffect(() => {
    let viewport: Viewport;
    try {
      viewport = new Viewport(canvas.current!);
    } catch {
      setFailed(true);
      return;
    }
    const hands = new Hands(viewport, canvas.current!);
    viewport.onDraw = () => {
      placeNames(viewport, names.current!);
      placePull(viewport, pull.current!);
    };
    onStage({ viewport, hands });
    return () => {
      onStage(null);
      hands.dispose();
      viewport.dispose();
    };
  }, [onStage]);

  const stage = useStage();
  const selectUnder = (event: React.MouseEvent) => {
    const { net, selection } = store.getState();
    const hit = stage?.hands.under(event);
    if (!net || !hit) return;
    const kind = hit.kind === "node" ? "nodes" : hit.kind === "spring" ? "springs" : "cells";
    const key =
      hit.kind === "node"
        ? net.nodes[hit.row]
        : hit.kind === "spring"
          ? springKey(net, hit.row)
          : net.addresses[hit.row];
    if (selection.kind !== kind || !selection.keys.includes(key))
      select(clicked(selection, kind, key, false));
  };

  return (
    <main className="viewport" aria-label="Net">
      {failed && (
        <p className="empty" role="alert">
          This browser can't draw in three dimensions. Switch on hardware acceleration or WebGL in
          its settings, then load the page again.
        </p>
      )}
      <ContextMenu.Root>
        <ContextMenu.Trigger asChild onContextMenu={selectUnder}>
          <canvas
            ref={canvas}
            tabIndex={0}
            role="img"
            aria-label="The net; the panels beside it hold all that can be done with it"
          />
        </ContextMenu.Trigger>
        <NetMenu />
      </ContextMenu.Root>
      <div className="anchor-names" ref={names} aria-hidden="true" />
      <div className="pull-force" ref={pull} hidden />
      <HoverCard />
      <PreviewCard />
      <Legend />
      <SectionControl />
      <ViewButtons />
      {children}
    </main>
  );
}

interface Named {
  name: string;
  place: [number, number];
}

/** Names of a net's anchors where they are seen, in one half of a comparison or in the whole view. */
function namesOf(viewport: Viewport, { net, motion }: Pictured, half: 0 | 1 | null): Named[] {
  if (net.anchors.length > MOST_NAMES) return [];
  const cut = cutOf(store.getState().view.section, motion.positions);
  return [...net.anchors].flatMap((node, anchor) => {
    const there = keeps(cut, motion.positions, node);
    const place = there ? viewport.project(positionOf(motion, node), half) : null;
    return place ? [{ name: net.anchorNames[anchor], place }] : [];
  });
}

function placeNames(viewport: Viewport, layer: HTMLElement): void {
  const { net, motion, view } = store.getState();
  const { sides, nets } = comparing.getState();
  const pair = ([0, 1] as const).flatMap((half) => {
    const pictured = nets[half];
    return pictured ? namesOf(viewport, pictured, half) : [];
  });
  const one = net && motion && !sides ? namesOf(viewport, { net, motion }, null) : [];
  const shown = !view.anchors ? [] : sides ? pair : one;
  while (layer.children.length > shown.length) layer.lastChild!.remove();
  while (layer.children.length < shown.length) layer.append(document.createElement("span"));
  shown.forEach(({ name, place }, at) => {
    const label = layer.children[at] as HTMLElement;
    if (label.textContent !== name) label.textContent = name;
    label.style.transform = `translate(${Math.round(place[0] + 9)}px, ${Math.round(place[1] - 20)}px)`;
  });
}

/** The force that it takes to hold the node in the hand, beside it. */
function placePull(viewport: Viewport, label: HTMLElement): void {
  const { motion } = store.getState();
  const held = motion?.header.held[0];
  const place = motion && held !== undefined ? viewport.project(positionOf(motion, held)) : null;
  label.hidden = !place;
  if (!motion || !place) return;
  label.textContent = `${inDigits(motion.header.held_by[0], 3)} N`;
  // Left of the node where the buttons of the view would hide it.
  const room = label.parentElement!.clientWidth - BUTTONS - label.offsetWidth;
  const left = place[0] + 14 < room ? place[0] + 14 : place[0] - 14 - label.offsetWidth;
  label.style.transform = `translate(${Math.round(left)}px, ${Math.round(place[1] + 10)}px)`;
}

const VIEWS: { view: StandardView; name: string; letter: string; keys: string }[] = [
  { view: "perspective", name: "From the corner", letter: "3D", keys: "0" },
  { view: "front", name: "From the front", letter: "F", keys: "1" },
  { view: "right", name: "From the right", letter: "R", keys: "3" },
  { view: "top", name: "From the top", letter: "T", keys: "7" },
];

function ViewButtons() {
  const stage = useStage();
  const view = useStudio((state) => state.view);
  return (
    <>
      <div className="floating view-buttons" role="toolbar" aria-label="Views">
        {VIEWS.map(({ view: direction, name, letter, keys }) => (
          <IconButton
            key={direction}
            label={name}
            keys={keys}
            side="left"
            onClick={() => stage?.viewport.fit(direction)}
          >
            <span className="letter">{letter}</span>
          </IconButton>
        ))}
        <IconButton label="Fit the net" keys="F" side="left" onClick={() => stage?.viewport.fit()}>
          <Maximize />
        </IconButton>
      </div>
      <div className="floating show-buttons" role="toolbar" aria-label="What is shown">
        <IconButton
          label="Cells as a skin"
          keys="C"
          side="left"
          pressed={view.cells}
          onClick={() => changeView({ cells: !view.cells })}
        >
          <Grid2x2 />
        </IconButton>
        <IconButton
          label="Nodes"
          keys="N"
          side="left"
          pressed={view.nodes}
          onClick={() => changeView({ nodes: !view.nodes })}
        >
          <CircleDot />
        </IconButton>
        <IconButton
          label="Anchors and their names"
          side="left"
          pressed={view.anchors}
          onClick={() => changeView({ anchors: !view.anchors })}
        >
          <Anchor />
        </IconButton>
        <IconButton
          label="Reactions"
          keys="T"
          side="left"
          pressed={view.reactions}
          onClick={() => changeView({ reactions: !view.reactions })}
        >
          <MoveUpRight />
        </IconButton>
        <IconButton
          label="Springs as thick as what they are coloured by"
          keys="W"
          side="left"
          pressed={view.thickness}
          onClick={() => changeView({ thickness: !view.thickness })}
        >
          <Spline />
        </IconButton>
        <SectionButton />
      </div>
    </>
  );
}
