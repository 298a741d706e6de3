// Arrows of reactions: they pull at the anchors as the supports do, their lengths to one scale.
import * as THREE from "three";
import type { Motion } from "../document/motion";
import type { Net } from "../document/net";
import { type Cut, keeps } from "../document/section";

/** The largest reaction [N]. */
export function largestReaction({ reactions }: Motion): number {
  let largest = 0;
  for (let at = 0; at < reactions.length; at += 3)
    largest = Math.max(largest, Math.hypot(reactions[at], reactions[at + 1], reactions[at + 2]));
  return largest;
}

/** Shafts and two barbs each, spread before the eye: six coordinates a line; the largest is `longest` [m]. */
export function arrowsOf(
  net: Net,
  motion: Motion,
  longest: number,
  eye: THREE.Vector3,
  cut: Cut | null,
): Float32Array {
  const { positions, reactions } = motion;
  const largest = largestReaction(motion);
  const lines: number[] = [];
  const side = new THREE.Vector3();
  for (let anchor = 0; anchor < net.anchors.length; anchor++) {
    if (!keeps(cut, positions, net.anchors[anchor])) continue;
    const from = new THREE.Vector3().fromArray(positions, 3 * net.anchors[anchor]);
    const force = new THREE.Vector3().fromArray(reactions, 3 * anchor);
    const direction = force.clone().normalize();
    const length = largest > 0 ? (force.length() / largest) * longest : 0;
    const tip = from.clone().addScaledVector(direction, length);
    const head = Math.min(0.3 * length, 0.16 * longest);
    side.crossVectors(direction, eye.clone().sub(tip)).normalize();
    const back = tip.clone().addScaledVector(direction, -head);
    const barbs = [1, -1].map((sign) => back.clone().addScaledVector(side, 0.5 * sign * head));
    lines.push(...from, ...tip, ...tip, ...barbs[0], ...tip, ...barbs[1]);
  }
  return new Float32Array(lines);
}
