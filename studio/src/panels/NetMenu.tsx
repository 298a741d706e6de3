// The menu of the right mouse button on the net: what can be done with what is under it.
import { ContextMenu } from "radix-ui";
import { typeName } from "../document/cellTypes";
import type { Net } from "../document/net";
import { inFull } from "../document/scale";
import { commandOf, retype } from "./commands";
import { useDialogs } from "./dialogs";
import { Keys } from "./parts";
import { perform } from "./performing";
import { useStage, useStudio } from "./use";

const ITEMS: Record<string, string[]> = {
  cells: ["subdivide", "off", "on", "turn"],
  springs: ["cut", "same-force"],
  nodes: ["hold", "slide-x", "slide-y", "slide-z", "let-go"],
};

export function NetMenu() {
  const selection = useStudio((state) => state.selection);
  const types = useStudio((state) => state.document?.cell_types);
  const anchor = useStudio(({ net, selection: { kind, keys } }) =>
    net && kind === "nodes" ? anchorAt(net, keys[0]) : null,
  );
  const title =
    selection.keys.length === 0
      ? "Nothing selected"
      : selection.keys.length > 1
        ? `${inFull(selection.keys.length)} ${selection.kind}`
        : `${selection.kind === "cells" ? "Cell" : selection.kind === "springs" ? "Spring" : anchor ? "Anchor" : "Node"} ${anchor ?? selection.keys[0]}`;
  return (
    <ContextMenu.Portal>
      <ContextMenu.Content className="menu" collisionPadding={8}>
        <ContextMenu.Label className="menu-label">{title}</ContextMenu.Label>
        {selection.keys.length > 0 && ITEMS[selection.kind].map((id) => <Item key={id} id={id} />)}
        {selection.kind === "cells" && selection.keys.length > 0 && types && (
          <ContextMenu.Sub>
            <ContextMenu.SubTrigger className="menu-item">Type</ContextMenu.SubTrigger>
            <ContextMenu.Portal>
              <ContextMenu.SubContent className="menu">
                {types.map(({ word }) => (
                  <ContextMenu.Item key={word} className="menu-item" onSelect={() => retype(word)}>
                    {typeName(word)}
                  </ContextMenu.Item>
                ))}
              </ContextMenu.SubContent>
            </ContextMenu.Portal>
          </ContextMenu.Sub>
        )}
        {selection.keys.length > 0 && <ContextMenu.Separator className="menu-line" />}
        <Item id="fit" />
        <Item id="section" />
        <Item id="undo" />
        <Item id="redo" />
      </ContextMenu.Content>
    </ContextMenu.Portal>
  );
}

function anchorAt(net: Net, node: string | undefined): string | null {
  const place = [...net.anchors].findIndex((row) => net.nodes[row] === node);
  return place < 0 ? null : net.anchorNames[place];
}

function Item({ id }: { id: string }) {
  const command = commandOf(id);
  const refused = useStudio((state) => command.refused?.(state) ?? null);
  const viewport = useStage()?.viewport ?? null;
  const dialogs = useDialogs();
  if (refused && (id === "hold" || id === "let-go")) return null;
  return (
    <ContextMenu.Item
      className="menu-item"
      disabled={refused !== null}
      onSelect={() => perform(command, { viewport, dialogs })}
    >
      {command.label}
      {command.keys && <Keys keys={command.keys} />}
    </ContextMenu.Item>
  );
}
