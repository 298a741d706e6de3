// What a tool is: a small machine that pointer and keys drive.
import type { Hit } from "../viewport/picking";
import type { Viewport } from "../viewport/scene";

/** A pointer on the canvas. */
export interface Pointer {
  /** [px] from the canvas's corner. */
  x: number;
  y: number;
  shift: boolean;
  control: boolean;
}

/** What the pointer may hit while a tool is in the hand. */
export interface Reach {
  nodes?: boolean;
  springs?: boolean;
  cells?: boolean;
}

/** A tool in the hand. */
export interface Tool {
  readonly reach: Reach;
  readonly cursor: string;
  /** Whether a drag is followed at once, whatever lies under the pointer. */
  readonly direct?: boolean;
  /** Whether it passes over cells with a brush, whose size is seen. */
  readonly brushes?: boolean;
  /** The button goes down on something; returns whether the tool takes the drag from the eye. */
  down(viewport: Viewport, hit: Hit | null, pointer: Pointer): boolean;
  /** A drag that the tool took goes on. */
  drag(viewport: Viewport, hit: Hit | null, pointer: Pointer): void;
  /** A drag that the tool took ends. */
  drop(viewport: Viewport, pointer: Pointer): void;
  /** The button went down and up in one place. */
  click(viewport: Viewport, hit: Hit | null, pointer: Pointer): void;
  /** The pointer moves over something with no button down. */
  hover(viewport: Viewport, hit: Hit | null, pointer: Pointer): void;
  /** Escape, or another tool is taken. */
  cancel(viewport: Viewport): void;
}
