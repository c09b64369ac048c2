// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A run frame by frame. Reading a frame writes into arrays of the caller and allocates nothing.
import { covarianceOf } from "../math/linear.ts";
import { normalize, type Numbers } from "../math/rotation.ts";
import type { PackedTrace } from "../payload.ts";
import { type Column, type Columns, decodeColumns, type Integers } from "./decode.ts";

/** Which frames have an entry: one bit of a mask, or all if there is no mask. */
class Presence {
  constructor(
    private readonly mask: Integers | undefined,
    private readonly bit: number,
  ) {}

  has(frame: number): boolean {
    return this.mask === undefined || (this.mask[frame] & this.bit) !== 0;
  }
}

export class PoseTrack {
  constructor(
    private readonly presence: Presence,
    private readonly place: Column,
    private readonly turn: Column,
  ) {}

  has(frame: number): boolean {
    return this.presence.has(frame);
  }

  position(frame: number, out: Numbers): void {
    for (let i = 0; i < 3; ++i) out[i] = this.place.components[i][frame] * this.place.head.scale;
  }

  quaternion(frame: number, out: Numbers): void {
    for (let i = 0; i < 4; ++i) out[i] = this.turn.components[i][frame];
    normalize(out);
  }
}

/** An estimate over the frames: pose, standard deviations and the covariance of the position. */
export class Estimate {
  constructor(
    readonly pose: PoseTrack,
    readonly truth: PoseTrack | undefined,
    private readonly logSd: Column | undefined,
    private readonly positionSd: Column | undefined,
    private readonly correlation: Column | undefined,
  ) {}

  get hasSd(): boolean {
    return this.logSd !== undefined;
  }

  get hasPositionSd(): boolean {
    return this.positionSd !== undefined;
  }

  get hasCovariance(): boolean {
    return this.positionSd !== undefined && this.correlation !== undefined;
  }

  /** Standard deviations of the rotation about x, y, z [rad]. */
  rotationSd(frame: number, out: Numbers): void {
    for (let i = 0; i < 3; ++i) out[i] = this.logSd ? this.logSd.value(i, frame) : NaN;
  }

  /** Standard deviations of the translation of the perturbation [m], which are the position's only at the frame's origin. */
  tangentSd(frame: number, out: Numbers): void {
    for (let i = 0; i < 3; ++i) out[i] = this.logSd ? this.logSd.value(3 + i, frame) : NaN;
  }

  /** Standard deviations of the position [m]. */
  positionSdAt(frame: number, out: Numbers): void {
    for (let i = 0; i < 3; ++i) out[i] = this.positionSd ? this.positionSd.value(i, frame) : NaN;
  }

  private readonly sd = new Float64Array(3);
  private readonly rho = new Float64Array(3);

  /** The covariance of the position, nine numbers [m^2]. */
  covariance(frame: number, out: Numbers): void {
    this.positionSdAt(frame, this.sd);
    for (let i = 0; i < 3; ++i) this.rho[i] = this.correlation ? this.correlation.value(i, frame) : 0;
    covarianceOf(this.sd, this.rho, out);
  }
}

/** One place in the list of hypotheses; the hypothesis in it changes with `id`. */
export class HypothesisSlot {
  constructor(
    readonly pose: PoseTrack,
    private readonly ids: Column | undefined,
    private readonly weight: Column,
  ) {}

  id(frame: number): number {
    return this.ids ? this.ids.components[0][frame] : 0;
  }

  probability(frame: number): number {
    return this.weight.components[0][frame] * this.weight.head.scale;
  }
}

/** The models of motion of an object that moves. */
export interface MotionModels {
  names: string[];
  /** Probability of a model at a frame; undefined before the object was seen. */
  probability(model: number, frame: number): number | undefined;
}

export interface ObjectTrack {
  id: string;
  world: Estimate | undefined;
  relative: Estimate | undefined;
  detection: PoseTrack | undefined;
  status: Integers | undefined;
  /** Probability of the mode at a frame; undefined if there is none. */
  modeProbability: ((frame: number) => number | undefined) | undefined;
  hypotheses: HypothesisSlot[];
  /** Probability that the object exists; undefined before it was seen. */
  existence: ((frame: number) => number | undefined) | undefined;
  /** Index into the words of health. */
  health: Integers | undefined;
  /** One where the track should be registered again. */
  registerAgain: Integers | undefined;
  /** Of an object that moves. */
  models: MotionModels | undefined;
}

function poseTrack(columns: Columns, name: string, presence: Presence): PoseTrack | undefined {
  const place = columns.get(`${name}/position`);
  const turn = columns.get(`${name}/quaternion`);
  return place && turn ? new PoseTrack(presence, place, turn) : undefined;
}

function estimate(columns: Columns, name: string, here: Presence, truth: Presence): Estimate | undefined {
  const pose = poseTrack(columns, name, here);
  if (!pose) return undefined;
  return new Estimate(
    pose,
    poseTrack(columns, `${name}/truth`, truth),
    columns.get(`${name}/log_sd`),
    columns.get(`${name}/position_log_sd`),
    columns.get(`${name}/position_correlation`),
  );
}

