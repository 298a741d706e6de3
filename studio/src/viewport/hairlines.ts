// Springs as lines of one pixel: what a software rasteriser can draw while the net moves.
import * as THREE from "three";

/** A set of hairlines, of which any number can be drawn. */
export class Hairlines {
  readonly lines: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial>;
  private capacity = 0;

  constructor() {
    const material = new THREE.LineBasicMaterial({ vertexColors: true, fog: true });
    this.lines = new THREE.LineSegments(new THREE.BufferGeometry(), material);
    this.lines.frustumCulled = false;
    this.lines.renderOrder = 1;
  }

  /** Draws a line from `ends` (6 floats each: start, end) and `colours` (3 bytes). */
  set(count: number, ends: Float32Array, colours: Uint8Array): void {
    if (count > this.capacity) this.reserve(count);
    const { geometry } = this.lines;
    const place = geometry.getAttribute("position") as THREE.BufferAttribute;
    (place.array as Float32Array).set(ends.subarray(0, 6 * count));
    place.needsUpdate = true;
    const colour = geometry.getAttribute("color") as THREE.BufferAttribute;
    const target = colour.array as Uint8Array;
    for (let line = 0; line < count; line++) {
      for (let part = 0; part < 3; part++) {
        target[6 * line + part] = colours[3 * line + part];
        target[6 * line + 3 + part] = colours[3 * line + part];
      }
    }
    colour.needsUpdate = true;
    geometry.setDrawRange(0, 2 * count);
  }

  dispose(): void {
    this.lines.geometry.dispose();
    this.lines.material.dispose();
  }

  private reserve(count: number): void {
    this.capacity = Math.ceil(count * 1.5);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute(
      "position",
      new THREE.BufferAttribute(new Float32Array(6 * this.capacity), 3),
    );
    geometry.setAttribute(
      "color",
      new THREE.BufferAttribute(new Uint8Array(6 * this.capacity), 3, true),
    );
    this.lines.geometry.dispose();
    this.lines.geometry = geometry;
  }
}
