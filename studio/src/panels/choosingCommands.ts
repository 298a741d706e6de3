// Commands of choosing among individuals: pins, comparisons, and the sort key that all pictures share.
import { MEASURES } from "../document/choosing";
import { compare, isComparing, likelySides, stopComparing, swapSides } from "../document/comparing";
import { lookAt, shownSide, togglePin } from "../document/pins";
import { mayContinue } from "../document/run";
import { steerRun } from "../document/starting";
import { ask, type State, store } from "../document/store";
import type { Command } from "./commands";
import { takeOver } from "./confirming";
import { sortBy, turnSort } from "./Sorting";

const needsRun = ({ run }: State) =>
  run && run.state.status !== "none" ? null : "there is no run";

const needsLook = ({ document }: State) =>
  document?.looking ? null : "your design is what is shown";

function whileRun(...statuses: string[]): (state: State) => string | null {
  return ({ run }) => {
    const status = run?.state.status ?? "none";
    return statuses.includes(status)
      ? null
      : status === "none"
        ? "there is no run"
        : `the run is ${status}`;
  };
}

export const CHOOSING_COMMANDS: Command[] = [
  {
    id: "run-pause",
    label: "Pause the run",
    group: "Choosing",
    refused: whileRun("running"),
    run: () => steerRun("pause"),
  },
  {
    id: "run-continue",
    label: "Continue the run",
    group: "Choosing",
    refused: (state) =>
      needsRun(state) ??
      (state.run && mayContinue(state.run) ? null : "it goes on, or has reached its end"),
    run: () => steerRun("continue"),
  },
  {
    id: "run-stop",
    label: "Stop the run",
    group: "Choosing",
    refused: whileRun("running", "paused"),
    run: () => steerRun("stop"),
  },
  {
    id: "run-follow",
    label: "Follow the run in the view, or no longer",
    group: "Choosing",
    refused: needsRun,
    run: () => {
      const on = !store.getState().run?.state.following;
      ask({ type: "follow", on }, "Following the run");
    },
  },
  {
    id: "take-over",
    label: "Take over what is shown as my design",
    words: "reinstate",
    group: "Choosing",
    refused: needsLook,
    run: () => void takeOver(),
  },
  {
    id: "back-to-design",
    label: "Back to my design",
    group: "Choosing",
    refused: needsLook,
    run: () => lookAt("design"),
  },
  {
    id: "compare-close",
    label: "Close the comparison",
    group: "Choosing",
    keys: "Escape",
    when: isComparing,
    refused: () => (isComparing() ? null : "nothing is compared"),
    run: stopComparing,
  },
  {
    id: "compare-swap",
    label: "Swap the two nets that are compared",
    group: "Choosing",
    keys: "S",
    when: isComparing,
    refused: () => (isComparing() ? null : "nothing is compared"),
    run: swapSides,
  },
  {
    id: "pin",
    label: "Pin what is shown, or unpin it",
    group: "Choosing",
    keys: "P",
    acts: true,
    run: () => togglePin(shownSide(store.getState().document)),
  },
  {
    id: "compare",
    label: "Compare two nets side by side",
    group: "Choosing",
    keys: "Shift+P",
    refused: () => (likelySides() ? null : "look at an individual, mark two, or pin one first"),
    run: () => {
      const sides = likelySides();
      if (sides) compare(...sides);
    },
  },
  {
    id: "gallery",
    label: "Gallery: show or hide the pictures of individuals",
    group: "Choosing",
    keys: "U",
    refused: needsRun,
    run: () => store.setState(({ gallery }) => ({ gallery: !gallery })),
  },
  {
    id: "ranking",
    label: "Pictures: a row a generation, or one ranking",
    group: "Choosing",
    refused: needsRun,
    run: () =>
      store.setState(({ sort }) => ({ sort: { ...sort, byGeneration: !sort.byGeneration } })),
  },
  {
    id: "pinned-only",
    label: "Pictures: what is pinned only, or all",
    group: "Choosing",
    refused: needsRun,
    run: () => store.setState(({ pinnedOnly }) => ({ pinnedOnly: !pinnedOnly })),
  },
  {
    id: "sort-turn",
    label: "Sort individuals the other way round",
    group: "Choosing",
    refused: needsRun,
    run: turnSort,
  },
  ...MEASURES.map(({ id, name }) => ({
    id: `sort-${id}`,
    label: `Sort individuals by ${name.toLowerCase()}`,
    group: "Choosing" as const,
    refused: needsRun,
    run: () => sortBy(id),
  })),
];
