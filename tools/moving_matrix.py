#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Measure how object SLAM does with objects that come, go and move, in simulated scenes over many seeds.

Every scene is a configuration of `posemix simulate`, some with changes; `posemix slam` runs on it with what the sequence
file says. Prints one line per figure with the mean over the seeds and the worst seed. With --check the exit status is 1
where a figure is beyond its bound.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

from pose_errors import angle_deg, distance, nees
from simulated_run import Run

ROOT = Path(__file__).resolve().parent.parent
STEP_M, STEP_DEG = 0.03, 20.0  # between two frames of the truth, only an object that was put elsewhere moves this far
NEAR_M, NEAR_DEG = 0.05, 30.0  # an estimate this near to the truth is of the right place and mode
LOOKS = 5  # detections within which a move is to be noticed

# Objects that are put elsewhere in two of the three minutes, and a detector that is wrong in runs of a second.
MOVES = """
schema = 1
camera = {frames = 1800, set_up = "still", range = {mean_m = 1.0, swing_m = 0.0}}
noise.box.components = [{rotation_sd_deg = 3, translation_sd_m = 0.005}]
"""
MOVED = """
[[objects]]
id = "%s"
noise = "box"
position_m = %s
outliers = {fraction = 0.02, mean_run_s = 1, box_m = [0.5, 0.5, 0.5]}
put_down = [{rate_per_s = 0.03, stop_s = 170, area_m = [0.5, 0.5, 0.5]}]
"""
# Objects that stay, told to be put elsewhere at a rate, and a detector that is wrong in runs of 30 on average.
STAYING = """
[[objects]]
id = "%s"
noise = "box"
position_m = %s
%s
put_down = [{rate_per_s = %s, start_s = 1e6, area_m = [0.5, 0.5, 0.5]}]
"""
TURNS = "flips = {fraction = 0.25, mean_run_s = 3, rotation_deg = [0, 0, 180]}"
ELSEWHERE = "outliers = {fraction = 0.1, mean_run_s = 3, box_m = [0.5, 0.5, 0.5]}"
SCENES = {  # name: (configuration or its text, changes)
    "moves": (MOVES + MOVED % ("a", "[-0.2, 0, 0.1]") + MOVED % ("b", "[0.2, 0, 0.1]"), []),
    "stays": (MOVES.replace("1800", "900") + STAYING % ("flips_stated", "[-0.2, 0, 0.1]", TURNS, 0.02)
              + STAYING % ("flips_not_stated", "[0.2, 0, 0.1]", "claimed_noise = \"box\"\n" + TURNS, 0.02)
              + STAYING % ("elsewhere", "[0, 0.2, 0.1]", ELSEWHERE, 0.0001)
              + STAYING % ("calm", "[0, -0.2, 0.1]", "", 0.02), []),
    "table": ("moving-table", ["camera.set_up=\"moving\"", "camera.view.largest_range_m=3"]),
    **{name: (name, []) for name in ("moving-table", "conveyor", "hand-held", "pick-and-place", "hand-over", "crossing",
                                     "come-and-go")},
}


def near(estimate, truth, metres=NEAR_M, degrees=NEAR_DEG):
    return distance(estimate, truth) < metres and angle_deg(estimate, truth) < degrees


def jumps(truth):
    """(frame before, frame after) of every put-down at another place."""
    known = [k for k, pose in enumerate(truth) if pose is not None]
    return [(a, b) for a, b in zip(known, known[1:])
            if distance(truth[a], truth[b]) > STEP_M or angle_deg(truth[a], truth[b]) > STEP_DEG]


def moves(run, name):
    """For every move the right detections until the estimate is at the new place; infinity for never."""
    world, truth = run.object(name)["world"]["pose"], run.truth(name)
    seen = [near(*pair, 0.1, 60.0) if None not in pair else False
            for pair in zip(run.object(name)["detection"], run.relative_truth(name))]
    starts = jumps(truth)
    ends = [before + 1 for before, _ in starts[1:]] + [len(truth)]
    for (_, after), end in zip(starts, ends):
        looks = 0
        for k in range(after, end):
            looks += seen[k]
            if looks and world[k] and truth[k] and near(world[k], truth[k]):
                yield looks
                break
        else:
            if looks > LOOKS:
                yield float("inf")


def false_moves(run, name):
    """How often the estimate leaves the right place of an object that was not moved, and the number of detections.

    An estimate counts where it has a probability of 0.9: which of two modes is right may be open for some time."""
    entry, truth = run.object(name), run.truth(name)
    count, was_right = 0, False
    for pose, true, probability in zip(entry["world"]["pose"], truth, entry["mode_probability"]):
        if None in (pose, true, probability) or probability < 0.9:
            continue
        right = near(pose, true)
        count += was_right and not right
        was_right = right
    return count, sum(detection is not None for detection in entry["detection"])


