// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import {
  AmbientLight, Box3, DirectionalLight, type Matrix4, OrthographicCamera, PerspectiveCamera, Scene, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { element } from "../ui/dom.ts";
import { onTheme } from "../ui/theme.ts";
import { LabelLayer } from "./labels.ts";
import { type Intrinsics, windowOf } from "./lens.ts";
import { Overlay } from "./overlay.ts";
import { Pointer, type PointerTarget } from "./pointer.ts";
import { axisName, directionOf, fitOf, isFlat, type View } from "./views.ts";

export type { View } from "./views.ts";

const KEY_TURN = Math.PI / 36;
const FIELD = 45;

/** A scene on the page: renderer, cameras, orbit controls, labels and what the picture says. It draws when something has changed. */
export class Viewport {
  readonly node: HTMLElement;
  readonly scene = new Scene();
  readonly labels: LabelLayer;
  readonly overlay: Overlay;
  readonly controls: OrbitControls;
  camera: PerspectiveCamera | OrthographicCamera;
  /** Of the recording's camera, if they are known. */
  lens: Intrinsics | undefined;
  /** Called after the camera moved, before drawing. */
  beforeDraw: () => void = () => {};
  onLeaveEye: () => void = () => {};
  /** Called with the view whose axis the reader pressed. */
  onAxis: (view: View) => void = (view) => this.look(view);
  /** Time that the last drawing took on the processor [ms]. */
  drawTime = 0;
  /** Time of the first drawing [ms since the page was requested]. */
  firstDraw = 0;
  private readonly perspective = new PerspectiveCamera(FIELD, 1, 0.01, 100);
  private readonly flat = new OrthographicCamera();
  private readonly renderer: WebGLRenderer;
  private readonly box = new Box3();
  private points: Vector3[] = [];
  private nearPoints: Vector3[] = [];
  private view: View = "fit";
  private moved = false;
  private pending = false;
  private eye: Matrix4 | undefined;
  private readonly arm = new Vector3();

