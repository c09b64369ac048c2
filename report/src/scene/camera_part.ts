// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The recording's camera in the scene: pyramid, image, path and ground truth.
import { DoubleSide, Group, Matrix4, Mesh, MeshBasicMaterial, SRGBColorSpace, Texture, Vector3 } from "three";
import type { Color } from "three";
import type { Trace } from "../trace/trace.ts";
import { TRUTH_COLOUR } from "../ui/palette.ts";
import type { CameraImages } from "./images.ts";
import { cornersOf, type Intrinsics, SYMBOLIC } from "./lens.ts";
import { dashedPath, Path } from "./path.ts";
import { frustum, imageShape } from "./shapes.ts";

const ONE = new Vector3(1, 1, 1);

export class CameraPart {
  readonly node = new Group();
  readonly paths = new Group();
  readonly eye = new Matrix4();
  readonly position = new Float64Array(3);
  readonly quaternion = new Float64Array([0, 0, 0, 1]);
  /** Whether there is a pose at the frame. */
  here = false;
  /** The image that is shown, -1 for none. */
  image = -1;
  readonly corners: readonly [number, number][];
  private readonly pyramid: ReturnType<typeof frustum>;
  private readonly plane: Mesh<ReturnType<typeof imageShape>, MeshBasicMaterial>;
  private readonly texture = new Texture();
  private readonly path: Path | undefined;
  private readonly truthPath: ReturnType<typeof dashedPath> | undefined;

  constructor(private readonly trace: Trace, private readonly lens: Intrinsics | undefined, private readonly images: CameraImages, readonly depth: number, dash: number) {
    this.corners = lens ? cornersOf(lens) : SYMBOLIC;
    this.pyramid = frustum(depth, this.corners);
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.generateMipmaps = false;
    const material = new MeshBasicMaterial({ map: this.texture, side: DoubleSide, transparent: true });
    this.plane = new Mesh(imageShape(depth, this.corners), material);
    this.plane.visible = false;
    this.plane.frustumCulled = false;
    this.node.add(this.pyramid, this.plane);
    if (!trace.camera) return;
    this.path = new Path(trace.camera.pose, trace.frames);
    this.paths.add(this.path.node);
    if (!trace.camera.truth) return;
    this.truthPath = dashedPath(trace.camera.truth, trace.frames, TRUTH_COLOUR, dash);
    this.paths.add(this.truthPath);
  }

  setColour(ink: Color): void {
    this.path?.setColour(ink);
    this.pyramid.material.color.copy(ink);
  }

  read(frame: number): void {
    const { camera } = this.trace;
    this.here = camera !== undefined && camera.pose.has(frame);
    if (!camera || !this.here) return;
    camera.pose.position(frame, this.position);
    camera.pose.quaternion(frame, this.quaternion);
    this.node.position.fromArray(this.position);
    this.node.quaternion.fromArray(this.quaternion);
    this.eye.compose(this.node.position, this.node.quaternion, ONE);
  }

  update(frame: number, fromEye: boolean, isHidden: boolean, withTruth: boolean, withImage: boolean): void {
    this.node.visible = this.here && (fromEye || !isHidden);
    this.pyramid.visible = !fromEye;
    this.path?.update(frame);
    this.paths.visible = !fromEye && !isHidden;
    if (this.truthPath) this.truthPath.visible = withTruth;
    this.showImage(withImage && this.images.any && (!fromEye || this.lens !== undefined) ? this.trace.head.stamps_s[frame] : NaN, fromEye);
  }

  /** Seen from the camera, the image lies behind everything. */
  private showImage(stamp: number, fromEye: boolean): void {
    this.image = Number.isNaN(stamp) ? -1 : this.images.nearest(stamp);
    const image = this.image < 0 ? undefined : this.images.get(this.image);
    // Until the next image is decoded, the one before stays.
    this.plane.visible = this.image >= 0 && (image !== undefined || this.plane.visible);
    if (image && this.texture.image !== image) {
      const before = this.texture.image as HTMLImageElement | undefined;
      if (before && (before.naturalWidth !== image.naturalWidth || before.naturalHeight !== image.naturalHeight)) this.texture.dispose();
      this.texture.image = image;
      this.texture.needsUpdate = true;
    }
    const { material } = this.plane;
    material.transparent = !fromEye;
    material.opacity = fromEye ? 1 : 0.85;
    material.depthTest = material.depthWrite = !fromEye;
    this.plane.renderOrder = fromEye ? -10 : 0;
  }

  get showsImage(): boolean {
    return this.plane.visible && this.node.visible;
  }
}
