// Does a command, wherever it was chosen; if it can't be done, it is said why.
import { toast } from "sonner";
import { store } from "../document/store";
import { inTurn } from "../document/turns";
import type { Command } from "./commands";

/** Does a command, in its turn if it acts on the document. */
export function perform(command: Command, stage: Parameters<Command["run"]>[0]): void {
  const act = () => {
    const refused = command.refused?.(store.getState()) ?? null;
    if (refused === null) command.run(stage);
    else toast.message(refused, { id: "refused" });
  };
  if (command.acts) inTurn(act);
  else act();
}
