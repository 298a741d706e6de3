// The menu of the document: open, recent, save, and files for others.
import { ChevronDown } from "lucide-react";
import { DropdownMenu } from "radix-ui";
import { useState } from "react";
import { documentInAddress } from "../protocol/address";
import { fetchShelf } from "../protocol/fetching";
import type { Shelf } from "../protocol/messages";
import { commandOf } from "./commands";
import { useDialogs } from "./dialogs";
import { MODELS } from "./exporting";
import { Keys } from "./parts";
import { perform } from "./performing";
import { useStage, useStudio } from "./use";

const MOST_RECENT = 8;

export function DocumentMenu() {
  const [recent, setRecent] = useState<Shelf["documents"] | null>(null);
  const name = useStudio((state) => state.document!.name);
  const load = (open: boolean) => {
    if (open)
      fetchShelf().then(
        ({ documents }) => setRecent(documents.filter(({ id }) => id !== documentInAddress())),
        () => setRecent([]),
      );
  };
  return (
    <DropdownMenu.Root modal={false} onOpenChange={load}>
      <DropdownMenu.Trigger className="document-button" aria-label={`Document ${name}`}>
        <h1>{name}</h1>
        <ChevronDown />
      </DropdownMenu.Trigger>
      <DropdownMenu.Portal>
        <DropdownMenu.Content className="menu" align="start" sideOffset={6} collisionPadding={8}>
          <Item id="start" />
          <DropdownMenu.Sub>
            <DropdownMenu.SubTrigger className="menu-item">Recent</DropdownMenu.SubTrigger>
            <DropdownMenu.Portal>
              <DropdownMenu.SubContent className="menu" collisionPadding={8}>
                {!recent?.length && (
                  <DropdownMenu.Label className="menu-label">
                    {recent ? "No other document yet" : "Looking for documents …"}
                  </DropdownMenu.Label>
                )}
                {recent?.slice(0, MOST_RECENT).map(({ id, name: other, changed }) => (
                  <DropdownMenu.Item
                    key={id}
                    className="menu-item"
                    onSelect={() => {
                      location.hash = id;
                    }}
                  >
                    {other}
                    <small>{new Date(1000 * changed).toLocaleString()}</small>
                  </DropdownMenu.Item>
                ))}
              </DropdownMenu.SubContent>
            </DropdownMenu.Portal>
          </DropdownMenu.Sub>
          <DropdownMenu.Separator className="menu-line" />
          <Item id="save" />
          <Item id="save-as" />
          <DropdownMenu.Separator className="menu-line" />
          <DropdownMenu.Label className="menu-label">Export</DropdownMenu.Label>
          <Item id="picture" />
          <Item id="drawing" />
          {MODELS.map((model) => (
            <Item key={model.name} id={`export-${model.name}`} />
          ))}
        </DropdownMenu.Content>
      </DropdownMenu.Portal>
    </DropdownMenu.Root>
  );
}

function Item({ id }: { id: string }) {
  const command = commandOf(id);
  const viewport = useStage()?.viewport ?? null;
  const dialogs = useDialogs();
  return (
    <DropdownMenu.Item
      className="menu-item"
      onSelect={() => perform(command, { viewport, dialogs })}
    >
      {command.label}
      {command.keys && <Keys keys={command.keys} />}
    </DropdownMenu.Item>
  );
}
