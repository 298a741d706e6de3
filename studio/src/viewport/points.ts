// Nodes as discs of a size in pixels.
import * as THREE from "three";
import type { Colour } from "../document/palettes";

const VERTEX = /* glsl */ `
  attribute vec3 tint;
  attribute float size;
  uniform float scale;
  varying vec3 shade;
  varying float radius;
  void main() {
    vec4 seen = modelViewMatrix * vec4(position, 1.0);
    gl_Position = projectionMatrix * seen;
    gl_Position.z -= 0.0004 * gl_Position.w;
    radius = 0.5 * size * scale;
    gl_PointSize = 2.0 * radius + 2.0;
    shade = tint;
  }
`;

const FRAGMENT = /* glsl */ `
  uniform vec3 rim;
  varying vec3 shade;
  varying float radius;
  void main() {
    float from = length(gl_PointCoord - 0.5) * (2.0 * radius + 2.0);
    float inside = clamp(radius + 0.5 - from, 0.0, 1.0);
    float core = clamp(radius - 1.4 - from, 0.0, 1.0);
    if (inside < 0.02) discard;
    gl_FragColor = vec4(mix(rim, shade, core), inside);
  }
`;

/** A disc: a place, a colour and a diameter [px]. */
export interface Disc {
  at: [number, number, number];
  colour: Colour;
  size: number;
}

/** A set of discs. */
export class Discs {
  readonly points: THREE.Points<THREE.BufferGeometry, THREE.ShaderMaterial>;

  constructor() {
    const material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { scale: { value: 1 }, rim: { value: new THREE.Color() } },
      transparent: true,
    });
    this.points = new THREE.Points(new THREE.BufferGeometry(), material);
    this.points.frustumCulled = false;
    this.points.renderOrder = 3;
  }

  set(discs: Disc[]): void {
    const geometry = new THREE.BufferGeometry();
    const places = discs.flatMap(({ at }) => at);
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(places, 3));
    const tints = discs.flatMap(({ colour }) => colour);
    geometry.setAttribute("tint", new THREE.Uint8BufferAttribute(tints, 3, true));
    const sizes = discs.map(({ size }) => size);
    geometry.setAttribute("size", new THREE.Float32BufferAttribute(sizes, 1));
    this.points.geometry.dispose();
    this.points.geometry = geometry;
    this.points.visible = discs.length > 0;
  }

  fit(scale: number, ground: THREE.Color): void {
    this.points.material.uniforms.scale.value = scale;
    this.points.material.uniforms.rim.value.copy(ground);
  }

  dispose(): void {
    this.points.geometry.dispose();
    this.points.material.dispose();
  }
}
