// The bar at the bottom: form-finding and whether it has converged, and what the engine is busy with.
import { Pause, Play, RotateCcw, StepForward } from "lucide-react";
import { inDigits, inFull } from "../document/scale";
import { useIsComparing } from "./Compare";
import { move } from "./commands";
import { Busy, IconButton } from "./parts";
import { useStudio } from "./use";

export function StatusBar() {
  const running = useStudio((state) => state.motion?.header.running ?? true);
  return (
    <footer className="status-bar">
      <fieldset className="motion-buttons" aria-label="Form-finding">
        <IconButton
          label={running ? "Pause form-finding" : "Run form-finding"}
          keys="Space"
          side="top"
          onClick={() => move(running ? "pause" : "run")}
        >
          {running ? <Pause /> : <Play />}
        </IconButton>
        <IconButton label="Make one step" keys="." side="top" onClick={() => move("step")}>
          <StepForward />
        </IconButton>
        <IconButton
          label="Put the net back to where it was drawn"
          keys="Shift+R"
          side="top"
          onClick={() => move("reset")}
        >
          <RotateCcw />
        </IconButton>
      </fieldset>
      <Badge />
      <Residual />
      <div className="gap" />
      <Busy />
      <Counts />
    </footer>
  );
}

function Badge() {
  const header = useStudio((state) => state.motion?.header);
  if (!header) return <span className="badge">waiting</span>;
  if (header.held.length) return <span className="badge pulled">pulled</span>;
  if (header.converged) return <span className="badge converged">converged</span>;
  if (header.settled) {
    return (
      <span className="badge failed" title={header.reason}>
        no equilibrium
      </span>
    );
  }
  return header.running ? (
    <span className="badge moving">moving</span>
  ) : (
    <span className="badge">paused</span>
  );
}

function Residual() {
  const residual = useStudio((state) => state.motion?.header.residual ?? null);
  const steps = useStudio((state) => state.motion?.header.steps ?? 0);
  const took = useStudio((state) => state.motion?.header.took ?? 0);
  const reason = useStudio((state) => state.motion?.header.reason ?? "");
  return (
    <>
      <span
        className="status-fact"
        title="Largest force out of balance at a free node over the mean spring force"
      >
        residual <b>{inDigits(residual, 2)}</b>
      </span>
      <span
        className="status-fact"
        title={`Steps since the net was last disturbed; the last one took ${inDigits(1000 * took, 2)} ms`}
      >
        step <b>{inFull(steps)}</b>
      </span>
      {reason && <span className="status-fact warning">{reason}</span>}
    </>
  );
}

function Counts() {
  const net = useStudio((state) => state.net);
  const comparing = useIsComparing();
  // The figures of both nets that are compared stand beside them.
  if (!net || comparing) return null;
  return (
    <span className="status-fact">
      <b>{inFull(net.ends.length / 2)}</b> springs · <b>{inFull(net.nodes.length)}</b> nodes ·{" "}
      <b>{inFull(net.addresses.length)}</b> cells
    </span>
  );
}