function scalar(column: Column | undefined, presence: Presence): ((frame: number) => number | undefined) | undefined {
  return column && ((frame) => (presence.has(frame) ? column.value(0, frame) : undefined));
}

/** `calm` and `calm` become `calm 1` and `calm 2`. */
function distinct(names: string[]): string[] {
  const spoken = names.map((name) => name.replaceAll("_", " "));
  return spoken.map((name, k) => {
    const same = spoken.filter((other) => other === name).length > 1;
    return same ? `${name} ${spoken.slice(0, k + 1).filter((other) => other === name).length}` : name;
  });
}

function motionModels(names: string[] | undefined, column: Column | undefined, presence: Presence): MotionModels | undefined {
  if (!names || !column || names.length !== column.head.width) return undefined;
  return { names: distinct(names), probability: (model, frame) => (presence.has(frame) ? column.value(model, frame) : undefined) };
}

function slots(columns: Columns, name: string): HypothesisSlot[] {
  const found: HypothesisSlot[] = [];
  for (let k = 0; ; ++k) {
    const slot = `${name}/hypotheses/${k}`;
    const weight = columns.get(`${slot}/probability`);
    const pose = poseTrack(columns, slot, new Presence(columns.get(`${slot}/mask`)?.components[0], 1));
    if (!weight || !pose) return found;
    found.push(new HypothesisSlot(pose, columns.get(`${slot}/id`), weight));
  }
}

/** "camera", or a name that no object has. */
function cameraNameOf(ids: readonly string[]): string {
  let name = "camera";
  while (ids.includes(name)) name = `the ${name}`;
  return name;
}

export class Trace {
  readonly frames: number;
  /** Seconds since the first frame. */
  readonly seconds: Float64Array;
  readonly statuses: readonly string[];
  readonly healths: readonly string[];
  /** What the camera is called, on the page and in addresses; it tells it from all objects. */
  readonly cameraName: string;
  readonly camera: Estimate | undefined;
  readonly cameraHypotheses: readonly HypothesisSlot[];
  readonly objects: readonly ObjectTrack[];
  /** Whether an object moves, was lost, should be registered again, or is not good at the end: else there is nothing to tell of tracks. */
  readonly hasTracks: boolean;

  constructor(
    readonly head: PackedTrace,
    readonly columns: Columns,
  ) {
    this.frames = head.frames;
    this.seconds = Float64Array.from(head.stamps_s, (stamp) => stamp - head.stamps_s[0]);
    this.statuses = head.statuses ?? [];
    this.healths = head.healths ?? [];
    this.cameraName = cameraNameOf(head.order);
    const bits = (mask: Integers | undefined, bit: number) => new Presence(mask, 1 << bit);
    const mask = columns.get("camera/mask")?.components[0];
    this.camera = estimate(columns, "camera", bits(mask, 0), bits(mask, 1));
    this.cameraHypotheses = slots(columns, "camera");
    this.objects = head.order.map((id) => {
      const name = `objects/${id}`;
      const own = columns.get(`${name}/mask`)?.components[0];
      return {
        id,
        world: estimate(columns, `${name}/world`, bits(own, 0), bits(own, 1)),
        relative: estimate(columns, `${name}/relative`, bits(own, 2), bits(own, 3)),
        detection: poseTrack(columns, `${name}/detection`, bits(own, 4)),
        status: columns.get(`${name}/status`)?.components[0],
        modeProbability: scalar(columns.get(`${name}/mode_probability`), bits(own, 5)),
        hypotheses: slots(columns, name),
        existence: scalar(columns.get(`${name}/existence`), bits(own, 6)),
        health: columns.get(`${name}/health`)?.components[0],
        registerAgain: columns.get(`${name}/register_again`)?.components[0],
        models: motionModels(head.models?.[id], columns.get(`${name}/models`), bits(own, 7)),
      };
    });
    this.hasTracks = this.objects.some((object) => object.models !== undefined || this.comesOrGoes(object));
  }

  /** The word for the health of an object, "" where there is none. */
  healthAt(index: number, frame: number): string {
    const { health } = this.objects[index];
    return health ? (this.healths[health[frame]] ?? "") : "";
  }

  private comesOrGoes({ health, registerAgain }: ObjectTrack): boolean {
    if (!health) return false;
    const lost = this.healths.indexOf("lost");
    const atLast = this.healths[health[this.frames - 1]];
    const good = atLast === "none" || atLast === "good" || atLast === "ambiguous";
    return !good || health.some((value) => value === lost) || (registerAgain?.some((value) => value !== 0) ?? false);
  }

  get hasTruth(): boolean {
    return this.camera?.truth !== undefined || this.objects.some((object) => object.world?.truth !== undefined);
  }

  /** The last frame at or before a time. */
  frameAt(seconds: number): number {
    let low = 0;
    let high = this.frames - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.seconds[middle] <= seconds) low = middle;
      else high = middle - 1;
    }
    return low;
  }
}

export async function readTrace(packed: PackedTrace): Promise<Trace> {
  return new Trace(packed, await decodeColumns(packed));
}
