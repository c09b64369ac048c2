# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""`posemix live`, the program, as a process beside a partner that is of ROS 2."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from .live import Live, values_of

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = Path(os.environ.get("POSEMIX_PROGRAM", ROOT / "build" / "release" / "posemix"))
# Of the tests' own: nothing is lost, the diagnostics come soon.
CONFIG: Mapping[str, Any] = {
    "live.diagnostics_hz": 20, "live.input_depth": 1000, "live.least_existence": 0,
}  # fmt: skip
SOURCE = '[[sources]]\nname = "detections"\nreliability = "reliable"\n'


def environment(domain: int | str) -> dict[str, str]:
    """The environment of the program: without the libraries of the wheels, and over the loopback device."""
    kept = {name: value for name, value in os.environ.items() if name != "LD_LIBRARY_PATH"}
    return {**kept, "ROS_DOMAIN_ID": str(domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}


@cache
def unavailable() -> str:
    """Why there is no program with Cyclone DDS; empty where there is."""
    if not PROGRAM.exists():
        return f"{PROGRAM.name} is not built"
    # It looks at the domain when it would join it.
    done = subprocess.run(
        [PROGRAM, "live", "--quiet"], env=environment("none"), capture_output=True, text=True, timeout=30
    )
    return "" if "ROS_DOMAIN_ID" in done.stderr else done.stderr.strip()


class Program:
    """`posemix live` with a partner, which it hears and which hears it."""

    def __init__(self, folder: Path, domain: int, text: str = SOURCE, **options: Any) -> None:
        self.name = options.pop("name", "posemix")
        settings = {**CONFIG, "live.name": self.name, **options.pop("settings", {})}
        arguments = options.pop("arguments", [])
        config = folder / f"{self.name}.toml"
        config.write_text("schema = 1\n" + text)
        texts = {k: str(v).lower() if isinstance(v, bool) else str(v) for k, v in settings.items()}
        words = [word for key, text in texts.items() for word in ("--set", f"{key}={text}")]
        self.process = subprocess.Popen(
            [PROGRAM, "live", config, *words, *arguments], env=environment(domain), stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True,
        )  # fmt: skip
        self.world: Live = options.pop("world", None) or Live(node=False, **options)

    def ready(self, publishers: int = 0) -> Program:
        """Waits until the program and its partner hear each other."""
        self.until("publishers", publishers or len(self.world._detectors) + 2)
        self.world.meet_program()
        return self

    def values(self) -> dict[str, str]:
        """The values of the program's own status, from now on."""
        name = f"{self.name}: node"
        self.world.diagnostics.clear()
        found = self.world.until(
            lambda: [s for m in self.world.diagnostics for s in m.status if s.name == name], "a status", 20.0
        )
        return values_of(found[-1])

    def until(self, key: str, count: int) -> dict[str, str]:
        """Waits until a count of the program is reached."""
        end = time.monotonic() + 15.0
        while True:
            values = self.values()
            if int(values[key]) >= count:
                return values
            assert time.monotonic() < end, f"{key} is not {count}: {values}"

    def stop(self, number: int = signal.SIGINT) -> tuple[float, str]:
        """Ends the program; how long that took [s], and what it has printed."""
        begin = time.monotonic()
        self.process.send_signal(number)
        text, _ = self.process.communicate(timeout=20)
        seconds = time.monotonic() - begin
        heard = self.world._detectors.values()
        self.world.until(lambda: not any(p.get_subscription_count() for p in heard), "it is gone")
        return seconds, text

    def close(self) -> None:
        self.process.terminate()
        try:
            self.process.communicate(timeout=10)
        finally:
            self.process.kill()
            self.world.close()