  /** @throws Error if the browser has no WebGL */
  constructor(name: string, private up: Vector3) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${name}. Drag to turn, pinch or Ctrl and wheel to zoom; keys A, D, W, S turn, plus and minus zoom.`);
    this.labels = new LabelLayer();
    this.node = element("div", { class: "viewport" }, canvas, this.labels.canvas);
    this.camera = this.perspective;
    this.camera.up.copy(up);
    this.controls = new OrbitControls(this.camera, canvas);
    this.overlay = new Overlay(() => this.camera, () => this.controls.target);
    this.labels.painter = this.overlay;
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

  /** What a click, a double click and the resting pointer do. */
  listen(target: PointerTarget): Pointer {
    const onGizmo = (x: number, y: number) => this.overlay.viewAt(x / this.labels.factor, y / this.labels.factor);
    const whole: PointerTarget = {
      click: (x, y) => {
        const view = onGizmo(x, y);
        if (view) this.onAxis(view);
        else target.click(x, y);
      },
      doubleClick: (x, y) => {
        if (!onGizmo(x, y)) target.doubleClick(x, y);
      },
      hover: (x, y) => {
        const view = onGizmo(x, y);
        return view ? [`look along the ${view.replace("-", "")} axis`] : target.hover(x, y);
      },
    };
    return new Pointer(this.node, this.renderer.domElement, whole, (on) => (this.controls.enableZoom = on));
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
    this.box.expandByScalar(0.02 * this.size + 1e-3);
    this.perspective.near = this.size / 500;
    this.perspective.far = this.size * 40;
  }

  /** The extent that the view "near" shows. */
  setNear(points: Iterable<Vector3>): void {
    this.nearPoints = [...points];
  }

  /** Whether the view is from the recording's camera. */
  get fromEye(): boolean {
    return this.eye !== undefined;
  }

  get isFlat(): boolean {
    return this.camera === this.flat;
  }

  get size(): number {
    return this.box.getSize(new Vector3()).length();
  }

  get centre(): Vector3 {
    return this.box.getCenter(new Vector3());
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** Moves the view so that everything is visible; "eye" is the view from a camera pose (OpenCV's camera frame). */
  look(view: View, eye?: Matrix4): void {
    this.eye = view === "eye" ? eye : undefined;
    this.view = view;
    this.moved = false;
    this.use(isFlat(view) ? this.flat : this.perspective);
    if (!this.eye) this.stand(view);
    this.applyLens();
    this.controls.update();
    this.invalidate();
  }

  private use(camera: PerspectiveCamera | OrthographicCamera): void {
    this.camera = camera;
    this.controls.object = camera;
  }

  private stand(view: View): void {
    const from = directionOf(view, this.up);
    const near = view === "near" && this.nearPoints.length > 0;
    const points = near ? this.nearPoints : this.points;
    const centre = points.length > 0 ? new Box3().setFromPoints(points).getCenter(new Vector3()) : this.centre;
    const fit = fitOf(points, centre, {
      from, up: this.up, margin: (near ? 0.06 : 0.02) * this.size, aspect: this.perspective.aspect,
      tangent: this.isFlat ? 0 : Math.tan((FIELD * Math.PI) / 360),
    });
    this.flat.zoom = 1;
    this.flat.top = fit.half;
    const distance = this.isFlat ? 2 * this.size : fit.distance;
    this.flat.near = 0;
    this.flat.far = 6 * this.size;
    this.camera.up.copy(this.up);
    this.camera.position.copy(fit.centre).addScaledVector(from, distance);
    this.controls.target.copy(fit.centre);
  }

  /** The projections for the size of the view; the recording's own where the view is from its camera. */
  private applyLens(): void {
    const { clientWidth: width, clientHeight: height } = this.node;
    const { perspective, flat } = this;
    if (width > 0 && height > 0) perspective.aspect = width / height;
    flat.bottom = -flat.top;
    flat.right = flat.top * perspective.aspect;
    flat.left = -flat.right;
    flat.updateProjectionMatrix();
    perspective.updateProjectionMatrix();
    if (!this.eye || !this.lens || width === 0 || height === 0) return;
    const { left, right, top, bottom } = windowOf(this.lens, width, height, perspective.near);
    perspective.projectionMatrix.makePerspective(left, right, top, bottom, perspective.near, perspective.far);
    perspective.projectionMatrixInverse.copy(perspective.projectionMatrix).invert();
  }

  /** What the view shows, in words; "" where its buttons say it. */
  get caption(): string {
    if (!this.isFlat) return "";
    this.camera.updateMatrixWorld();
    const column = (k: number, sign: number) => axisName(new Vector3().setFromMatrixColumn(this.camera.matrixWorld, k).multiplyScalar(sign));
    const [right, above, along] = [column(0, 1), column(1, 1), column(2, -1)];
    return right && above && along ? `along ${along}: ${right} to the right, ${above} up, no perspective` : "no perspective";
  }

  /** Moves the view by a vector, with what it looks at. */
  shift(by: Vector3): void {
    this.moved = true;
    this.camera.position.add(by);
    this.controls.target.add(by);
  }

  /** Turns the view's centre to a point, without turning the view. */
  centreOn(point: Vector3): void {
    if (this.eye) return;
    this.shift(this.arm.subVectors(point, this.controls.target));
    this.controls.update();
    this.invalidate();
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
    this.applyLens();
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
    this.applyLens();
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
    event.preventDefault();
    const arm = this.camera.position.clone().sub(this.controls.target);
    const nearer = event.key === "-" ? 1 / 0.9 : 0.9;
    if (step) {
      arm.applyAxisAngle(this.up, step[0] * KEY_TURN);
      const axis = new Vector3().crossVectors(this.up, arm).normalize();
      const tilt = arm.angleTo(this.up) + step[1] * KEY_TURN;
      if (tilt > 0.05 && tilt < Math.PI - 0.05) arm.applyAxisAngle(axis, step[1] * KEY_TURN);
    } else if (this.isFlat) {
      this.flat.zoom /= nearer;
      this.flat.updateProjectionMatrix();
    } else arm.multiplyScalar(nearer);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.invalidate();
  }
}
