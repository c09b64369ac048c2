// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What is under the pointer, in words.
import { CAMERA } from "../state/run_state.ts";
import type { Trace } from "../trace/trace.ts";
import type { ObjectPart } from "./object_part.ts";
import type { Pick } from "./picks.ts";
import { Spread } from "./spread.ts";
import { differenceText, spreadLines } from "./tips.ts";
import type { UncertaintyPart } from "./uncertainty_part.ts";

export class Describer {
  private readonly spread = new Spread();
  private readonly p = new Float64Array(3);
  private readonly q = new Float64Array(4);

  constructor(private readonly trace: Trace, private readonly objects: ObjectPart, private readonly uncertainty: UncertaintyPart) {}

  lines(pick: Pick, frame: number): string[] {
    const id = pick.entity === CAMERA ? this.trace.cameraName : this.trace.objects[pick.entity].id;
    if (pick.kind === "hypothesis") return this.hypothesis(id, pick, frame);
    if (pick.kind === "truth") return this.other(`${id}: ground truth`, pick, frame);
    if (pick.kind === "detection") return this.other(`${id}: detection`, pick, frame);
    const quaternion = pick.entity === CAMERA ? this.q : this.objects.quaternions[pick.entity];
    const head = [id, ...this.weight(pick.entity, frame)];
    if (!this.uncertainty.read(pick.entity, frame, quaternion, this.spread)) return head;
    return [...head, ...spreadLines(this.spread, this.uncertainty.look.frame).map((line) => (pick.entity === CAMERA ? line.replace("T_world_object", "T_world_camera") : line))];
  }

  private weight(entity: number, frame: number): string[] {
    const percent = entity === CAMERA ? -1 : this.objects.leadingPercent(entity, frame);
    return percent < 0 ? [] : [`${percent} %: the filter's own weight of this hypothesis, a belief`];
  }

  private hypothesis(id: string, { entity, slot }: Pick, frame: number): string[] {
    const found = this.trace.objects[entity].hypotheses[slot];
    const title = `${id}: hypothesis, ${(100 * found.probability(frame)).toFixed(1)} %`;
    found.pose.position(frame, this.p);
    found.pose.quaternion(frame, this.q);
    return this.withDifference(title, entity);
  }

  private other(title: string, { entity, kind }: Pick, frame: number): string[] {
    if (entity === CAMERA) return [title];
    if (kind === "detection") this.objects.detectionPose(entity, frame, this.p, this.q);
    else {
      this.trace.objects[entity].world!.truth!.position(frame, this.p);
      this.trace.objects[entity].world!.truth!.quaternion(frame, this.q);
    }
    return this.withDifference(title, entity);
  }

  private withDifference(title: string, entity: number): string[] {
    if (!this.objects.isHere[entity]) return [title];
    return [title, `from the estimate: ${differenceText(this.objects.positions[entity], this.objects.quaternions[entity], this.p, this.q)}`];
  }
}
