// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { multiply } from "../../src/math/rotation.ts";
import { RunFacts } from "../../src/state/run_facts.ts";
import { differenceOf, inWords, stepInWords } from "../../src/trace/difference.ts";
import { describe, EVENT_KINDS, type EventKind, NEES_LIMIT, type RunEvent } from "../../src/trace/events.ts";
import { hypothesesInWords } from "../../src/trace/hypotheses.ts";
import { joinAll, spansOf } from "../../src/trace/spans.ts";
import { readTrace } from "../../src/trace/trace.ts";
import { AT, eventfulTrace, FRAMES, IDS } from "../eventful.ts";
import { packTrace, type TraceJson } from "../pack.ts";
import { syntheticTrace } from "../synthetic.ts";

function product(a: number[], b: number[]): number[] {
  const out = [0, 0, 0, 1];
  multiply(a, b, out);
  return out;
}
const factsOf = async (json: TraceJson) => new RunFacts(await readTrace(packTrace(json)));
const of = (facts: RunFacts, id: string, kind: EventKind): RunEvent[] =>
  facts.eventsOfEntity(IDS.indexOf(id as (typeof IDS)[number])).filter((event) => event.kind === kind);
const frames = (events: RunEvent[]) => events.map(({ from, to }) => [from, to]);

test("spans go across short gaps and keep the worst", () => {
  const values = [0, 1, 3, 0, 2, 0, 0, 0, 5];
  const at = (frame: number) => values[frame];
  assert.deepEqual(spansOf(values.length, at, 1), [
    { from: 1, to: 2, count: 2, peak: 2, size: 3 }, { from: 4, to: 4, count: 1, peak: 4, size: 2 }, { from: 8, to: 8, count: 1, peak: 8, size: 5 },
  ]);
  assert.deepEqual(spansOf(values.length, at, 2).map(({ from, to, count }) => [from, to, count]), [[1, 4, 3], [8, 8, 1]]);
  assert.deepEqual(joinAll(spansOf(values.length, at, 1), 4), [{ from: 1, to: 8, count: 4, peak: 8, size: 5 }]);
});

test("every trouble of a run is an event at its frame, and what has none has no events", async () => {
  const facts = await factsOf(eventfulTrace());
  assert.deepEqual(frames(of(facts, "tea-box", "flipped")), [[AT.flip, AT.flip]]);
  assert.match(describe(facts.trace, of(facts, "tea-box", "flipped")[0]), /turned (17\d|180) deg about z/);
  assert.deepEqual(frames(of(facts, "tea-box", "pruned")), [[AT.pruned, AT.pruned]]);
  assert.deepEqual(frames(of(facts, "cracker-box", "unexplained")), [[...AT.unexplained]]);
  assert.equal(of(facts, "cracker-box", "unexplained")[0].count, 12);
  assert.deepEqual(frames(of(facts, "late-cup", "entered")), [[AT.enters, AT.enters]]);
  assert.deepEqual(frames(of(facts, "late-cup", "lost")), [[...AT.lost]]);
  assert.deepEqual(frames(of(facts, "late-cup", "register")), [[...AT.again]]);
  assert.deepEqual(frames(of(facts, "cart", "moved")), [[...AT.moves]]);
  assert.deepEqual(facts.eventsOfEntity(0).map(({ kind }) => kind), ["entered"]);
  assert.deepEqual(facts.eventsOfEntity(-1), []);
});

test("errors beyond 3 sigma and NEES beyond its band are found where the truth says so", async () => {
  const facts = await factsOf(eventfulTrace());
  for (const kind of ["beyond", "nees"] as const) {
    const [event, ...others] = of(facts, "cracker-box", kind);
    assert.deepEqual(others, []);
    assert.ok(Math.abs(event.from - AT.dragged[0]) <= 1 && Math.abs(event.to - AT.dragged[1]) <= 1, `${kind} ${event.from} to ${event.to}`);
  }
  assert.ok(Math.abs(NEES_LIMIT - 22.4577) < 1e-3);
  const without = await factsOf(eventfulTrace({ truth: false }));
  assert.ok(without.events.every(({ kind }) => kind !== "beyond" && kind !== "nees"));
  assert.ok(without.events.some(({ kind }) => kind === "flipped"));
});

test("a wrong mode, a track that is ambiguous, and an object out of sight whose pose is not known", async () => {
  const json = eventfulTrace();
  const { mug, cart } = json.objects;
  mug.health = mug.health!.map((word, k) => (k >= 100 && k < 130 ? "ambiguous" : word));
  const hidden = (k: number) => k >= 200 && k < 250;
  cart.detection = cart.detection.map((pose, k) => (hidden(k) ? null : pose));
  for (const track of [cart.world, cart.relative]) {
    track.sd = track.sd.map((sd, k) => (hidden(k) ? sd!.map(() => 0.2) : sd));
    track.position_covariance = track.position_covariance!.map((covariance, k) => (hidden(k) ? [0.04, 0, 0, 0.04, 0, 0.04] : covariance));
    track.pose = track.pose.map((pose, k) => (hidden(k) ? [pose![0] + 0.3, ...pose!.slice(1)] : pose));
  }
  const facts = await factsOf(json);
  assert.deepEqual(frames(of(facts, "tea-box", "wrong")), [[0, AT.flip - 1]]);
  assert.match(describe(facts.trace, of(facts, "tea-box", "wrong")[0]), /^on a wrong mode for 6\.00 s: turned (17\d|180) deg about z.* from the truth$/);
  assert.deepEqual(frames(of(facts, "mug", "ambiguous")), [[100, 129]]);
  assert.deepEqual(frames(of(facts, "cart", "unknown")), [[200, 249]]);
  assert.match(describe(facts.trace, of(facts, "cart", "unknown")[0]), /^position not known to better than 600 mm \(3 sigma\), for 5\.00 s$/);
  assert.deepEqual(of(facts, "cart", "wrong"), []);
  assert.ok(facts.events.every(({ kind, entity }) => kind !== "wrong" || entity === IDS.indexOf("tea-box")));
});

