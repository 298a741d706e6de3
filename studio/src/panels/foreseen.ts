// What makes a button show what it would do, for as long as the pointer or the keyboard rests on it.
import { type Foreseen, foresee, forget } from "../document/previews";

/** Properties of such a button. */
export function foreseen(label: string, action: Foreseen) {
  const show = () => foresee(label, action);
  return { onPointerEnter: show, onFocus: show, onPointerLeave: forget, onBlur: forget };
}
