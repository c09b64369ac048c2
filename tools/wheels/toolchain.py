# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The compiler of the wheels: clang, libc++ and glibc's oldest supported version, from the PyPI package ziglang."""

import os
import platform
import shlex
import shutil
import subprocess
import sys
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
GLIBC = "2.28"  # of RHEL 8, Debian 10, Ubuntu 18.10 and everything later
COMMANDS = {"cc": "cc -target {target}", "c++": "c++ -target {target}", "ar": "ar", "ranlib": "ranlib"}

# A shared library is linked again with identical functions once, where their addresses do not count: its linker can do that,
# and `zig c++` has no option for it. The command is told on a line that starts with the linker's name.
FOLD = """
case " $* " in
  *" -shared "*)
    lines=$(ZIG_VERBOSE_LINK=1 "$zig" c++ -target {target} "$@" 2>&1) || {{ echo "$lines" >&2; exit 1; }}
    link=$(echo "$lines" | grep "^ld\\.lld ") || {{ echo "expected the command of the linker, got: $lines" >&2; exit 1; }}
    exec "$zig" $link --icf=safe
    ;;
esac
"""


def say(text):
    print(f"wheels: {text}", flush=True)


def fail(text):
    sys.exit(f"wheels: {text}")


def run(*command, log=None, **options):
    """Run a command; its output goes to a file, whose end is shown when the command fails."""
    command = [str(part) for part in command]
    if log is None:
        return subprocess.run(command, check=True, **options)
    with open(log, "a") as out:
        print("$", shlex.join(command), file=out, flush=True)
        status = subprocess.run(command, stdout=out, stderr=subprocess.STDOUT, **options).returncode
    if status != 0:
        lines = Path(log).read_text(errors="replace").splitlines()
        fail("\n".join([f"{shlex.join(command)} failed with {status}; the end of {log}:", *lines[-40:]]))
    return None


def tools_environment(work):
    """A virtual environment with the compiler and what repairs and checks wheels, of pinned versions."""
    folder = work / "tools"
    requirements = HERE / "requirements.txt"
    stamp = folder / "requirements.txt"
    if not (stamp.exists() and stamp.read_text() == requirements.read_text()):
        say("the compiler and the tools, from PyPI")
        venv.create(folder, with_pip=True, clear=True)
        run(folder / "bin/pip", "install", "--quiet", "--disable-pip-version-check", "-r", requirements)
        stamp.write_text(requirements.read_text())
    sys.path.extend(str(path) for path in (folder / "lib").glob("python3*/site-packages"))  # Zopfli's
    return folder


class Toolchain:
    """What compiles for one machine, as CMake and other builds are told of it."""

    def __init__(self, work, tools, machine):
        self.machine = machine
        self.tools = tools
        self.work = work / machine
        self.prefix = self.work / "prefix"
        self.work.mkdir(parents=True, exist_ok=True)
        self.zig = next((tools / "lib").glob("python3*/site-packages/ziglang/zig"))
        self.commands = self.work / "bin"
        self.commands.mkdir(exist_ok=True)
        self.target = f"{machine}-linux-gnu.{GLIBC}"
        for name, words in COMMANDS.items():
            script = self.commands / name
            text = "#!/bin/sh\n" + (FOLD if name == "c++" else "") + 'exec "$zig" ' + words + ' "$@"\n'
            text = text.replace('"$zig"', shlex.quote(str(self.zig))).format(target=self.target)
            if not script.exists() or script.read_text() != text:
                script.write_text(text)
                script.chmod(0o755)

    @property
    def environment(self):
        # Paths of this machine shall not be in the wheels, wherever they are built.
        flags = " ".join(f"-ffile-prefix-map={path}={name}" for path, name in
                         ((self.work.parent, "build"), (SOURCE, "posemix")))
        return {**os.environ, "POSEMIX_WHEEL_COMMANDS": str(self.commands),
                "CFLAGS": flags, "CXXFLAGS": flags, "SOURCE_DATE_EPOCH": str(source_time())}

    @property
    def foreign(self):
        """Whether programs for that machine do not run on this one."""
        return self.machine != platform.machine()

    @property
    def definitions(self):
        """What every CMake project of the wheels is configured with."""
        cross = {"CMAKE_SYSTEM_NAME": "Linux", "CMAKE_SYSTEM_PROCESSOR": self.machine} if self.foreign else {}
        return {**cross, "CMAKE_TOOLCHAIN_FILE": HERE / "zig.cmake", "CMAKE_BUILD_TYPE": "Release",
                "CMAKE_C_FLAGS_RELEASE": "-O2 -DNDEBUG", "CMAKE_CXX_FLAGS_RELEASE": "-O2 -DNDEBUG",
                "CMAKE_PREFIX_PATH": self.prefix, "CMAKE_POSITION_INDEPENDENT_CODE": "ON", "BUILD_SHARED_LIBS": "OFF",
                "CMAKE_DISABLE_PRECOMPILE_HEADERS": "ON",  # which zig cannot write
                "CMAKE_INSTALL_PREFIX": self.prefix, "CMAKE_INSTALL_LIBDIR": "lib"}

    def cmake(self, source, folder, definitions, targets=(), install=()):
        """Configure, build and install a project into the prefix."""
        log = self.work / f"{folder.name}.log"
        log.unlink(missing_ok=True)
        settings = [f"-D{name}={value}" for name, value in {**self.definitions, **definitions}.items()]
        run("cmake", "-G", "Ninja", "-S", source, "-B", folder, *settings, log=log, env=self.environment)
        chosen = ["--target", *targets] if targets else []
        run("cmake", "--build", folder, *chosen, "--", "-k", "0", log=log, env=self.environment)
        run("cmake", "--install", folder, *install, log=log, env=self.environment)

    def configure(self, source, folder):
        """The same for a project with a configure script: its static library."""
        log = self.work / f"{folder.name}.log"
        log.unlink(missing_ok=True)
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(source, folder)
        tools = {"CC": self.commands / "cc", "AR": self.commands / "ar", "RANLIB": self.commands / "ranlib"}
        environment = {**self.environment, **{name: str(path) for name, path in tools.items()}}
        environment["CFLAGS"] += " -O2 -fPIC -ffunction-sections"
        run("./configure", "--static", f"--prefix={self.prefix}", log=log, env=environment, cwd=folder)
        run("make", "install", log=log, env=environment, cwd=folder)


def source_time():
    """The time of the last commit, which all files in the wheels have; that of the changelog without git."""
    found = subprocess.run(["git", "log", "-1", "--format=%ct"], cwd=SOURCE, capture_output=True, text=True)
    return int(found.stdout) if found.returncode == 0 else int((SOURCE / "CHANGELOG.md").stat().st_mtime)
