// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import {
  AmbientLight, Box3, DirectionalLight, type Matrix4, PerspectiveCamera, Scene, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { element } from "../ui/dom.ts";
import { onTheme } from "../ui/theme.ts";
import { LabelLayer } from "./labels.ts";

export type View = "fit" | "near" | "top" | "front" | "side" | "eye";

const KEY_TURN = Math.PI / 36;

/** A scene on the page: renderer, camera, orbit controls and labels. It draws when something has changed. */
export class Viewport {
  readonly node: HTMLElement;
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(45, 1, 0.01, 100);
  readonly labels: LabelLayer;
  readonly controls: OrbitControls;
  /** Called after the camera moved, before drawing. */
  beforeDraw: () => void = () => {};
  onLeaveEye: () => void = () => {};
  /** Time that the last drawing took on the processor [ms]. */
  drawTime = 0;
  /** Time of the first drawing [ms since the page was requested]. */
  firstDraw = 0;
  private readonly renderer: WebGLRenderer;
  private readonly box = new Box3();
  private points: Vector3[] = [];
  private nearPoints: Vector3[] = [];
  private view: View = "fit";
  private moved = false;
  private pending = false;
  private eye: Matrix4 | undefined;

  /** @throws Error if the browser has no WebGL */
  constructor(name: string, private up: Vector3) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${name}. Drag to turn, wheel or pinch to zoom; keys A, D, W, S turn, plus and minus zoom.`);
    this.labels = new LabelLayer();
    this.node = element("div", { class: "viewport" }, canvas, this.labels.canvas);
    this.camera.up.copy(up);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.invalidate());
    this.controls.addEventListener("start", () => {
      this.moved = true;
      this.leaveEye();
    });
    canvas.addEventListener("keydown", (event) => this.key(event));
    this.scene.add(new AmbientLight(0xffffff, 1.6));
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.copy(up).addScaledVector(new Vector3(1, 1, 1), 0.4);
    this.scene.add(sun);
    new ResizeObserver(() => this.resize()).observe(this.node);
    onTheme(() => this.invalidate());
  }

  setUp(up: Vector3): void {
    this.up = up;
  }

  /** The extent that the views show. */
  setBounds(points: Iterable<Vector3>): void {
    this.box.makeEmpty();
    this.points = [...points];
    for (const point of this.points) this.box.expandByPoint(point);
    if (this.box.isEmpty()) this.box.setFromCenterAndSize(new Vector3(), new Vector3(1, 1, 1));
    this.box.expandByScalar(0.05 * this.size + 1e-3);
    this.camera.near = this.size / 500;
    this.camera.far = this.size * 40;
  }

  /** The extent that the view "near" shows. */
  setNear(points: Iterable<Vector3>): void {
    this.nearPoints = [...points];
  }

  /** Whether the view is from the recording's camera. */
  get fromEye(): boolean {
    return this.eye !== undefined;
  }

  get size(): number {
    return this.box.getSize(new Vector3()).length();
  }

  get centre(): Vector3 {
    return this.box.getCenter(new Vector3());
  }

  /** Moves the view so that everything is visible; "eye" is the view from a camera pose (OpenCV's camera frame). */
  look(view: View, eye?: Matrix4): void {
    this.eye = view === "eye" ? eye : undefined;
    this.view = view;
    this.moved = false;
    if (!this.eye) {
      const across = Math.abs(this.up.x) < 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
      across.addScaledVector(this.up, -across.dot(this.up)).normalize();
      const forward = new Vector3().crossVectors(this.up, across);
      const from = new Vector3();
      if (view === "top") from.copy(this.up).addScaledVector(forward, -1e-3);
      else if (view === "front") from.copy(forward).negate();
      else if (view === "side") from.copy(across);
      else from.copy(across).multiplyScalar(0.55).addScaledVector(forward, -0.75).addScaledVector(this.up, 0.6);
      const near = view === "near" && this.nearPoints.length > 0;
      const points = near ? this.nearPoints : this.points;
      const centre = points.length > 0 ? new Box3().setFromPoints(points).getCenter(new Vector3()) : this.centre;
      const least = (near ? 0.12 : 0.02) * this.size;
      this.camera.up.copy(this.up);
      this.camera.position.copy(centre).addScaledVector(from.normalize(), this.distanceFor(points, centre, from, least));
      this.controls.target.copy(centre);
    }
    this.controls.update();
    this.invalidate();
  }

  /** The distance at which all points, with a margin around each, are visible, looking against a direction. */
  private distanceFor(points: Vector3[], centre: Vector3, from: Vector3, margin: number): number {
    const right = new Vector3().crossVectors(this.up, from).normalize();
    const above = new Vector3().crossVectors(from, right);
    const high = Math.tan((this.camera.fov * Math.PI) / 360);
    let distance = margin / high;
    for (const point of points) {
      const arm = point.clone().sub(centre);
      const across = (Math.abs(arm.dot(right)) + margin) / (high * this.camera.aspect);
      const along = (Math.abs(arm.dot(above)) + margin) / high;
      distance = Math.max(distance, arm.dot(from) + 1.05 * Math.max(across, along));
    }
    return distance;
  }

  /** Follows the camera of the recording, if the view is from there. */
  followEye(): void {
    if (!this.eye) return;
    const e = this.eye.elements;
    this.camera.position.set(e[12], e[13], e[14]);
    this.camera.up.set(-e[4], -e[5], -e[6]);
    this.camera.lookAt(e[12] + e[8], e[13] + e[9], e[14] + e[10]);
  }

  private leaveEye(): void {
    if (!this.eye) return;
    const e = this.eye.elements;
    this.eye = undefined;
    const distance = this.camera.position.distanceTo(this.centre);
    this.controls.target.set(e[8], e[9], e[10]).multiplyScalar(distance).add(this.camera.position);
    this.camera.up.copy(this.up);
    this.onLeaveEye();
  }

  invalidate(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      if (this.pending) this.draw();
    });
  }

  draw(): void {
    this.pending = false;
    if (this.node.clientWidth === 0) return;
    const start = performance.now();
    this.firstDraw ||= start;
    this.followEye();
    this.camera.updateMatrixWorld();
    this.beforeDraw();
    this.renderer.render(this.scene, this.camera);
    this.labels.draw(this.camera);
    this.drawTime = performance.now() - start;
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.node;
    if (width === 0 || height === 0) return;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.renderer.setSize(width, height, false);
    this.labels.resize(width, height);
    // The view is fitted again until the reader turns the scene.
    if (!this.moved && !this.eye) this.look(this.view);
    this.draw();
  }

  private key(event: KeyboardEvent): void {
    const turn: Record<string, [number, number]> = { a: [-1, 0], d: [1, 0], w: [0, -1], s: [0, 1] };
    const step = turn[event.key.toLowerCase()];
    if (event.ctrlKey || event.metaKey || event.altKey || !(step || ["+", "=", "-"].includes(event.key))) return;
    this.moved = true;
    this.leaveEye();
    const arm = this.camera.position.clone().sub(this.controls.target);
    if (step) {
      arm.applyAxisAngle(this.up, step[0] * KEY_TURN);
      const axis = new Vector3().crossVectors(this.up, arm).normalize();
      const tilt = arm.angleTo(this.up) + step[1] * KEY_TURN;
      if (tilt > 0.05 && tilt < Math.PI - 0.05) arm.applyAxisAngle(axis, step[1] * KEY_TURN);
    } else if (event.key === "+" || event.key === "=") arm.multiplyScalar(0.9);
    else arm.multiplyScalar(1 / 0.9);
    event.preventDefault();
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
  }
}
