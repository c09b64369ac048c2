// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { Color, Vector3 } from "three";
import type { PackedMesh } from "../payload.ts";
import { CAMERA, type Entity, type RunState } from "../state/run_state.ts";
import type { Trace } from "../trace/trace.ts";
import { colourOf } from "../ui/palette.ts";
import { onTheme, themeColour } from "../ui/theme.ts";
import { Batch } from "./batch.ts";
import { Bodies } from "./bodies.ts";
import { CameraPart } from "./camera_part.ts";
import { Describer } from "./describer.ts";
import { axisLength, boundsOf, fullBounds, objectBounds, upAxis } from "./extent.ts";
import { CameraImages, readImages } from "./images.ts";
import type { Layers, ShownPose, UncertaintyLook } from "./layers.ts";
import { readIntrinsics } from "./lens.ts";
import { ObjectPart } from "./object_part.ts";
import { ObjectPaths } from "./object_tracks.ts";
import { type Pick, Picks } from "./picks.ts";
import { type SceneProbe, sceneProbe } from "./probe.ts";
import { axesShape, grid, gridStep } from "./shapes.ts";
import { UncertaintyPart } from "./uncertainty_part.ts";
import { type View, Viewport } from "./viewport.ts";

const LARGE_IMAGE_OFFSET = 0.05;

/** Camera, objects and hypotheses of a run at one frame. */
export class SlamScene {
  readonly viewport: Viewport;
  readonly layers: Layers = {
    truth: true, hypotheses: true, detections: false, labels: true, paths: true, images: true,
    ellipsoids: true, cones: true, samples: false, lengths: true,
  };
  readonly gridStep: number;
  readonly objectPaths: ObjectPaths;
  readonly camera: CameraPart;
  readonly objects: ObjectPart;
  readonly uncertainty: UncertaintyPart;
  readonly bodies: Bodies;
  readonly images: CameraImages;
  readonly hasLens: boolean;
  readonly probe: SceneProbe;
  private readonly parts: readonly { begin: () => void; end: () => void }[];
  private readonly picks = new Picks();
  private readonly describer: Describer;
  private readonly colours: Color[];
  private readonly colourTexts: string[];
  private readonly ink = new Color();
  private readonly grey = new Color(0x808890);
  private readonly origin = new Batch(axesShape(0.02), 1, { tintShare: 0.25, order: 1 });
  private readonly trace: Trace;
  private readonly unit: number;
  private readonly followed = new Vector3();
  private readonly step = new Vector3();
  private isFollowing = false;
  private inkText = "";
  private frame = 0;

  constructor(private readonly state: RunState, meshes: Record<string, PackedMesh>, images: unknown = undefined) {
    const { trace } = state;
    this.trace = trace;
    const up = upAxis(trace);
    this.viewport = new Viewport("Camera path, objects and their uncertainty", up);
    const { viewport } = this;
    const bounds = boundsOf(trace);
    viewport.setBounds(bounds);
    const { size } = viewport;
    this.unit = axisLength(trace, size);
    this.colourTexts = trace.objects.map((_, i) => colourOf(i));
    this.colours = this.colourTexts.map((colour) => new Color(colour));
    viewport.lens = readIntrinsics(trace.head.intrinsics);
    this.hasLens = viewport.lens !== undefined;
    this.images = new CameraImages(readImages(images), () => this.redraw());
    const depth = Math.max(1.2 * this.unit, 0.035 * size);
    this.camera = new CameraPart(trace, viewport.lens, this.images, depth, 0.02 * size);
    this.bodies = new Bodies(trace, meshes, this.colours);
    this.uncertainty = new UncertaintyPart(trace, this.layers, this.camera, this.bodies, this.unit);
    this.objects = new ObjectPart(state, trace, this.layers, viewport.labels, this.picks, this.camera, this.bodies, this.uncertainty, this.colours, this.unit);
    this.parts = [this.objects, this.bodies, this.uncertainty];
    this.objectPaths = new ObjectPaths(trace, this.colours, 0.01 * size);
    const ground = Math.min(0, ...bounds.map((point) => point.dot(up)));
    this.gridStep = gridStep(size);
    viewport.scene.add(this.camera.node, this.camera.paths, this.bodies.node, this.objects.node, this.uncertainty.node,
      this.objectPaths.node, this.objectPaths.truth, this.origin.mesh, grid(viewport.centre, up, size, ground));
    this.describer = new Describer(trace, this.objects, this.uncertainty);
    this.fit(depth);
    this.probe = sceneProbe(this, state);
    this.listen();
  }

