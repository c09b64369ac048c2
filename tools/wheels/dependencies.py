# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The libraries in the wheels, from Debian's packages: sources of those that are compiled, headers of the others.

They are linked statically, so that a wheel brings no shared library along. apt checks the signatures of what it fetches.
"""

import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path

from toolchain import fail, run, say

# Libraries that take no time worth telling in what posemix does are compiled for size.
SMALL = {f"CMAKE_{language}_FLAGS_RELEASE": "-Oz -DNDEBUG" for language in ("C", "CXX")}


@dataclass
class Library:
    """One library, with what an SBOM says of it."""

    name: str
    package: str  # of Debian: a source package, or one with headers
    licence: str  # SPDX
    options: dict = field(default_factory=dict)  # of its CMake project; without any it is built by configure and make
    kind: str = "source"  # or "all", headers that are not compiled
    headers: tuple = ()  # of its source, which its project does not install with these options
    version: str = ""
    notice: Path = Path()  # Debian's file with copyright and licences
    licence_alone: bool = False  # of the notice the text of the licence is enough

    def notice_text(self):
        """What goes into the wheel of the notice."""
        if not self.licence_alone:
            return self.notice.read_bytes()
        found = re.findall(rf"^License: {re.escape(self.licence)}\n(?: .*\n)+", self.notice.read_text(), re.MULTILINE)
        if not found:
            fail(f"{self.notice}: has no text of the licence {self.licence}")
        return max(found, key=len).encode()


def compiled():
    return [
        Library("fmt", "fmtlib", "MIT", {"FMT_TEST": "OFF", "FMT_DOC": "OFF", **SMALL}),
        Library("nlopt", "nlopt", "LGPL-2.1-or-later", {
            **SMALL, **{f"NLOPT_{part}": "OFF" for part in ("CXX", "PYTHON", "OCTAVE", "MATLAB", "GUILE", "SWIG", "TESTS")}}),
        Library("highway", "highway", "Apache-2.0", {
            "BUILD_TESTING": "OFF", **{f"HWY_ENABLE_{part}": "OFF" for part in ("CONTRIB", "TESTS", "EXAMPLES")}},
            # Of its sorting, which takes long to compile, nothing is used.
            headers=("hwy/contrib/math/math-inl.h",)),
        Library("yaml-cpp", "yaml-cpp", "MIT", {
            **SMALL, "YAML_BUILD_SHARED_LIBS": "OFF", **{f"YAML_CPP_BUILD_{part}": "OFF" for part in ("TESTS", "TOOLS", "CONTRIB")}}),
        Library("zlib", "zlib", "Zlib"),
    ]


def headers():
    return [
        Library("eigen", "libeigen3-dev", "MPL-2.0", kind="all"),
        # Headers of Math, Graph and Random alone are used. Debian's notice, of 2 MB, is of all of Boost, and the licence asks for
        # none in compiled code.
        Library("boost", "libboost1.74-dev", "BSL-1.0", kind="all", licence_alone=True),
        Library("tomlplusplus", "libtomlplusplus-dev", "MIT", kind="all"),
        Library("nlohmann-json", "nlohmann-json3-dev", "MIT", kind="all"),
        Library("cli11", "libcli11-dev", "BSD-3-Clause", kind="all"),
        Library("random123", "librandom123-dev", "BSD-3-Clause", kind="all"),
    ]


class Packages:
    """What apt fetches, once."""

    def __init__(self, work):
        self.work = work / "packages"
        self.lists = self.work / "lists"
        self.log = self.work / "apt.log"
        if not shutil.which("apt-get"):
            fail("the libraries in the wheels are from Debian's packages: apt-get was not found")

    def update(self):
        """An index of sources too, which few machines have; nothing of the machine changes."""
        if self.work.exists():
            return
        (self.lists / "partial").mkdir(parents=True)
        found = Path("/etc/os-release").read_text()
        release = re.search(r"^VERSION_CODENAME=(\w+)", found, re.MULTILINE)
        key = "/usr/share/keyrings/debian-archive-keyring.gpg"
        (self.work / "debian.sources").write_text(
            f"Types: deb deb-src\nURIs: http://deb.debian.org/debian\nSuites: {release[1] if release else 'stable'}\n"
            f"Components: main\nSigned-By: {key}\n")
        self.apt("update")

    def apt(self, *command, **options):
        run("apt-get", "-q", "-o", f"Dir::Etc::sourcelist={self.work}/debian.sources", "-o", "Dir::Etc::sourceparts=/dev/null",
            "-o", f"Dir::State::lists={self.lists}", "-o", "Dir::Cache::pkgcache=", "-o", "Dir::Cache::srcpkgcache=",
            "-o", "APT::Sandbox::User=root", *command, log=self.log, **options)

    def source(self, library):
        """Folder of the source of a library; sets version and notice."""
        folder = self.work / "sources" / library.package
        if not folder.exists():
            part = folder.with_suffix(".part")
            shutil.rmtree(part, ignore_errors=True)
            part.mkdir(parents=True)
            self.apt("--download-only", "source", library.package, cwd=part)
            run("dpkg-source", "--no-check", "-x", *part.glob("*.dsc"), part / "source", log=self.log)
            part.rename(folder)
        described = next(folder.glob("*.dsc")).read_text()
        library.version = re.search(r"^Version: (\S+)", described, re.MULTILINE)[1]
        library.notice = folder / "source/debian/copyright"
        return folder / "source"

    def header(self, library):
        """Folder usr of a package of headers; sets version and notice."""
        folder = self.work / "headers" / library.package
        if not folder.exists():
            part = folder.with_suffix(".part")
            shutil.rmtree(part, ignore_errors=True)
            part.mkdir(parents=True)
            self.apt("download", library.package, cwd=part)
            run("dpkg-deb", "--extract", *part.glob("*.deb"), part, log=self.log)
            part.rename(folder)
        library.version = next(folder.glob("*.deb")).name.split("_")[1].replace("%3a", ":")
        library.notice = folder / "usr/share/doc" / library.package / "copyright"
        return folder / "usr"


TOMLPLUSPLUS = """add_library(tomlplusplus::tomlplusplus INTERFACE IMPORTED)
set_target_properties(tomlplusplus::tomlplusplus PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "{include}")
set(tomlplusplus_FOUND TRUE)
"""


def header_definitions(packages, toolchain, libraries):
    """Where CMake finds the headers: by the packages' own files, but for one that names a shared library."""
    folders = {library.name: packages.header(library) for library in libraries}
    toml = toolchain.work / "tomlplusplus"
    toml.mkdir(exist_ok=True)
    (toml / "tomlplusplusConfig.cmake").write_text(TOMLPLUSPLUS.format(include=folders["tomlplusplus"] / "include"))
    (toml / "tomlplusplusConfigVersion.cmake").write_text(
        "set(PACKAGE_VERSION 3.3.0)\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n")
    boost = next(folders["boost"].glob("lib/*/cmake/Boost-*"))
    return {"Eigen3_DIR": folders["eigen"] / "share/eigen3/cmake", "Boost_DIR": boost, "tomlplusplus_DIR": toml,
            "nlohmann_json_DIR": folders["nlohmann-json"] / "share/cmake/nlohmann_json",
            "CLI11_DIR": folders["cli11"] / "share/cmake/CLI11",
            "RANDOM123_INCLUDE_DIR": folders["random123"] / "include"}


def build_dependencies(work, toolchain):
    """Compile the libraries; returns their descriptions, and where CMake finds the headers."""
    packages = Packages(work)
    packages.update()
    libraries = compiled()
    for library in libraries:
        source = packages.source(library)
        done = toolchain.work / f"{library.name}.done"
        made = f"{library.version} {library.options}"
        if done.exists() and done.read_text() == made:
            continue
        say(f"{library.name} {library.version} for {toolchain.machine}")
        if library.options:
            toolchain.cmake(source, toolchain.work / library.name, library.options)
        else:
            toolchain.configure(source, toolchain.work / library.name)
        for header in library.headers:
            installed = toolchain.prefix / "include" / header
            installed.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source / header, installed)
        done.write_text(made)
    only_headers = headers()
    found = header_definitions(packages, toolchain, only_headers)
    return [*libraries, *only_headers], found
