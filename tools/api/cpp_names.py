# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Names and signatures of the public C++ headers, one line each, from the XML of doxygen."""

import re
import subprocess
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

SETTINGS = """
INPUT = {include}
RECURSIVE = YES
FILE_PATTERNS = *.hpp
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
OUTPUT_DIRECTORY = {out}
EXTRACT_ALL = YES
EXTRACT_STATIC = YES
EXCLUDE_SYMBOLS = posemix::internal posemix::internal::* posemix::detail posemix::*::detail
BUILTIN_STL_SUPPORT = YES
MACRO_EXPANSION = YES
QUIET = YES
WARNINGS = NO
WARN_IF_DOC_ERROR = NO
WARN_IF_UNDOCUMENTED = NO
HAVE_DOT = NO
"""
# Of a member: what stands before its name.
KINDS = {"function": "", "typedef": "using ", "variable": "", "enum": "enum ", "friend": "friend ", "define": "#define "}


def text_of(element, tag):
    found = element.find(tag)
    return " ".join("".join(found.itertext()).split()) if found is not None else ""


def template_of(element):
    parameters = element.find("templateparamlist")
    if parameters is None:
        return ""
    words = []
    for parameter in parameters:
        kind, name, value = (text_of(parameter, tag) for tag in ("type", "declname", "defval"))
        words.append(" ".join(filter(None, [kind, name])) + (f" = {value}" if value else ""))
    return f"template <{', '.join(words)}> "


def member_lines(member, scope):
    """A function with all that callers write, a variable with its type; an enum with its values."""
    kind = member.get("kind")
    name = f"{scope}::{text_of(member, 'name')}" if scope else text_of(member, "name")
    if kind == "enum":
        yield f"enum {name}"
        for value in member.findall("enumvalue"):
            yield f"enum {name}::{text_of(value, 'name')}"
        return
    if kind not in KINDS:
        return
    returned = text_of(member, "type")
    arguments = text_of(member, "argsstring") if kind == "function" else ""
    static = "static " if member.get("static") == "yes" and kind in ("function", "variable") else ""
    line = f"{template_of(member)}{static}{KINDS[kind]}{returned + ' ' if returned else ''}{name}{arguments}"
    # A body that a header has, as `=default`, is nothing that callers see.
    yield re.sub(r"\s*=\s*(default|0)$", "", line)


def compound_lines(compound):
    kind, name = compound.get("kind"), text_of(compound, "compoundname")
    scope = name if kind in ("class", "struct", "namespace", "union") else ""
    if kind in ("class", "struct", "union", "concept"):
        bases = ", ".join(sorted("".join(base.itertext()) for base in compound.findall("basecompoundref")
                                 if base.get("prot") == "public"))
        yield f"{template_of(compound)}{kind} {name}{' : ' + bases if bases else ''}"
    if kind == "file":
        yield f'#include "{header_of(compound)}"'
    for member in compound.iter("memberdef"):
        is_visible = member.get("prot") == "public" and not text_of(member, "name").startswith("@")
        # What belongs to a namespace stands in its file, too.
        is_macro = member.get("kind") == "define" and "/testing/" in header_of(compound)  # others are the library's own
        if is_visible and (scope or is_macro):
            yield from member_lines(member, scope)


def header_of(compound):
    path = compound.find("location").get("file")
    return path[path.rindex("posemix/"):]


def public_names(include):
    with tempfile.TemporaryDirectory() as out:
        settings = SETTINGS.format(include=Path(include).resolve(), out=out)
        subprocess.run(["doxygen", "-"], input=settings, text=True, check=True, capture_output=True)
        for path in sorted(Path(out, "xml").glob("*.xml")):
            for compound in ElementTree.parse(path).getroot().iter("compounddef"):
                name = text_of(compound, "compoundname")
                if compound.get("prot", "public") == "public" and not re.search(r"\b(internal|detail)\b|@", name):
                    yield from compound_lines(compound)
