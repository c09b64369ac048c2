# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The Pythons of this machine that wheels are built with, and what of them holds for another machine."""

import re
import shutil
import subprocess
from pathlib import Path

from toolchain import fail, run

VERSIONS = ("3.10", "3.11", "3.12")  # the last one stands for all later ones


def find_python(*versions):
    """An interpreter of one of the versions."""
    for candidate in versions:
        folders = sorted(Path.home().glob(f".pyenv/versions/{candidate}.*/bin/python{candidate}"))
        for path in [shutil.which(f"python{candidate}"), *folders]:
            check = [path, "-c", f"import sys, venv; assert '%d.%d' % sys.version_info[:2] == '{candidate}'"]
            if path and subprocess.run(check, capture_output=True).returncode == 0:
                return Path(path)
    return None


def find_pythons(versions):
    """The interpreter of each version, or None."""
    later = [f"3.{minor}" for minor in range(12, 16)]
    return {version: find_python(*(later if version == VERSIONS[-1] else [version])) for version in versions}


def stated(python, expression):
    """What an interpreter says."""
    return subprocess.run([python, "-c", f"import sys, sysconfig; print({expression})"],
                          capture_output=True, text=True, check=True).stdout.strip()


def version_of(python):
    return stated(python, "'%d.%d' % sys.version_info[:2]")


def c_type(name):
    """The type in C whose size pyconfig.h states as SIZEOF_name or ALIGNOF_name."""
    words = {"VOID_P": "void *", "_BOOL": "_Bool"}
    return words.get(name) or (name.lower() if name.endswith("_T") else name.lower().replace("_", " "))


def check_headers(python, toolchain):
    """The headers of this machine's Python hold for the other one.

    They are the same files on all machines but for pyconfig.h. Debian's of amd64 and arm64 differ in HAVE_GCC_ASM_FOR_X64,
    HAVE_GCC_ASM_FOR_X87, HAVE_USABLE_WCHAR_T and PY_SUPPORT_TIER (3.13), none of which concerns a module; sizes could, and the
    compiler compares them.
    """
    include = Path(stated(python, "sysconfig.get_path('include')"))
    text = Path(stated(python, "sysconfig.get_config_h_filename()")).read_text()
    sizes = re.findall(r"^#define (SIZEOF|ALIGNOF)_(\w+) (\d+)$", text, re.MULTILINE)
    if not sizes:
        fail(f"{include}: got no sizes of types in pyconfig.h")
    lines = ["#include <stdio.h>", "#include <stddef.h>", "#include <stdint.h>", "#include <sys/types.h>", "#include <time.h>",
             "#include <wchar.h>", "#include <pthread.h>"]
    for kind, name, size in sizes:
        operator = {"SIZEOF": "sizeof", "ALIGNOF": "_Alignof"}[kind]
        lines.append(f'_Static_assert({operator}({c_type(name)}) == {size}, "{kind}_{name} of pyconfig.h");')
    big = "BIG" if re.search(r"^#define WORDS_BIGENDIAN 1", text, re.MULTILINE) else "LITTLE"
    lines.append(f'_Static_assert(__BYTE_ORDER__ == __ORDER_{big}_ENDIAN__, "the order of bytes of pyconfig.h");')
    source = toolchain.work / f"python{version_of(python)}-sizes.c"
    source.write_text("\n".join(lines) + "\n")
    log = source.with_suffix(".log")
    log.unlink(missing_ok=True)
    run(toolchain.commands / "cc", "-c", "-o", source.with_suffix(".o"), source, log=log)


def foreign_environment(python, toolchain):
    """What the build of a wheel is told instead of what this machine's Python says of itself."""
    suffix = stated(python, "sysconfig.get_config_var('EXT_SUFFIX')")
    here = stated(python, "sysconfig.get_platform()").removeprefix("linux-")
    if f"-{here}-" not in suffix:
        fail(f"{python}: got the suffix {suffix} of modules, expected {here} in it")
    return {"_PYTHON_HOST_PLATFORM": f"linux-{toolchain.machine}",
            "SETUPTOOLS_EXT_SUFFIX": suffix.replace(f"-{here}-", f"-{toolchain.machine}-")}
