// Cells as a translucent skin: each a fan of triangles round its middle.
import * as THREE from "three";
import type { Motion } from "../document/motion";
import { groupOf, type Net } from "../document/net";
import type { Colour } from "../document/palettes";

/** The skin over some cells. */
export class Skin {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;

  constructor(opacity: number) {
    const material = new THREE.MeshBasicMaterial({
      vertexColors: true,
      transparent: true,
      opacity,
      side: THREE.DoubleSide,
      depthWrite: false,
      fog: true,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
    this.mesh = new THREE.Mesh(new THREE.BufferGeometry(), material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 0;
  }

  /** Draws cells, each in a colour. */
  set(
    net: Net,
    { positions }: Motion,
    cells: Iterable<number>,
    colourOf: (cell: number) => Colour,
  ): void {
    const places: number[] = [];
    const colours: number[] = [];
    for (const cell of cells) {
      const around = groupOf(net.boundaries, cell);
      const middle = [0, 0, 0];
      for (const node of around)
        for (let axis = 0; axis < 3; axis++)
          middle[axis] += positions[3 * node + axis] / around.length;
      const [red, green, blue] = colourOf(cell);
      for (let corner = 0; corner < around.length; corner++) {
        const a = 3 * around[corner];
        const b = 3 * around[(corner + 1) % around.length];
        places.push(...middle, positions[a], positions[a + 1], positions[a + 2]);
        places.push(positions[b], positions[b + 1], positions[b + 2]);
        for (let vertex = 0; vertex < 3; vertex++) colours.push(red, green, blue);
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(places, 3));
    geometry.setAttribute("color", new THREE.Uint8BufferAttribute(colours, 3, true));
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
    this.mesh.visible = places.length > 0;
  }

  clear(): void {
    this.mesh.visible = false;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
