# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Places of C++ sources at which a mutant can be put, found by clang's syntax tree."""

import dataclasses
import itertools
from pathlib import Path

from clang import cindex
from clang.cindex import CursorKind, TypeKind

SWAPPED = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&", "+": "-", "-": "+",
    "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=",
}  # fmt: skip
FUNCTIONS = {
    CursorKind.FUNCTION_DECL, CursorKind.CXX_METHOD, CursorKind.CONSTRUCTOR, CursorKind.FUNCTION_TEMPLATE,
    CursorKind.CONVERSION_FUNCTION, CursorKind.DESTRUCTOR,
}  # fmt: skip
# What is said of an error is tested by its own tests; constants are no code that runs.
LEFT_OUT = {CursorKind.CXX_THROW_EXPR, CursorKind.STATIC_ASSERT, CursorKind.CASE_STMT}
DECISIONS = {CursorKind.IF_STMT, CursorKind.WHILE_STMT}


@dataclasses.dataclass(frozen=True)
class Site:
    path: Path
    line: int
    start: int
    end: int
    kind: str
    before: str
    # With {k} for the number of the mutant.
    after: str
    change: str

    def overlaps(self, other):
        return self.path == other.path and self.start < other.end and other.start < self.end


def is_arithmetic(cursor):
    kind = cursor.type.get_canonical().kind
    return TypeKind.BOOL.value <= kind.value <= TypeKind.LONGDOUBLE.value


class Reader:
    """The sites of one file."""

    def __init__(self, path):
        self.path = path
        self.bytes = path.read_bytes()
        self.found = []

    def text(self, start, end):
        return self.bytes[start:end].decode()

    def add(self, cursor, kind, after, change):
        start, end = cursor.extent.start.offset, cursor.extent.end.offset
        before = self.text(start, end)
        self.found.append(Site(self.path, cursor.extent.start.line, start, end, kind, before, after, change))

    def operator(self, cursor):
        left, right = cursor.get_children()
        start, end = cursor.extent.start.offset, cursor.extent.end.offset
        a, b = left.extent.end.offset, right.extent.start.offset
        sign = self.text(a, b).strip()
        if sign not in SWAPPED or not (is_arithmetic(left) and is_arithmetic(right)):
            return
        whole, other = self.text(start, end), SWAPPED[sign]
        changed = f"{self.text(start, a)} {other} {self.text(b, end)}"
        # Where a variable in brackets is compared with a number both parts have the type of the whole.
        self.add(cursor, "operator", f"(posemix_mutant({{k}}) ? ({changed}) : ({whole}))", f"{sign} -> {other}")

    def visit(self, cursor, parent):
        if cursor.kind in LEFT_OUT or cursor.extent.start.offset == cursor.extent.end.offset:
            return
        if cursor.kind == CursorKind.VAR_DECL and "constexpr" in {t.spelling for t in cursor.get_tokens()}:
            return
        start, end = cursor.extent.start.offset, cursor.extent.end.offset
        children = list(cursor.get_children())
        if cursor.kind in (CursorKind.BINARY_OPERATOR, CursorKind.COMPOUND_ASSIGNMENT_OPERATOR) and len(children) == 2:
            self.operator(cursor)
        elif cursor.kind == CursorKind.FLOATING_LITERAL:
            text = self.text(start, end)
            other = "1.0" if float(text.rstrip("fFlL")) == 0.0 else f"2.0 * {text}"
            self.add(cursor, "number", f"(posemix_mutant({{k}}) ? {other} : {text})", f"{text} -> {other}")
        elif cursor.kind == CursorKind.CALL_EXPR and parent.kind == CursorKind.COMPOUND_STMT:
            text = self.text(start, end)
            # It changes nothing but where memory is. In templates a call has no name.
            if text.partition("(")[0].endswith((".reserve", "->reserve")):
                return
            self.add(cursor, "statement", f"(posemix_mutant({{k}}) ? void() : void({text}))", "left out")
        if cursor.kind == CursorKind.IF_STMT and "constexpr" in [t.spelling for t in cursor.get_tokens()][:2]:
            children = children[1:]
        elif cursor.kind in DECISIONS and children and is_arithmetic(children[0]):
            text = self.text(children[0].extent.start.offset, children[0].extent.end.offset)
            self.add(children[0], "decision", f"(posemix_mutant({{k}}) != static_cast<bool>({text}))", "negated")
        for child in children:
            self.visit(child, cursor)


def sites_of(path, arguments):
    """The sites in functions that the file defines; nothing where clang cannot read it."""
    reader = Reader(path)
    unit = cindex.Index.create().parse(str(path), args=arguments)
    if any(d.severity >= cindex.Diagnostic.Error for d in unit.diagnostics):
        return []

    def functions(cursor):
        for child in cursor.get_children():
            if child.location.file is None or child.location.file.name != str(path):
                continue
            if child.kind in FUNCTIONS:
                head = itertools.takewhile(lambda token: token != "{", (t.spelling for t in child.get_tokens()))
                if not {"constexpr", "consteval"} & set(head):
                    yield child
            elif child.kind in (CursorKind.NAMESPACE, CursorKind.CLASS_DECL, CursorKind.STRUCT_DECL,
                                CursorKind.CLASS_TEMPLATE, CursorKind.LINKAGE_SPEC):  # fmt: skip
                yield from functions(child)

    for function in functions(unit.cursor):
        reader.visit(function, unit.cursor)
    return reader.found


def with_mutants(text, numbered):
    """The text of a file, as bytes, with its mutants, which do not overlap."""
    for number, site in sorted(numbered, key=lambda pair: -pair[1].start):
        text = text[: site.start] + site.after.replace("{k}", str(number)).encode() + text[site.end :]
    return text.decode()


def refused(path, text, arguments):
    """The lines of a file with mutants that clang refuses."""
    unit = cindex.Index.create().parse(str(path), args=arguments, unsaved_files=[(str(path), text)])
    return {
        d.location.line
        for d in unit.diagnostics
        if d.severity >= cindex.Diagnostic.Error and d.location.file and d.location.file.name == str(path)
    }