def flips(run, name):
    """Share of the frames on the right mode, and the longest time on a wrong one, frames."""
    world, truth = run.object(name)["world"]["pose"], run.truth(name)
    right = [near(pose, true, 0.1, 60.0) for pose, true in zip(world, truth) if pose and true]
    longest = current = 0
    for value in right[LOOKS:]:
        current = 0 if value else current + 1
        longest = max(longest, current)
    return sum(right) / len(right), longest


def anees(run, name, frame, moving):
    """Mean NEES per degree of freedom over the frames with a detection and the right mode.

    Of `moving` objects, those in which the object moves and a moving model has the most probability."""
    entry, truth = run.object(name), run.truth(name)
    series = entry[frame]
    true = truth if frame == "world" else series["truth"] or run.relative_truth(name)
    models, names = entry.get("models"), entry.get("model_names")
    values = []
    for k in range(1, len(truth)):
        pose = series["pose"][k]
        if None in (pose, true[k], truth[k], truth[k - 1]) or entry["detection"][k] is None:
            continue
        moves_now = distance(truth[k], truth[k - 1]) > 1e-4 or angle_deg(truth[k], truth[k - 1]) > 0.01
        if models and models[k]:
            best = names[max(range(len(names)), key=lambda i: models[k][i])]
            if moves_now != (best not in ("static", "put_down")):
                continue
        if moves_now == moving and near(pose, true[k], 0.1, 20.0):
            values.append(nees(true[k], pose, series["covariance"][k]))
    return values


def followed(run, name, true_objects):
    """By frame the true object nearest to an instance, None where none is within 5 cm."""
    truths = {true: run.truth(true) for true in true_objects}
    result = []
    for k, pose in enumerate(run.object(name)["world"]["pose"]):
        candidates = [(distance(pose, path[k]), true) for true, path in truths.items() if pose and path[k]]
        result.append(min(candidates)[1] if candidates and min(candidates)[0] < NEAR_M else None)
    return result


def identities(run, start):
    """Of the objects those that have one instance from frame `start` to the end, and the same one."""
    true_objects = run.true_objects()
    owners = {true: set() for true in true_objects}
    for name in run.trace["order"]:
        if run.object(name)["world"]["pose"][-1] is None:
            continue
        for true in followed(run, name, true_objects)[start:]:
            if true:
                owners[true].add(name)
    ends = [followed(run, name, true_objects)[-1] for name in run.trace["order"]]
    return sum(len(names) == 1 and ends.count(true) == 1 for true, names in owners.items()), len(true_objects)


def errors_mm(run, name):
    """Distance of the estimate in the world from the truth, mm, where both are known."""
    return [1e3 * distance(pose, true) for pose, true in zip(run.object(name)["world"]["pose"], run.truth(name))
            if pose and true]


def simulate_and_track(program, folder, scene, seed, smooth):
    """The run of a scene with one seed, smoothed or not."""
    source, changes = SCENES[scene]
    config = ROOT / "configs" / f"{source}.toml"
    target = folder / f"{scene}-{seed}"
    if "\n" in source:
        config = folder / f"{scene}.toml"
        config.write_text(source, encoding="utf-8")
    overrides = [word for change in changes for word in ("--set", change)]
    subprocess.run([program, "simulate", config, "--seed", str(seed), "--out", target / "recording", "--quiet", *overrides],
                   check=True)
    subprocess.run([program, "slam", target / "recording" / "sequence.toml", "--out", target / "results", "--quiet",
                    *(["--smooth"] if smooth else [])],
                   check=True)
    return Run(target / "recording", target / "results")


MOVING = {"conveyor": ["box_1", "box_2", "box_3"], "hand-held": ["mug"], "hand-over": ["mug"],
          "pick-and-place": ["tea-box", "cracker-box"], "moving-table": ["mug", "tea-box"]}


def existence(run):
    """Of all instances that are confirmed at some time: how many are at a true object; true objects that are
    confirmed; removed objects, and those of them whose instance says within five seconds that it is lost."""
    true_objects = run.true_objects()
    truths = {true: run.truth(true) for true in true_objects}
    confirmed = {"true": 0, "false": 0}
    found, removed, lost = set(), 0, 0
    for name in run.trace["order"]:
        entry = run.object(name)
        owners = followed(run, name, true_objects)
        good = [k for k, health in enumerate(entry["health"]) if health not in ("none", "tentative", "lost")]
        if not good:
            continue
        owner = next((owners[k] for k in good if owners[k]), None)
        confirmed["true" if owner else "false"] += 1
        found.add(owner)
        end = max((k for k, pose in enumerate(truths[owner]) if pose), default=0) if owner else len(run.stamps)
        if end + 1 < len(run.stamps):
            removed += 1
            after = [h for h, t in zip(entry["health"][end:], run.stamps[end:]) if t - run.stamps[end] < 5.0]
            lost += "lost" in after
    return {"confirmed": confirmed, "found": len(found - {None}), "of": len(true_objects), "removed": removed, "lost": lost}


