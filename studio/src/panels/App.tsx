// The page: the start, or a document with its tools, its net and its panels.
import { LoaderCircle } from "lucide-react";
import { Tooltip } from "radix-ui";
import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { Toaster, toast } from "sonner";
import { compareAsInAddress } from "../document/comparing";
import { openDocument, type State, store } from "../document/store";
import { documentInAddress } from "../protocol/address";
import { CompareOverlay, CompareTable, useIsComparing } from "./Compare";
import { commandOfKey, type Dialogs } from "./commands";
import { DialogsContext, useDialogs } from "./dialogs";
import { LookingBanner } from "./EvolvePanel";
import { Gallery } from "./Gallery";
import { LockState, OutlineOverlay } from "./GraftPanel";
import { Inspector } from "./Inspector";
import { LiveBanner } from "./LivePanel";
import { OutOfSight } from "./OutOfSight";
import { type OpenDialog, Overlays } from "./Overlays";
import { Busy } from "./parts";
import { perform } from "./performing";
import { useSteadyPresses } from "./presses";
import { StartPage } from "./StartPage";
import { StatusBar } from "./StatusBar";
import { BrushCircle, ToolHelp, ToolRail } from "./ToolRail";
import { TopBar } from "./TopBar";
import { type Stage, StageContext, useStudio } from "./use";
import { ViewportPane } from "./ViewportPane";

export function App() {
  const [stage, setStage] = useState<Stage | null>(null);
  const [dialog, setDialog] = useState<OpenDialog>(null);
  const dialogs = useMemo<Dialogs>(
    () => ({
      open: (name) => {
        if (name === "start") location.hash = "";
        else setDialog(name);
      },
    }),
    [],
  );
  const id = useDocumentInAddress();
  const theme = useStudio((state) => state.theme);
  const gallery = useStudio(showsGallery);
  useNotices(id);
  useFocusFrames();
  useSteadyPresses();
  useKeys(stage, dialogs, dialog !== null, id !== "");
  const close = useCallback(() => setDialog(null), []);
  return (
    <Tooltip.Provider delayDuration={350} skipDelayDuration={150} disableHoverableContent>
      <DialogsContext value={dialogs}>
        <StageContext value={stage}>
          {id ? <Workbench key={id} onStage={setStage} /> : <Front />}
          <Overlays open={dialog} onClose={close} />
          <Toaster
            theme={theme}
            position="bottom-right"
            offset={{ right: 384, bottom: gallery ? 312 : 50 }}
            visibleToasts={2}
            expand
            closeButton
            toastOptions={{ closeButtonAriaLabel: "Dismiss" }}
          />
        </StageContext>
      </DialogsContext>
    </Tooltip.Provider>
  );
}

const showsGallery = ({ gallery, run }: State) => gallery && run !== null;

function Front() {
  return (
    <div className="front">
      <TopBar />
      <StartPage />
      <footer className="front-busy">
        <Busy />
      </footer>
    </div>
  );
}

function Workbench({ onStage }: { onStage(stage: Stage | null): void }) {
  const ready = useStudio((state) => state.document !== null);
  const gallery = useStudio(showsGallery);
  const comparing = useIsComparing();
  const classes = ["workbench", gallery && "with-gallery", comparing && "comparing"];
  return (
    <div className={classes.filter(Boolean).join(" ")}>
      <TopBar />
      <ToolRail />
      <div className="banner">
        <LookingBanner />
        <LiveBanner />
      </div>
      <ViewportPane onStage={onStage}>
        <div className="notes">
          <ToolHelp />
          <LockState />
        </div>
        <OutlineOverlay />
        <BrushCircle />
        <CompareOverlay />
        <OutOfSight />
        <LineState />
      </ViewportPane>
      {gallery && <Gallery />}
      {comparing && <CompareTable />}
      {ready ? <Inspector /> : <aside className="inspector" aria-label="Panels" />}
      <StatusBar />
    </div>
  );
}

