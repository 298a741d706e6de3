// Commands of what is seen: panels, views, and what is shown of the net.
import { isComparing } from "../document/comparing";
import { changeView, openPanel, type PanelId, store } from "../document/store";
import type { Command } from "./commands";
import { toggleSection } from "./SectionControl";

/** Panels by what a person may look for. */
const PANELS: { id: PanelId; label: string }[] = [
  { id: "net", label: "Net: open its panel" },
  { id: "cells", label: "Cells: open their panel" },
  { id: "framework", label: "Framework: open its panel" },
  { id: "evolve", label: "Evolve: open its panel" },
  { id: "graft", label: "Graft: open its panel, with patches" },
  { id: "history", label: "History: open its panel" },
];

export const VIEW_COMMANDS: Command[] = [
  ...PANELS.map(({ id, label }) => ({
    id: `panel-${id}`,
    label,
    group: "View" as const,
    refused: () => (isComparing() ? "close the comparison first" : null),
    run: () => openPanel(id),
  })),
  {
    id: "fit",
    label: "Fit the net",
    group: "View",
    keys: "F",
    run: ({ viewport }) => viewport?.fit(),
  },
  {
    id: "view-perspective",
    label: "View from the corner",
    group: "View",
    keys: "0",
    run: ({ viewport }) => viewport?.fit("perspective"),
  },
  {
    id: "view-front",
    label: "View from the front",
    group: "View",
    keys: "1",
    run: ({ viewport }) => viewport?.fit("front"),
  },
  {
    id: "view-right",
    label: "View from the right",
    group: "View",
    keys: "3",
    run: ({ viewport }) => viewport?.fit("right"),
  },
  {
    id: "view-top",
    label: "View from the top",
    group: "View",
    keys: "7",
    run: ({ viewport }) => viewport?.fit("top"),
  },
  {
    id: "view-back",
    label: "View from the back",
    group: "View",
    keys: "Ctrl+1",
    run: ({ viewport }) => viewport?.fit("back"),
  },
  {
    id: "view-left",
    label: "View from the left",
    group: "View",
    keys: "Ctrl+3",
    run: ({ viewport }) => viewport?.fit("left"),
  },
  {
    id: "view-bottom",
    label: "View from below",
    group: "View",
    keys: "Ctrl+7",
    run: ({ viewport }) => viewport?.fit("bottom"),
  },
  {
    id: "section",
    label: "Section through the net",
    group: "View",
    keys: "K",
    run: toggleSection,
  },
  {
    id: "cells",
    label: "Show cells as a skin",
    group: "View",
    keys: "C",
    run: () => changeView({ cells: !store.getState().view.cells }),
  },
  {
    id: "nodes",
    label: "Show nodes",
    group: "View",
    keys: "N",
    run: () => changeView({ nodes: !store.getState().view.nodes }),
  },
  {
    id: "reactions",
    label: "Show reactions",
    group: "View",
    keys: "T",
    run: () => changeView({ reactions: !store.getState().view.reactions }),
  },
  {
    id: "thickness",
    label: "Draw springs as thick as what they are coloured by",
    group: "View",
    keys: "W",
    run: () => changeView({ thickness: !store.getState().view.thickness }),
  },
  {
    id: "theme",
    label: "Dark or light",
    group: "View",
    keys: "D",
    run: () => store.setState(({ theme }) => ({ theme: theme === "dark" ? "light" : "dark" })),
  },
];
