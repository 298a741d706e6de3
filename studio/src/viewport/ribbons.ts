// Springs as flat ribbons of a width in pixels that face the eye: one instance a spring.
import * as THREE from "three";

const VERTEX = /* glsl */ `
  attribute vec3 start;
  attribute vec3 end;
  attribute vec3 colour;
  attribute float width;
  uniform vec2 resolution;
  uniform float scale;
  uniform float lift;
  varying vec3 tint;
  varying float across;
  varying float half_width;
  varying float depth;

  void main() {
    vec4 a = modelViewMatrix * vec4(start, 1.0);
    vec4 b = modelViewMatrix * vec4(end, 1.0);
    // Ends behind the eye are brought to the near plane, or they would be projected upside down.
    float near = -0.01;
    if (a.z > near) a = mix(a, b, (a.z - near) / max(a.z - b.z, 1e-9));
    if (b.z > near) b = mix(b, a, (b.z - near) / max(b.z - a.z, 1e-9));
    vec4 from = projectionMatrix * a;
    vec4 to = projectionMatrix * b;
    vec2 along = (to.xy / to.w - from.xy / from.w) * resolution;
    float size = length(along);
    along = size > 1e-6 ? along / size : vec2(1.0, 0.0);
    half_width = 0.5 * width * scale + 0.75;
    vec4 place = position.x < 0.5 ? from : to;
    float side = position.y;
    vec2 offset = vec2(-along.y, along.x) * side * half_width + along * (position.x - 0.5) * 0.6;
    place.xy += 2.0 * offset / resolution * place.w;
    place.z -= lift * place.w;
    gl_Position = place;
    across = side * half_width;
    tint = colour;
    depth = -(position.x < 0.5 ? a.z : b.z);
  }
`;

const FRAGMENT = /* glsl */ `
  uniform vec3 ground;
  uniform vec2 haze;
  uniform float strength;
  uniform float opacity;
  varying vec3 tint;
  varying float across;
  varying float half_width;
  varying float depth;

  void main() {
    float edge = clamp(half_width - abs(across), 0.0, 1.0);
    float far = clamp((depth - haze.x) / max(haze.y - haze.x, 1e-6), 0.0, 1.0);
    vec3 seen = mix(tint, ground, far * strength);
    gl_FragColor = vec4(seen, edge * opacity);
    if (gl_FragColor.a < 0.02) discard;
  }
`;

/** A set of ribbons, of which any number can be drawn. */
export class Ribbons {
  readonly mesh: THREE.Mesh<THREE.InstancedBufferGeometry, THREE.ShaderMaterial>;
  private capacity = 0;

  constructor(options: { lift?: number; order?: number; haze?: number } = {}) {
    const material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: {
        resolution: { value: new THREE.Vector2(1, 1) },
        scale: { value: 1 },
        lift: { value: options.lift ?? 0 },
        ground: { value: new THREE.Color() },
        haze: { value: new THREE.Vector2(0, 1) },
        strength: { value: options.haze ?? 0.62 },
        opacity: { value: 1 },
      },
      transparent: true,
      side: THREE.DoubleSide,
    });
    this.mesh = new THREE.Mesh(new THREE.InstancedBufferGeometry(), material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = options.order ?? 1;
    this.reserve(64);
  }

  /** Draws a ribbon from `ends` (6 floats each: start, end), `colours` (3 bytes) and `widths` [px]. */
  set(count: number, ends: Float32Array, colours: Uint8Array, widths: Float32Array | number): void {
    if (count > this.capacity) this.reserve(count);
    const geometry = this.mesh.geometry;
    const places = (geometry.getAttribute("start") as THREE.InterleavedBufferAttribute).data;
    (places.array as Float32Array).set(ends.subarray(0, 6 * count));
    places.needsUpdate = true;
    const colour = geometry.getAttribute("colour") as THREE.InstancedBufferAttribute;
    (colour.array as Uint8Array).set(colours.subarray(0, 3 * count));
    colour.needsUpdate = true;
    const width = geometry.getAttribute("width") as THREE.InstancedBufferAttribute;
    if (typeof widths === "number") (width.array as Float32Array).fill(widths, 0, count);
    else (width.array as Float32Array).set(widths.subarray(0, count));
    width.needsUpdate = true;
    geometry.instanceCount = count;
    this.mesh.visible = count > 0;
  }

  /** Fits the ribbons to the canvas, the ground and the distance of the net. */
  fit(
    width: number,
    height: number,
    scale: number,
    ground: THREE.Color,
    haze: THREE.Vector2,
  ): void {
    const { uniforms } = this.mesh.material;
    uniforms.resolution.value.set(width, height);
    uniforms.scale.value = scale;
    uniforms.ground.value.copy(ground);
    uniforms.haze.value.copy(haze);
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }

  private reserve(count: number): void {
    this.capacity = Math.ceil(count * 1.5);
    const geometry = new THREE.InstancedBufferGeometry();
    const corners = new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]);
    geometry.setAttribute("position", new THREE.BufferAttribute(corners, 3));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    const places = new THREE.InstancedInterleavedBuffer(new Float32Array(6 * this.capacity), 6);
    geometry.setAttribute("start", new THREE.InterleavedBufferAttribute(places, 3, 0));
    geometry.setAttribute("end", new THREE.InterleavedBufferAttribute(places, 3, 3));
    const colours = new Uint8Array(3 * this.capacity);
    geometry.setAttribute("colour", new THREE.InstancedBufferAttribute(colours, 3, true));
    geometry.setAttribute(
      "width",
      new THREE.InstancedBufferAttribute(new Float32Array(this.capacity), 1),
    );
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
  }
}
