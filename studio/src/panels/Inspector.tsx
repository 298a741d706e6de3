// The panels at the right.
import { Tabs } from "radix-ui";
import { type ReactNode, useEffect, useRef } from "react";
import { openPanel, type PanelId } from "../document/store";
import { CellTree } from "./CellTree";
import { EvolvePanel } from "./EvolvePanel";
import { FrameworkPanel } from "./FrameworkPanel";
import { GraftPanel } from "./GraftPanel";
import { HistoryPanel } from "./HistoryPanel";
import { NetPanel } from "./NetPanel";
import { useStudio } from "./use";

const PANELS: { id: PanelId; name: string; Panel: () => ReactNode }[] = [
  { id: "net", name: "Net", Panel: NetPanel },
  { id: "cells", name: "Cells", Panel: CellTree },
  { id: "framework", name: "Framework", Panel: FrameworkPanel },
  { id: "evolve", name: "Evolve", Panel: EvolvePanel },
  { id: "graft", name: "Graft", Panel: GraftPanel },
  { id: "history", name: "History", Panel: HistoryPanel },
];

export function Inspector() {
  const panel = useStudio((state) => state.panel);
  const selection = useStudio((state) => state.selection);
  const aside = useRef<HTMLElement>(null);
  // What was just selected stands at the top of its panel.
  useEffect(() => {
    if (selection.keys.length) aside.current?.querySelector(".panel-net")?.scrollTo({ top: 0 });
  }, [selection]);
  return (
    <aside className="inspector" aria-label="Panels" ref={aside}>
      <Tabs.Root value={panel} onValueChange={(value) => openPanel(value as PanelId)}>
        <Tabs.List className="tabs" aria-label="Panels">
          {PANELS.map(({ id, name }) => (
            <Tabs.Trigger key={id} value={id}>
              {name}
            </Tabs.Trigger>
          ))}
        </Tabs.List>
        {PANELS.map(({ id, Panel }) => (
          <Tabs.Content key={id} value={id} className={`panel panel-${id}`}>
            <Panel />
          </Tabs.Content>
        ))}
      </Tabs.Root>
    </aside>
  );
}
