// What to do when the net is not in the picture, as after a far move was undone.
import { Scan } from "lucide-react";
import { useEffect, useState } from "react";
import { Keys } from "./parts";
import { useStage } from "./use";

const EVERY = 700; // ms

export function OutOfSight() {
  const viewport = useStage()?.viewport ?? null;
  const [away, setAway] = useState(false);
  useEffect(() => {
    const timer = setInterval(() => setAway(viewport !== null && !viewport.showsNet()), EVERY);
    return () => clearInterval(timer);
  }, [viewport]);
  if (!away) return null;
  return (
    <div className="line-state" role="status">
      <b>The net is out of sight.</b>
      <button type="button" className="button icon" onClick={() => viewport?.fit()}>
        <Scan /> Fit the net <Keys keys="F" />
      </button>
    </div>
  );
}
