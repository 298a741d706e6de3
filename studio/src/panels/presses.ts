// A quick second press means what the first one meant, not what stands there by then.
import { useEffect } from "react";

/** What a button does, as far as its words say it; a count in them is no other meaning. */
function meaningOf(target: EventTarget | null): string | null {
  const button = target instanceof Element ? target.closest("button") : null;
  if (!button) return null;
  const words = button.getAttribute("aria-label") ?? button.textContent ?? "";
  // What is pressed would be put away.
  const pressed = button.getAttribute("aria-pressed") ?? "";
  return words.replace(/\(.*?\)|[\d.,]+/g, "").trim() + pressed;
}

/** Ignores the second press of a double press where another button, or the same one with other words, has come. */
export function useSteadyPresses(): void {
  useEffect(() => {
    let first: string | null = null;
    const down = (event: MouseEvent) => {
      if (event.detail <= 1) first = meaningOf(event.target);
    };
    const press = (event: MouseEvent) => {
      const meaning = meaningOf(event.target);
      if (event.detail <= 1 || meaning === null || meaning === first) return;
      event.preventDefault();
      event.stopImmediatePropagation();
    };
    addEventListener("mousedown", down, true);
    addEventListener("click", press, true);
    return () => {
      removeEventListener("mousedown", down, true);
      removeEventListener("click", press, true);
    };
  }, []);
}
