// The eye: orbit, pan, zoom, fitting the net, and standard views. z points up.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

export type StandardView = "perspective" | "front" | "back" | "left" | "right" | "top" | "bottom";

const DIRECTIONS: Record<StandardView, [number, number, number]> = {
  perspective: [0.62, -1, 0.42],
  front: [0, -1, 0],
  back: [0, 1, 0],
  left: [-1, 0, 0],
  right: [1, 0, 0],
  top: [0, -1e-3, 1],
  bottom: [0, -1e-3, -1],
};

const GLIDE = 260; // ms
const DOT = 12; // px
const MARGIN = 1.16;

/** The camera and its controls. */
export class Eye {
  readonly camera = new THREE.PerspectiveCamera(32, 1, 0.01, 1000);
  readonly controls: OrbitControls;
  private sphere = new THREE.Sphere(new THREE.Vector3(), 1);
  private free = 1;
  private glide: {
    from: [THREE.Vector3, THREE.Vector3];
    to: [THREE.Vector3, THREE.Vector3];
    start: number;
  } | null = null;

  constructor(canvas: HTMLCanvasElement, changed: () => void) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    // The right button opens a menu, as everywhere; the middle one pans.
    this.controls.mouseButtons = { LEFT: THREE.MOUSE.ROTATE, MIDDLE: THREE.MOUSE.PAN, RIGHT: null };
    // The controls would keep the menu from opening.
    const { _onContextMenu } = this.controls as unknown as { _onContextMenu: EventListener };
    canvas.removeEventListener("contextmenu", _onContextMenu);
    this.controls.addEventListener("change", changed);
    this.controls.addEventListener("start", () => {
      this.glide = null;
    });
  }

  /** Notes how large the net is, so that it fits and is seen through no haze. */
  measure(positions: Float32Array): void {
    const box = new THREE.Box3();
    const point = new THREE.Vector3();
    for (let at = 0; at < positions.length; at += 3) {
      box.expandByPoint(point.set(positions[at], positions[at + 1], positions[at + 2]));
    }
    if (box.isEmpty()) return;
    box.getCenter(this.sphere.center);
    let square = 0;
    for (let at = 0; at < positions.length; at += 3) {
      square = Math.max(
        square,
        this.sphere.center.distanceToSquared(
          point.set(positions[at], positions[at + 1], positions[at + 2]),
        ),
      );
    }
    this.sphere.radius = Math.max(Math.sqrt(square), 1e-3);
    this.camera.near = this.sphere.radius / 200;
    this.camera.far = this.sphere.radius * 60;
    this.controls.maxDistance = this.sphere.radius * 40;
    this.controls.minDistance = this.sphere.radius / 100;
  }

  /** Size of the net [m]. */
  get radius(): number {
    return this.sphere.radius;
  }

  /** Depths between which the net lies [m]. */
  haze(): THREE.Vector2 {
    const distance = this.camera.position.distanceTo(this.sphere.center);
    return new THREE.Vector2(
      distance - 0.55 * this.sphere.radius,
      distance + 1.25 * this.sphere.radius,
    );
  }

  /** Looks at the whole net, from a side or from where it is. */
  fit(view: StandardView | null, gliding: boolean): void {
    const target = this.sphere.center.clone();
    const direction = view
      ? new THREE.Vector3(...DIRECTIONS[view])
      : this.camera.position.clone().sub(this.controls.target);
    const half = THREE.MathUtils.degToRad(this.camera.fov / 2);
    const narrow = Math.min(this.free, this.camera.aspect);
    const distance = (MARGIN * this.sphere.radius) / Math.sin(Math.atan(Math.tan(half) * narrow));
    const position = target.clone().addScaledVector(direction.normalize(), distance);
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (gliding && !still) {
      const from: [THREE.Vector3, THREE.Vector3] = [
        this.camera.position.clone(),
        this.controls.target.clone(),
      ];
      this.glide = { from, to: [position, target], start: performance.now() };
    } else {
      this.glide = null;
      this.camera.position.copy(position);
      this.controls.target.copy(target);
    }
  }

  /** Whether some of these places lie in the picture, farther apart than a dot. */
  sees(positions: Float32Array, width: number, height: number): boolean {
    const box = new THREE.Box2();
    const point = new THREE.Vector3();
    for (let at = 0; at < positions.length; at += 3) {
      point.set(positions[at], positions[at + 1], positions[at + 2]).project(this.camera);
      if (Math.abs(point.x) < 1 && Math.abs(point.y) < 1 && Math.abs(point.z) < 1)
        box.expandByPoint(new THREE.Vector2((point.x * width) / 2, (point.y * height) / 2));
    }
    return !box.isEmpty() && box.getSize(new THREE.Vector2()).length() > DOT;
  }

  /** Takes the size of the picture [px]; of its height only so much is free of what lies over it. */
  resize(width: number, height: number, free = height): void {
    this.free = free / height;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  /** Moves on; returns whether there is more to come. */
  update(): boolean {
    if (this.glide) {
      const share = Math.min(1, (performance.now() - this.glide.start) / GLIDE);
      const eased = share * share * (3 - 2 * share);
      const { from, to } = this.glide;
      this.controls.target.lerpVectors(from[1], to[1], eased);
      const radius = THREE.MathUtils.lerp(
        from[0].distanceTo(from[1]),
        to[0].distanceTo(to[1]),
        eased,
      );
      const start = from[0].clone().sub(from[1]).normalize();
      const end = to[0].clone().sub(to[1]).normalize();
      const direction = start.lerp(end, eased).normalize();
      this.camera.position.copy(this.controls.target).addScaledVector(direction, radius);
      if (share === 1) this.glide = null;
    }
    this.controls.update();
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    return this.glide !== null;
  }

  dispose(): void {
    this.controls.dispose();
  }
}