test("events are by time, and every kind has words", async () => {
  const facts = await factsOf(eventfulTrace());
  const times = facts.events.map(({ from }) => from);
  assert.deepEqual(times, [...times].sort((a, b) => a - b));
  for (const kind of Object.keys(EVENT_KINDS) as EventKind[]) {
    for (const count of [1, 3]) assert.match(describe(facts.trace, { kind, entity: 0, from: 1, to: 5, count, peak: 2, size: 0.5 }), /\S{3}/);
  }
});

test("a hypothesis that is born, and one that merges", async () => {
  const json = eventfulTrace();
  const mug = json.objects["mug"];
  const near = (pose: number[], shift: number) => [pose[0] + shift, ...pose.slice(1)];
  mug.alternatives = mug.alternatives!.map((list, k) => (k >= 50 && k < 80 ? [{ ...list[0], probability: 0.7 }, { id: 99, probability: 0.2, pose: near(list[0].pose, 0.3 * (80 - k) / 30 ) }] : list));
  const facts = await factsOf(json);
  assert.deepEqual(frames(of(facts, "mug", "born")), [[50, 50]]);
  assert.deepEqual(frames(of(facts, "mug", "merged")), []);
  assert.deepEqual(frames(of(facts, "mug", "pruned")), [[80, 80]]);
  mug.alternatives = mug.alternatives.map((list) => list.map((one) => (one.id === 99 ? { ...one, pose: near(list[0].pose, 0.004) } : one)));
  const merged = await factsOf(json);
  assert.deepEqual(frames(of(merged, "mug", "merged")), [[80, 80]]);
});

test("a long run that is wrong all the time has few events", async () => {
  const json = eventfulTrace({ nees: false });
  for (const id of IDS) {
    json.objects[id].status = json.objects[id].status.map((_, k) => (k % 10 < 4 ? "doubted" : "used"));
    json.objects[id].world.pose = json.objects[id].world.pose.map((pose, k) => pose && (k % 3 === 0 ? [pose[0] + 1, ...pose.slice(1)] : pose));
  }
  const wrong = await factsOf(json);
  assert.ok(wrong.events.length <= 300);
  assert.ok(of(wrong, "mug", "flipped").reduce((sum, { count }) => sum + count, 0) > FRAMES / 2);
  const long = new RunFacts(await readTrace(syntheticTrace({ frames: 5000, objects: 4, hypotheses: 3 })));
  assert.ok(long.events.length <= 300 && long.events.length >= 4);
});

test("differences in words: along an axis by its name, others by their direction", () => {
  const turn = (axis: number[], degrees: number) => [...axis.map((value) => value * Math.sin((degrees * Math.PI) / 360)), Math.cos((degrees * Math.PI) / 360)];
  const still = [0, 0, 0, 1];
  assert.equal(inWords(differenceOf([0, 0, 0], still, [0.012, 0, 0], turn([0, 0, 1], 180))), "turned 180 deg about z, 12.0 mm apart");
  assert.equal(inWords(differenceOf([0, 0, 0], still, [0, 0, 0], turn([0, 1, 0], -25))), "turned -25 deg about y");
  assert.match(inWords(differenceOf([0, 0, 0], still, [0, 0, 0], turn([Math.SQRT1_2, 0, Math.SQRT1_2], 90))), /^turned 90 deg about \(0\.71, 0\.00, 0\.71\)$/);
  assert.equal(inWords(differenceOf([0, 0, 0], still, [1e-4, 0, 0], still)), "as is");
  assert.equal(stepInWords(differenceOf([0, 0, 0], still, [0, 0.05, 0], still)), "moved 50.0 mm");
  // The axis is that of the body: a body that lies on its side turns about its own z.
  const lying = turn([1, 0, 0], 90);
  assert.equal(inWords(differenceOf([0, 0, 0], lying, [0, 0, 0], product(lying, turn([0, 0, 1], 180)))), "turned 180 deg about z");
});

test("hypotheses in words, relative to the heaviest", async () => {
  const { trace } = await factsOf(eventfulTrace());
  const [first, second, ...rest] = hypothesesInWords(trace.objects[1].hypotheses, 0)!;
  assert.equal(first, "as is: 57 %");
  assert.match(second, /^turned (17\d|180) deg about z, 1\d\.\d mm apart: 43 %$/);
  assert.deepEqual(rest, []);
  assert.equal(hypothesesInWords(trace.objects[3].hypotheses, 0), undefined);
  // Two that are the same for this object count as one.
  const [turned, still] = trace.objects[1].hypotheses;
  assert.equal(hypothesesInWords([turned, turned, still], 0)![0], "as is: 114 %");
});