  private fit(depth: number): void {
    const { viewport, trace, unit } = this;
    const corners = this.camera.corners.map(([x, y]) => [depth * x, depth * y, depth]);
    const most = 0.15 * viewport.size;
    viewport.setNear(objectBounds(trace));
    viewport.setBounds(fullBounds(trace, { corners, reach: (index, frame) => Math.max(1.3 * unit, Math.min(most, this.uncertainty.reach(index, frame))) }));
    this.origin.begin();
    this.origin.addPose([0, 0, 0], [0, 0, 0, 1], 0.8 * unit, this.grey, 0.9);
    this.origin.end();
    viewport.look("fit");
  }

  private listen(): void {
    const { state, viewport } = this;
    onTheme(() => this.takeColours());
    this.takeColours();
    viewport.onLeaveEye = () => this.update(this.frame);
    viewport.onAxis = (view) => state.setView(view);
    state.on("visibility", () => this.redraw());
    state.on("selection", () => {
      this.isFollowing = false;
      this.redraw();
    });
    state.on("follow", () => {
      this.isFollowing = false;
      this.redraw();
    });
    viewport.listen({
      click: (x, y) => {
        const found = this.pick(x, y);
        if (found) state.select(found.entity);
      },
      doubleClick: (x, y) => {
        const found = this.pick(x, y);
        const position = found && this.positionOf(found.entity);
        if (position) viewport.centreOn(this.step.fromArray(position));
      },
      hover: (x, y) => {
        const found = this.pick(x, y);
        return found ? this.describer.lines(found, this.frame) : [];
      },
    });
  }

  private takeColours(): void {
    this.inkText = themeColour("--ink");
    this.ink.set(this.inkText);
    this.camera.setColour(this.ink);
    this.uncertainty.setInk(this.ink);
    this.objects.cameraStyles.name.colour = this.objects.cameraStyles.strong.colour = this.inkText;
    this.redraw();
  }

  look(view: View): void {
    this.viewport.look(view, this.camera.eye);
    this.redraw();
  }

  /** Shows or hides a layer, and draws. */
  setLayer(layer: keyof Layers, on: boolean): void {
    this.layers[layer] = on;
    this.redraw();
  }

  setLook(look: UncertaintyLook): void {
    Object.assign(this.uncertainty.look, look);
    this.redraw();
  }

  redraw(): void {
    this.update(this.frame);
    this.viewport.invalidate();
  }

  /** The position of an entity at the frame, if it has one. */
  positionOf(entity: Entity): Float64Array | undefined {
    if (entity === CAMERA) return this.camera.here ? this.camera.position : undefined;
    return this.objects.isHere[entity] ? this.objects.positions[entity] : undefined;
  }

  /** The pose at which an object, or the camera, is drawn. */
  shown(entity: Entity): ShownPose | undefined {
    const position = this.positionOf(entity);
    if (!position) return undefined;
    const quaternion = entity === CAMERA ? this.camera.quaternion : this.objects.quaternions[entity];
    return { position: [...position], quaternion: [...quaternion] };
  }

  private pick(x: number, y: number): Pick | undefined {
    const { viewport } = this;
    const { clientWidth: width, clientHeight: height } = viewport.node;
    const labelled = viewport.labels.at(x, y);
    if (labelled !== undefined) return { entity: labelled, kind: "estimate", slot: -1 };
    const found = this.picks.at(x, y, viewport.camera, width, height);
    if (found) return found;
    const body = this.bodies.at((2 * x) / width - 1, 1 - (2 * y) / height, viewport.camera);
    return body === undefined ? undefined : { entity: body, kind: "estimate", slot: -1 };
  }

  /** Number of hypotheses drawn as ghosts. */
  get ghostCount(): number {
    return this.objects.ghosts.mesh.count;
  }

  /** Number of ellipsoids drawn. */
  get ellipsoidCount(): number {
    return this.uncertainty.counts.shells;
  }

