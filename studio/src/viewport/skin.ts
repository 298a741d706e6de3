// Cells as a translucent skin: each a fan of triangles round its middle.
import * as THREE from "three";
import type { Motion } from "../document/motion";
import type { Net } from "../document/net";
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
  set(net: Net, { positions }: Motion, cells: number[], colourOf: (cell: number) => Colour): void {
    const { starts, items } = net.boundaries;
    const triangles = cells.reduce((sum, cell) => sum + starts[cell + 1] - starts[cell], 0);
    const places = new Float32Array(9 * triangles);
    const colours = new Uint8Array(9 * triangles);
    let at = 0;
    for (const cell of cells) {
      const [first, end] = [starts[cell], starts[cell + 1]];
      let [x, y, z] = [0, 0, 0];
      for (let corner = first; corner < end; corner++) {
        const node = 3 * items[corner];
        x += positions[node] / (end - first);
        y += positions[node + 1] / (end - first);
        z += positions[node + 2] / (end - first);
      }
      const colour = colourOf(cell);
      for (let corner = first; corner < end; corner++) {
        const a = 3 * items[corner];
        const b = 3 * items[corner + 1 < end ? corner + 1 : first];
        for (let vertex = 0; vertex < 3; vertex++) colours.set(colour, at + 3 * vertex);
        places[at++] = x;
        places[at++] = y;
        places[at++] = z;
        for (const node of [a, b])
          for (let axis = 0; axis < 3; axis++) places[at++] = positions[node + axis];
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3, true));
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
