// The menu of the right mouse button on an individual, wherever it is shown, and what keys do with it.
import { ContextMenu } from "radix-ui";
import type { ReactNode } from "react";
import { compare, isComparing, setSide } from "../document/comparing";
import {
  labelOfSide,
  lookAt,
  pinOfSide,
  type Side,
  shownSide,
  toggleMark,
  togglePin,
} from "../document/pins";
import { store } from "../document/store";
import { Keys } from "./parts";
import { useStudio } from "./use";

/** What a click on an individual does: it is looked at, put into the comparison, or marked for one. */
export function clickSide(event: React.MouseEvent, side: Side): void {
  if (event.ctrlKey || event.metaKey || event.shiftKey) toggleMark(side);
  else if (isComparing()) setSide(1, side);
  else lookAt(side);
}

/** What keys do with the individual that has the focus; others go on to the page. */
export function keyOnSide(event: React.KeyboardEvent, side: Side): void {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const key = event.key.toLowerCase();
  if (key === "p" && !event.shiftKey) togglePin(side);
  else if (key === "m") toggleMark(side);
  else return;
  event.preventDefault();
  event.stopPropagation();
}

/** Gives its child a menu for the individual that `sideUnder` finds, or none. */
export function IndividualMenu({
  side,
  sideUnder,
  onOpen,
  children,
}: {
  side: Side | null;
  sideUnder(event: React.MouseEvent): Side | null;
  onOpen(side: Side): void;
  children: ReactNode;
}) {
  return (
    <ContextMenu.Root>
      <ContextMenu.Trigger
        asChild
        onContextMenu={(event) => {
          const under = sideUnder(event);
          if (under) onOpen(under);
          else event.preventDefault();
        }}
      >
        {children}
      </ContextMenu.Trigger>
      {side && <Items side={side} />}
    </ContextMenu.Root>
  );
}

function Items({ side }: { side: Side }) {
  const pinned = useStudio((state) => pinOfSide(state, side) !== null);
  const marked = useStudio((state) => state.marked.includes(side));
  const pins = useStudio((state) => state.pins);
  const shown = useStudio((state) => shownSide(state.document));
  const item = (label: string, act: () => void, keys?: string) => (
    <ContextMenu.Item className="menu-item" onSelect={act}>
      {label}
      {keys && <Keys keys={keys} />}
    </ContextMenu.Item>
  );
  return (
    <ContextMenu.Portal>
      <ContextMenu.Content className="menu" collisionPadding={8}>
        <ContextMenu.Label className="menu-label">{labelOfSide(pins, side)}</ContextMenu.Label>
        {item("Look at it", () => lookAt(side))}
        {item(pinned ? "Unpin" : "Pin", () => togglePin(side), "P")}
        <ContextMenu.Separator className="menu-line" />
        {item("Compare with my design", () => compare("design", side))}
        {shown !== "design" &&
          shown !== side &&
          item("Compare with what is shown", () => compare(shown, side))}
        {item(marked ? "Take the mark away" : "Mark for a comparison", () => toggleMark(side), "M")}
      </ContextMenu.Content>
    </ContextMenu.Portal>
  );
}

/** Compares the two nets that are marked. */
export function compareMarked(): void {
  const [first, second] = store.getState().marked;
  if (second) compare(first, second);
}
