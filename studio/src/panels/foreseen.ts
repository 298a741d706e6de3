// What makes a button show what it would do, for as long as the pointer or the keyboard rests on it.
import type { FocusEvent, PointerEvent } from "react";
import { type Foreseen, foresee, forget } from "../document/previews";

/** Where the pointer pressed last [px]. */
let pressed = { x: Number.NaN, y: Number.NaN };

/** Properties of such a button. What is pressed is done, not looked at, and so is what comes under a pointer that rests. */
export function foreseen(label: string, action: Foreseen) {
  const show = () => foresee(label, action);
  return {
    onPointerEnter: ({ clientX, clientY }: PointerEvent) => {
      if (clientX !== pressed.x || clientY !== pressed.y) show();
    },
    onPointerDown: ({ clientX, clientY }: PointerEvent) => {
      pressed = { x: clientX, y: clientY };
      forget();
    },
    onFocus: ({ currentTarget }: FocusEvent) => {
      if (currentTarget.matches(":focus-visible")) show();
    },
    onPointerLeave: forget,
    onBlur: forget,
  };
}