  get faint(): ObjectPart["faint"] {
    return this.objects.faint;
  }

  /** The objects that are drawn as meshes. */
  get bodyIds(): string[] {
    return this.trace.objects.filter((_, i) => this.bodies.isShown(i)).map(({ id }) => id);
  }

  update(frame: number): void {
    this.frame = frame;
    const { viewport, layers, state, objects } = this;
    const { fromEye } = viewport;
    const cameraHidden = state.hidden.has(CAMERA);
    viewport.labels.clear();
    this.picks.clear();
    this.camera.read(frame);
    objects.read(frame);
    this.uncertainty.fromEye = fromEye;
    this.follow();
    for (const part of this.parts) part.begin();
    this.camera.update(frame, fromEye, cameraHidden, layers.truth, layers.images);
    if (!fromEye && !cameraHidden) this.addCamera(frame);
    const count = this.trace.objects.length;
    for (let i = 0; i < count; ++i) objects.add(i, frame, fromEye);
    this.addLabels(frame, count, !fromEye && !cameraHidden);
    for (let i = 0; i < count; ++i) objects.addGhosts(i, frame);
    for (const part of this.parts) part.end();
    this.objectPaths.update(frame, state.hidden);
    this.objectPaths.node.visible = layers.paths;
    this.objectPaths.truth.visible = layers.truth && !fromEye;
    this.origin.mesh.visible = !fromEye;
    this.mark();
    this.note(frame);
  }

  private addLabels(frame: number, count: number, withCamera: boolean): void {
    const { selected } = this.state;
    if (selected >= 0) this.objects.addName(selected, frame);
    for (let i = 0; i < count; ++i) if (i !== selected) this.objects.addName(i, frame);
    if (!withCamera || !this.layers.labels || !this.camera.here) return;
    const [x, y, z] = this.camera.position;
    const { strong, name } = this.objects.cameraStyles;
    this.viewport.labels.add(x, y, z, this.trace.cameraName, selected === CAMERA ? strong : name);
  }

  private addCamera(frame: number): void {
    const { camera } = this.trace;
    if (!camera) return;
    const { position, quaternion, here } = this.camera;
    if (here) {
      this.picks.add(CAMERA, "estimate", -1, position, quaternion, this.unit);
      this.uncertainty.add(CAMERA, frame, position, quaternion, this.grey, this.state.selected === CAMERA);
    }
    this.objects.addTruth(camera, CAMERA, frame);
    this.objects.addCameraGhosts(frame, this.ink);
  }

  /** The view moves as the selected object does. */
  private follow(): void {
    const position = this.state.follow ? this.positionOf(this.state.selected) : undefined;
    if (!position || this.viewport.fromEye) return;
    if (this.isFollowing) this.viewport.shift(this.step.fromArray(position).sub(this.followed));
    else this.viewport.centreOn(this.step.fromArray(position));
    this.followed.fromArray(position);
    this.isFollowing = true;
  }

  private mark(): void {
    const { overlay } = this.viewport;
    const { selected } = this.state;
    const isEye = selected === CAMERA && (this.viewport.fromEye || this.state.hidden.has(CAMERA));
    const position = isEye ? undefined : this.positionOf(selected);
    overlay.markedSize = position ? 1.4 * this.unit : 0;
    if (position) overlay.marked.fromArray(position);
    overlay.markedColour = selected === CAMERA ? this.inkText : this.colourTexts[selected];
  }

  private note(frame: number): void {
    const { notes } = this.viewport.overlay;
    notes.length = 0;
    const uncertain = this.uncertainty.describe();
    if (uncertain) notes.push(uncertain);
    const { caption } = this.viewport;
    if (caption) notes.push(caption);
    if (this.viewport.fromEye && !this.hasLens) notes.push("intrinsics not known: an angle of view of 45 deg is assumed");
    if (this.camera.image < 0) return;
    const offset = this.images.offset(this.camera.image, this.trace.head.stamps_s[frame]);
    if (Math.abs(offset) > LARGE_IMAGE_OFFSET) notes.push(`image of ${Math.abs(offset).toFixed(2)} s ${offset < 0 ? "before" : "after"}`);
  }
}
