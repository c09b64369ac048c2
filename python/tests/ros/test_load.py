# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Node and program under more than they can do: queues have bounds, the oldest images are dropped and counted, and soon
after it is as if nothing had been.

A short burst, unless POSEMIX_LOAD_IMAGES says how many images it has; `-s` prints what happened:

    POSEMIX_LOAD_IMAGES=6000 build/ros/run python -m pytest -s python/tests/ros/test_load.py
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")

from posemix import SE3

from .live import SECOND, Live, at, detections, values_of
from .program import Program, unavailable
from .test_live_runs import program as node_program
from .test_live_soak import resident_mb

IMAGES = int(os.environ.get("POSEMIX_LOAD_IMAGES", "900"))
SOURCES = [f"source_{k}" for k in range(5)]
PER_SOURCE = 20
OBJECTS = PER_SOURCE * len(SOURCES)
# Ten times what cameras have.
RATE = 600
# The defaults.
QUEUE = 100
DEPTH = 10
# Of a queue of images of twenty objects, of those of the middleware, and of what the filter has of a hundred objects.
LEAST_GROWTH_MB = 500.0


class Watched:
    """A process under test, whose counts come from its diagnostics."""

    def __init__(self, pid: int, world: Live, values: Callable[[], dict[str, str]]) -> None:
        self.pid, self.world, self.values = pid, world, values

    def flood(self, rng: np.random.Generator) -> tuple[float, int]:
        """A hundred objects by five detectors, each twenty of them, in images of 600 Hz; how long that took [s], and
        the most images that waited."""
        places = [SE3.exp([*rng.normal(size=3), *rng.uniform(-1.0, 1.0, 2), 2.0]) for _ in range(OBJECTS)]
        scene = []
        for i in range(IMAGES):
            k = i % len(SOURCES)
            seen = {
                f"object_{j}": places[j] * SE3.exp(rng.normal(size=6) * [0.01, 0.01, 0.01, 0.003, 0.003, 0.003])
                for j in range(k * PER_SOURCE, (k + 1) * PER_SOURCE)
            }
            scene.append((SOURCES[k], detections(at(i / RATE), seen)))
        begin, waiting = time.monotonic(), 0
        for i, (source, message) in enumerate(scene):
            self.world.move(at(i / RATE), SE3())
            self.world.detect(message, source)
            self.world.spin(max(begin + (i + 1) / RATE - time.monotonic(), 0.0))
            if i % 100 == 99 and self.world.diagnostics:
                statuses = self.world.diagnostics[-1].status
                waiting = max(waiting, *(int(values_of(s).get("waiting", 0)) for s in statuses))
        return time.monotonic() - begin, waiting


@pytest.fixture(params=["node", "program"])
def watched(request: Any, ros: None, live: Callable[..., Live], domain: int, tmp_path: Path) -> Any:
    kinds = {name: None for name in SOURCES}
    if request.param == "program":
        if unavailable():
            pytest.skip(unavailable())
        text = "".join(f'[[sources]]\nname = "{name}"\nreliability = "reliable"\n' for name in SOURCES)
        settings = {"live.queue_size": QUEUE, "live.transform_timeout_s": 0.2, "live.input_depth": DEPTH}
        running = Program(tmp_path, domain, text, kinds=kinds, settings=settings)
        yield Watched(running.process.pid, running.ready().world, running.values)
        running.close()
        return
    parameters = {
        "least_existence": 0.0, "diagnostics_hz": 20.0, "queue_size": QUEUE, "transform_timeout_s": 0.2,
        "input_depth": DEPTH, "sources": f"[{','.join(SOURCES)}]",
        **{f"qos_overrides./posemix/{name}.subscription.reliability": "reliable" for name in SOURCES},
    }  # fmt: skip
    words = [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]
    process = node_program("--ros-args", *words, domain=domain)
    world = live(node=False, kinds=kinds)
    try:
        world.meet_program()
        yield Watched(process.pid, world, lambda: values_of(world.status("node")))
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=20)


def test_more_than_can_be_done(watched: Watched, request: Any, capsys: pytest.CaptureFixture[str]) -> None:
    rng = np.random.default_rng(4)
    world = watched.world
    before_mb = resident_mb(watched.pid)
    seconds, waiting = watched.flood(rng)

    # The queue runs empty, and says so in between.
    begin = time.monotonic()
    world.until(lambda: watched.values()["waiting"] == "0", "the queue is empty", 120.0)
    empty_s = time.monotonic() - begin
    after_mb = resident_mb(watched.pid)

    # A calm image is answered, behind what the middleware still has.
    last = IMAGES / RATE + 1.0
    world.objects.clear()
    world.move(at(last), SE3())
    begin = time.monotonic()
    world.detect(detections(at(last), {"object_0": SE3(translation=[0.0, 0.0, 2.0])}), SOURCES[0])
    stamp = divmod(at(last), SECOND)
    world.until(
        lambda: any((m.header.stamp.sec, m.header.stamp.nanosec) == stamp for m in world.objects),
        "the calm image is answered", 60.0,
    )  # fmt: skip
    answer_s = time.monotonic() - begin
    # The next one as if nothing had been.
    world.move(at(last + 0.1), SE3())
    begin = time.monotonic()
    world.detect(detections(at(last + 0.1), {"object_0": SE3(translation=[0.0, 0.0, 2.0])}), SOURCES[0])
    world.newest(at(last + 0.1))
    calm_s = time.monotonic() - begin

    values = watched.values()
    taken, dropped = int(values["images"]), int(values["dropped"])
    lost = IMAGES - taken - dropped
    with capsys.disabled():
        print(
            f"\n{request.node.name}: {IMAGES} images of {PER_SOURCE} of {OBJECTS} objects by {len(SOURCES)} detectors "
            f"in {seconds:.1f} s: {taken} taken in, {dropped} dropped and counted, {lost} merged or left in the "
            f"middleware; at most {waiting} waited, empty after {empty_s:.1f} s; {before_mb:.0f} MB before, "
            f"{after_mb:.0f} MB after; the next image answered after {answer_s:.1f} s, that behind it after "
            f"{1e3 * calm_s:.0f} ms"
        )
    assert taken > 0 and waiting <= QUEUE
    assert after_mb < before_mb + LEAST_GROWTH_MB
    assert calm_s < 5.0