/** What is wrong with the line to the engine, over the net. */
function LineState() {
  const line = useStudio((state) => state.line);
  const problem = useStudio((state) => state.problem);
  const dialogs = useDialogs();
  if (line === "open" || line === "closed") return null;
  return (
    <div className="line-state" role="alert">
      {line === "refused" ? (
        <>
          <b>This document can't be opened.</b>
          <span>{problem}</span>
          <button type="button" className="button" onClick={() => dialogs.open("start")}>
            Back to the start
          </button>
        </>
      ) : (
        <>
          <LoaderCircle />
          <b>{line === "lost" ? "The engine does not answer." : "Opening …"}</b>
          {line === "lost" && (
            <span>
              Nothing is lost. If it was stopped, start it again with <code>springform studio</code>
              .
            </span>
          )}
        </>
      )}
    </div>
  );
}

function useDocumentInAddress(): string {
  const [id, setId] = useState(documentInAddress);
  useEffect(() => {
    const follow = () => {
      setId(documentInAddress());
      if (documentInAddress() === store.getState().document?.document) compareAsInAddress();
    };
    addEventListener("hashchange", follow);
    return () => removeEventListener("hashchange", follow);
  }, []);
  useEffect(() => {
    openDocument(id);
  }, [id]);
  return id;
}

/** Problems, until something was done; nothing that was told stays when another document is opened. */
function useNotices(id: string): void {
  const notice = useStudio((state) => state.notice);
  const told = useRef<string[]>([]);
  useEffect(() => {
    if (notice) {
      toast.error(notice.text, { id: notice.text });
      told.current.push(notice.text);
    } else {
      for (const text of told.current.splice(0)) toast.dismiss(text);
    }
  }, [notice]);
  useEffect(() => {
    // What the start page tells is of the document that it opens.
    return () => {
      if (id) toast.dismiss();
    };
  }, [id]);
}

/** Frames round what has the focus are for those who move it by keys; a shortcut moves nothing. */
function useFocusFrames(): void {
  useEffect(() => {
    const page = document.documentElement;
    const key = ({ key }: KeyboardEvent) => {
      if (key === "Tab" || key.startsWith("Arrow")) page.dataset.focus = "keys";
    };
    const point = () => delete page.dataset.focus;
    addEventListener("keydown", key, true);
    addEventListener("pointerdown", point, true);
    return () => {
      removeEventListener("keydown", key, true);
      removeEventListener("pointerdown", point, true);
    };
  }, []);
}

function isTextField(target: EventTarget | null): boolean {
  return (
    target instanceof HTMLTextAreaElement ||
    (target instanceof HTMLInputElement && !["checkbox", "range", "file"].includes(target.type))
  );
}

function useKeys(stage: Stage | null, dialogs: Dialogs, covered: boolean, working: boolean): void {
  const state = useStudio((all) => all.document !== null);
  useEffect(() => {
    const press = (event: KeyboardEvent) => {
      const at = event.target instanceof Element ? event.target : null;
      const typing = at?.closest("input, select, textarea, [role=menu]");
      const command = commandOfKey(event);
      if (covered || !command) return;
      const global = command.id === "keys" || command.id === "theme";
      if (!global && !(working && state)) return;
      if (typing && !event.ctrlKey && !event.metaKey) return;
      // In a field these mean its text.
      if (/^[acvxyz]$/i.test(event.key) && isTextField(event.target)) return;
      // Space and Enter press a focused button; they are not meant for the net then.
      if ((event.key === " " || event.key === "Enter") && at?.closest("button, [role=tab]")) return;
      event.preventDefault();
      perform(command, { viewport: stage?.viewport ?? null, dialogs });
    };
    addEventListener("keydown", press);
    return () => removeEventListener("keydown", press);
  }, [stage, dialogs, covered, working, state]);
}
