# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Settings of the documentation's pages: run by `make docs`, after Doxygen and with the package installed."""

import inspect
from importlib import import_module, util
from importlib.metadata import version as version_of
from pathlib import Path
from xml.etree import ElementTree

import posemix

ROOT = Path(__file__).resolve().parent.parent
GENERATED = Path(__file__).resolve().parent / "_api"  # ignored by git
ROOMS = {
    "base": "Errors, random numbers, small linear algebra",
    "lie": "Groups",
    "density": "Densities with one peak",
    "mixture": "Mixtures and EM",
    "divergence": "Divergences",
    "reduction": "Merging and reduction",
    "detector": "How detectors err",
    "filter": "Filters",
    "slam": "Object SLAM",
    "grasp": "Grasps",
    "io": "Files",
    "fiducial": "Square tags",
    "config": "Settings from files",
    "draw": "Drawings",
    "results": "Results and reports",
    "testing": "Tools for tests",
}
# All but the namespaces, which every header opens anew.
SECTIONS = "briefdescription detaileddescription innerclass define enum typedef func var public-* friend related"

project = "posemix"
author = "posemix contributors"
copyright = "posemix contributors"
release = version_of("posemix")
extensions = [
    "myst_parser",
    "breathe",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx.ext.viewcode",
]
html_theme = "furo"
html_title = f"posemix {release}"
# MathJax lies beside the pages: they show equations without a network.
html_static_path = [f"{util.find_spec('sphinx-mathjax-offline').submodule_search_locations[0]}/static"]
mathjax_path = "mathjax/tex-chtml.js"
exclude_patterns = ["_build"]
myst_heading_anchors = 4
myst_enable_extensions = ["dollarmath", "colon_fence", "html_image"]
# Settings share names of attributes; headers open the same namespaces.
suppress_warnings = ["myst.header", "myst.xref_missing", "duplicate_declaration.cpp", "ref.python"]
autodoc_typehints = "none"
numpydoc_show_class_members = False
breathe_projects = {"posemix": str(ROOT / "build" / "docs" / "xml")}
breathe_default_project = "posemix"
breathe_show_include = True


def name_headers_by_path() -> None:
    """Doxygen's index names a file without its folder, and Breathe finds it by that name alone."""
    xml = ROOT / "build" / "docs" / "xml"
    index = ElementTree.parse(xml / "index.xml")
    for compound in index.getroot().iterfind("compound[@kind='file']"):
        location = ElementTree.parse(xml / f"{compound.get('refid')}.xml").find("compounddef/location")
        name = compound.find("name")
        if location is not None and name is not None:
            name.text = location.get("file")
    index.write(xml / "index.xml", encoding="utf-8", xml_declaration=True)


def write_cpp_pages() -> None:
    """One page of the C++ reference per room, all of its headers in it."""
    pages = []
    for room, title in ROOMS.items():
        lines = [*heading(f"{title} (``{room}``)", "="), ""]
        for header in sorted((ROOT / "include" / "posemix" / room).glob("*.hpp")):
            name = header.relative_to(ROOT / "include")
            lines += [*heading(f"``{name}``", "-"), "", f".. doxygenfile:: include/{name}", f"   :sections: {SECTIONS}", ""]
        write(GENERATED / "cpp" / f"{room}.rst", lines)
        pages.append(f"cpp/{room}")
    write(GENERATED / "cpp.md", ["# C++ reference", "", *toctree(pages)])


def write_python_pages() -> None:
    """One page of the Python reference per module."""
    pages = []
    bound: set[str] = set()  # classes of the extension that a page has: several modules may export one
    folder = Path(posemix.__file__).parent
    for path in sorted([*folder.glob("*.py"), *folder.glob("*/__init__.py"), *folder.glob("interop/[a-z]*.py")]):
        name = path.parent.name if path.name == "__init__.py" else path.stem
        if path.parent.name == "interop" and path.name != "__init__.py":
            name = f"interop.{path.stem}"
        if name.startswith("_") or path == folder / "__init__.py":
            continue
        title = f"# posemix.{name}"
        exported = vars(import_module(f"posemix.{name}"))
        here = {n for n, value in exported.items() if getattr(value, "__module__", "") == "posemix._core"}
        again = [f"   :exclude-members: {', '.join(sorted(here & bound))}"] if here & bound else []
        bound |= here
        block = ["```{eval-rst}", f".. automodule:: posemix.{name}", "   :members:", *again, "```", ""]
        write(GENERATED / "python" / f"{name}.md", [title, "", *block])
        pages.append(f"python/{name}")
    settings = ["# Settings, results and enumerations", "", "```{eval-rst}"]
    for name, value in sorted(vars(posemix).items()):
        if inspect.isclass(value) and value.__module__ == "posemix._core":
            text = value.__doc__ or ""
            others = [n for n in vars(value) if not n.startswith("_") and f"\n{n} : " not in text]
            members = [f"   :members: {', '.join(others)}"] if others else []
            settings += [f".. autoclass:: posemix.{name}", "   :no-index:", *members, ""]
    write(GENERATED / "python" / "settings.md", [*settings, "```"])
    write(GENERATED / "python.md", ["# Python reference", "", *toctree([*pages, "python/settings"])])


def heading(text: str, line: str) -> list[str]:
    """A heading in reStructuredText, in which Breathe's pages are."""
    return [text, line * len(text)]


def toctree(pages: list[str]) -> list[str]:
    """The lines of a table of contents."""
    return ["```{toctree}", ":maxdepth: 1", *pages, "```"]


def write(path: Path, lines: list[str]) -> None:
    """Writes where the content has changed, so that unchanged pages are not built again."""
    text = "\n".join(lines) + "\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


name_headers_by_path()
write_cpp_pages()
write_python_pages()