def measure(run, scene):
    """The figures of one run by name."""
    figures = {}
    if scene in ("moves", "moving-table", "pick-and-place", "table"):
        names = ("a", "b") if scene == "moves" else ("soup-can",)
        figures["moves"] = [looks for name in names for looks in moves(run, name)]
    if scene == "stays":
        figures |= {f"false moves, {name}": false_moves(run, name)
                    for name in ("flips_stated", "flips_not_stated", "elsewhere", "calm")}
    if scene == "table":
        figures["camera"] = run.metrics["camera"]["position_rmse_m"] / run.metrics["odometry"]["position_rmse_m"]
        figures["camera turn"] = run.metrics["camera"]["rotation_rmse_deg"] / run.metrics["odometry"]["rotation_rmse_deg"]
    if scene == "crossing":
        figures["identities"] = identities(run, 20)
    if scene in ("come-and-go", "moving-table") and "health" in run.object(run.trace["order"][0]):
        figures["existence"] = existence(run)
    if scene in MOVING:
        figures["error, mm"] = [value for name in MOVING[scene] for value in errors_mm(run, name)]
        for frame in ("world", "relative"):
            for moving in (True, False):
                values = [v for name in MOVING[scene] for v in anees(run, name, frame, moving)]
                figures[f"anees {frame} {'moving' if moving else 'still'}"] = values
    if scene in ("hand-held", "moving-table"):
        figures["flips"] = flips(run, "mug" if scene == "hand-held" else "tea-box")
    return figures


def mean(values):
    return sum(values) / len(values) if values else float("nan")


def summary(scene, name, values):
    """(what was measured, whether it is within its bound) of one figure over the seeds."""
    if name == "moves":
        looks = [number for of_run in values for number in of_run]
        share = mean([number <= LOOKS for number in looks])
        seen = [number for number in looks if number < float("inf")]
        return f"{len(looks)} moves, {share:.2%} within {LOOKS}, mean {mean(seen):.1f}, worst {max(looks, default=0)}", share >= 0.99
    if name.startswith("false moves"):
        count, looks = (sum(column) for column in zip(*values))
        return f"{count} of {looks} detections", count <= max(1.0, looks / 10000)
    if name == "identities":
        kept, objects = (sum(column) for column in zip(*values))
        return f"{kept} of {objects} kept", kept >= 0.99 * objects
    if name == "error, mm":
        every = sorted(value for of_run in values for value in of_run)
        return f"median {every[len(every) // 2]:.1f}, 99 % {every[int(0.99 * len(every))]:.1f}, worst {every[-1]:.0f}", True
    if name.startswith("anees"):
        every = mean([value for of_run in values for value in of_run])
        seeds = [mean(of_run) for of_run in values if of_run]
        return f"{every:.2f}, by seed {min(seeds):.2f} to {max(seeds):.2f}", 0.8 <= every <= 1.25
    if name == "flips":
        shares, longest = zip(*values)
        return f"right in {mean(shares):.1%}, worst seed {min(shares):.1%}, at most {max(longest)} frames wrong", True
    if name == "existence":
        total = {key: sum(value[key] for value in values) for key in ("found", "of", "removed", "lost")}
        wrong = sum(value["confirmed"]["false"] for value in values)
        return "{found} of {of} objects confirmed, {lost} of {removed} removed ones lost within 5 s".format(**total) + (
            f", {wrong} false instances confirmed at some time"), True
    return f"{mean(values):.2f}, worst seed {max(values):.2f}", max(values) <= 1.02


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--posemix", default=ROOT / "build/release/posemix", help="the program")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--smooth", action="store_true", help="estimates from the whole recordings")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(SCENES))
    arguments = parser.parse_args()
    good = True
    for scene in arguments.scenes or SCENES:
        with tempfile.TemporaryDirectory() as folder:
            runs = [measure(simulate_and_track(arguments.posemix, Path(folder), scene, seed, arguments.smooth), scene)
                    for seed in range(1, arguments.seeds + 1)]
        for name in runs[0]:
            text, within = summary(scene, name, [run[name] for run in runs])
            print(f"{scene}: {name}: {text}{'' if within else ' (beyond its bound)'}", flush=True)
            good = good and within
    return 1 if arguments.check and not good else 0


if __name__ == "__main__":
    sys.exit(main())
