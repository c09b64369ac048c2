#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Tests of `posemix completion` and `posemix manual`: what the shells make of the scripts, and groff of the pages.

The program is $POSEMIX_PROGRAM. Shells that are not installed are skipped."""

import os
import pty
import re
import select
import shutil
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

PROGRAM = os.environ["POSEMIX_PROGRAM"]
WAIT_S = 30  # for an interactive shell on a busy machine

# What is on the command line, and what may come next. The folder has configs/demo.toml and models.json.
CASES = {
    "posemix sl": {"slam"},
    "posemix data f": {"fetch"},
    "posemix slam --smooth": {"--smooth", "--smooth-lag"},
    "posemix data fetch --re": {"--retries", "--registry"},
    "posemix reduce --merge mo": {"moment_matched"},
    "posemix --quiet reduce --merge mo": {"moment_matched"},  # an option that is none does no harm
    "posemix completion z": {"zsh"},
    "posemix slam configs/d": {"configs/demo.toml"},
    "posemix fit models.json --format t": {"tum"},
    "posemix slam --out c": {"configs"},
    "posemix slam --out m": set(),  # a file is no folder
    "posemix reduce --seed s": set(),
    "posemix data fetch m": set(),  # no file is the name of a source
}


def run(*command: str, **settings: object) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True, **settings).stdout


class Completion(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "configs").mkdir()
        (self.folder / "configs" / "demo.toml").touch()
        (self.folder / "models.json").touch()

    def script(self, shell):
        path = self.folder / "script"
        path.write_text(run(PROGRAM, "completion", shell))
        return path

    def check(self, complete):
        for line, expected in CASES.items():
            with self.subTest(line=line):
                self.assertEqual({answer.rstrip("/") for answer in complete(line)}, expected)

    def test_bash(self):
        script = self.script("bash")

        def complete(line):
            words = line.split(" ")
            ask = f'. {script}; COMP_WORDS=("$@"); COMP_CWORD={len(words) - 1}; _posemix; printf "%s\\n" "${{COMPREPLY[@]}}"'
            return run("bash", "-c", ask, "bash", *words, cwd=self.folder).split()

        self.check(complete)
        # To bash the equals sign is a word.
        self.assertEqual(complete("posemix reduce --merge = mi"), ["midway"])
        self.assertIn("midway", complete("posemix reduce --merge ="))

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_fish(self):
        script = self.script("fish")
        home = dict(os.environ, HOME=str(self.folder), XDG_CONFIG_HOME=str(self.folder / ".config"))

        def complete(line):
            ask = f"source {script}; complete -C '{line}'"
            answers = run("fish", "--no-config", "-c", ask, cwd=self.folder, env=home).splitlines()
            return [answer.split("\t")[0] for answer in answers]

        self.check(complete)

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh(self):
        """Zsh completes only where somebody types: it gets a terminal, and completes what is the only answer."""
        (self.folder / "functions").mkdir()
        self.script("zsh").rename(self.folder / "functions" / "_posemix")
        shell = Terminal(["zsh", "-f", "-i"], self.folder)
        self.addCleanup(shell.close)
        shell.send("PS1='> '; unsetopt beep; fpath=($PWD/functions $fpath); autoload -U compinit; compinit -u -D; "
                   "rehash; posemix() { :; }; echo re''ady\n")
        shell.expect(r"ready\r")
        for line, expected in CASES.items():
            if len(expected) == 1 and "--quiet" not in line:  # after an unknown option zsh completes nothing
                with self.subTest(line=line):
                    shell.send(f"\x15{line}\t")
                    shell.expect(re.escape(line[: line.rfind(" ") + 1] + next(iter(expected))))

    def test_every_command_is_in_every_script_and_has_a_page(self):
        run(PROGRAM, "manual", "--out", "man", cwd=self.folder)
        pages = {page.name for page in (self.folder / "man").iterdir()}
        scripts = {shell: run(PROGRAM, "completion", shell) for shell in ("bash", "zsh", "fish")}
        listed = self.commands_of("posemix")
        self.assertGreater(len(listed), 20)
        for command in listed:
            self.assertIn(command.replace(" ", "-") + ".1", pages)
            self.assertIn(f"'{command}'", scripts["bash"])
            self.assertIn(f"'{command}'", scripts["fish"])
            self.assertIn("_" + command.replace(" ", "_") + "()", scripts["zsh"])
        self.assertEqual(len(pages), len(listed) + 1)

    def commands_of(self, command):
        """The commands that the help lists, and those below them."""
        text = run(PROGRAM, *command.split()[1:], "--help").partition("\nSubcommands:\n")[2].partition("\n\n")[0]
        found = [f"{command} {line.split()[0]}" for line in text.splitlines() if re.match("  [a-z]", line)]
        return found + [below for name in found for below in self.commands_of(name)]

    def test_options_of_the_help_are_in_the_page(self):
        run(PROGRAM, "manual", "--out", "man", cwd=self.folder)
        for command in ("posemix slam", "posemix grasp", "posemix data fetch"):
            page = (self.folder / "man" / (command.replace(" ", "-") + ".1")).read_text().replace("\\-", "-")
            text = run(PROGRAM, *command.split()[1:], "--help")
            options = re.findall(r"^ +(?:-\w,)?(--[\w-]+)", text, re.MULTILINE)
            self.assertGreater(len(options), 5)
            for option in options:
                self.assertIn(f"\\fB{option}\\fR", page)

    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    def test_groff_has_no_complaints(self):
        run(PROGRAM, "manual", "--out", "man", cwd=self.folder)
        for page in sorted((self.folder / "man").iterdir()):
            result = subprocess.run(["groff", "-ww", "-man", "-Tutf8", "-P-cbou", str(page)], capture_output=True, text=True)
            self.assertEqual((result.returncode, result.stderr), (0, ""), page.name)
            self.assertIn("SYNOPSIS", result.stdout)


class Terminal:
    """A program with a terminal, which gets what is typed."""

    def __init__(self, command, folder):
        self.seen = ""
        self.process, self.file = pty.fork()
        if self.process == 0:
            os.chdir(folder)
            environment = dict(os.environ, TERM="dumb", HOME=str(folder), ZDOTDIR=str(folder))
            os.execvpe(command[0], command, environment)

    def send(self, text):
        self.seen = ""
        os.write(self.file, text.encode())

    def expect(self, pattern):
        end = time.monotonic() + WAIT_S
        while not re.search(pattern, self.seen):
            if time.monotonic() > end or not select.select([self.file], [], [], end - time.monotonic())[0]:
                raise AssertionError(f"expected {pattern!r}, got {self.seen!r}")
            self.seen += os.read(self.file, 4096).decode(errors="replace")

    def close(self):
        os.close(self.file)
        os.waitpid(self.process, 0)


if __name__ == "__main__":
    unittest.main()
