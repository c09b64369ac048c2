#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Write the calls of test_arguments.cpp by the listing of the public interface, docs/api/cpp.txt.

    generate.py LISTING FOLDER FILES

writes FOLDER/public_headers.hpp, FOLDER/samples_of_types.hpp (values of the structs, field by field, and of the enumerations) and FOLDER/calls_N.cpp
(every function, constructor and method that the listing has, spread over FILES files).
"""

import re
import sys
from pathlib import Path

# What templates are called with; G and D are their parameters.
DENSITIES = ["ConcentratedGaussian< SE3d >", "ProjectedGaussian< SE3d >"]
ARGUMENTS = {
    "LieGroup G": ["SE3d", "PoseStackd"], "RotationOrPose G": ["SO3d", "SE3d"], "class G": ["SE3d"],
    "EmDensity D": DENSITIES, "class D": DENSITIES, "class P, class Q": [f"{d}, {d}" for d in DENSITIES],
    "int N": ["3"], "typename Scalar": ["double"],
}  # fmt: skip
# Classes that are templates, and as what their members are called.
INSTANCES = {
    "SE3": ["SE3d"], "SO3": ["SO3d"], "Rn": ["Rnd< 3 >"], "PoseStack": ["PoseStackd"], "TwistMatrix": ["TwistMatrix< double >"],
    "ConcentratedGaussian": ["ConcentratedGaussian< SE3d >", "ConcentratedGaussian< PoseStackd >"],
    "ProjectedGaussian": ["ProjectedGaussian< SO3d >", "ProjectedGaussian< SE3d >"],
    "Mixture": [f"Mixture< {d} >" for d in DENSITIES],
    "BatchEvaluator": [f"BatchEvaluator< {d} >" for d in DENSITIES],
    "PairSelector": ["PairSelector< ConcentratedGaussian< SE3d > >"],
    "GaussianCubature": ["GaussianCubature< 3 >"],
    "ConcentratedGaussian::Evaluator": ["ConcentratedGaussian< SE3d >::Evaluator"],
    "ProjectedGaussian::Evaluator": ["ProjectedGaussian< SE3d >::Evaluator"],
    "Mixture::Evaluator": [f"Mixture< {d} >::Evaluator" for d in DENSITIES],
}  # fmt: skip
# Interfaces between the parts of EM, and what tests are written with.
NOT_CALLED = re.compile(r"(\w+)\(\1 &&\w*\)|posemix::(testing::|showValue|Em(Model|Samples|Row|Coordinates))|operator=\(|~|=delete|\(\*|InvalidInput|OutputError|::release\(")


def split(text):
    """The parameters of a signature, at the commas that no bracket holds."""
    parts, depth, part = [], 0, ""
    for c in text:
        depth += (c in "<({[") - (c in ">)}]")
        if c == "," and depth == 0:
            parts.append(part.strip())
            part = ""
        else:
            part += c
    return [*parts, part.strip()] if part.strip() else parts


def parameter_type(parameter):
    """The type of a parameter, without its name and default."""
    parameter = re.sub(r"\s*=(?!=).*$", "", parameter)
    if re.fullmatch(r"(const )?[\w:]+( &&?| \*)?", parameter) and " " not in parameter.removeprefix("const ").strip():
        return parameter  # a type without a name
    return re.sub(r"\s*\b\w+$", "", parameter) if not re.search(r"[&>*]$", parameter) else parameter


class Function:
    """One line of the listing that can be called."""

    def __init__(self, line):
        self.line = line
        head = re.match(r"(template <(?P<template>[^()]*?)> )?(?P<rest>.*)", line)
        self.template, rest = head["template"], head["rest"]
        match = re.search(r"posemix::(?P<name>(?:[\w:]|< \w+(?:< \w+ >)? >::)*?(?:operator\(\)|operator\[\]|operator[^\w\s(]+|\w+))\(", rest)
        self.name = match["name"]
        start, depth = match.end(), 1
        end = start
        while depth:
            depth += (rest[end] == "(") - (rest[end] == ")")
            end += 1
        self.parameters = [parameter_type(p) for p in split(rest[start : end - 1])]
        self.is_const = rest[end:].startswith(" const")
        self.is_static = rest.startswith("static ")
        self.scope, _, self.last = self.name.rpartition("::")


def functions(lines):
    for line in lines:
        if line.startswith(("#", "struct", "class", "enum", "using", "template <>")) or "(" not in line:
            continue
        if NOT_CALLED.search(line) or re.match(r"template [^<]", line) or re.match(r"std::function<[^(]*\([^)]*\)> posemix::[\w:]+$", line):
            continue
        if re.match(r"(template <[^()]*> )?(class|struct|using|concept|enum|constexpr \w+ posemix::\w+$)", line):
            continue
        yield Function(line)


def attacked(parameters, function, first=""):
    call = f"[]({first}auto&&... a) {{ static_cast<void>({function}(std::forward<decltype(a)>(a)...)); }}"
    return f"  return calls_of({call}, TypeList<{parameters}>{{}});\n"


def call(function, number, classes, nested):
    """The lines of C++ that register the calls of a function, one for everything that a template is called with."""
    is_member = function.scope in classes
    variants = [("", {})]
    if is_member and function.template and function.template != "class Element":
        return None
    if is_member and function.scope in INSTANCES:
        variants = [(c, {}) for c in INSTANCES[function.scope]]
    elif is_member:
        variants = [(function.scope, {})]
    elif function.template:
        if function.template not in ARGUMENTS:
            return None
        letters = re.findall(r"\w+ (\w+)", function.template)
        variants = [(value, dict(zip(letters, split(value)))) for value in ARGUMENTS[function.template]]
        if function.template == "class D" and "const FuseSettings &" in function.parameters:
            variants.pop()  # ProjectedGaussian has its own
    lines = []
    for index, (value, replaced) in enumerate(variants):
        def resolved(text, value=value, replaced=replaced):
            for letter, real in replaced.items():
                text = re.sub(rf"\b{letter}\b(?!\w)", real, text)
            if is_member:
                text = re.sub(r"(?<![\w:])Element\b", "typename Class::Group", text)
                own = function.scope.rpartition("::")[2]
                if function.scope in INSTANCES:
                    text = re.sub(rf"(?<![\w:]){own}\b(?! <|< )", value, text)
                for name in nested.get(function.scope, ()):
                    text = re.sub(rf"(?<![\w:]){name}\b", f"typename Class::{name}", text)
                if "::Evaluator" in function.scope:
                    outer = value.removesuffix("::Evaluator")
                    text = re.sub(r"(?<![\w:])(ConcentratedGaussian|ProjectedGaussian|Mixture)\b(?!<)", outer, text)
                    text = re.sub(r"(?<![\w:])G\b|typename Class::Group", f"typename {outer}::Group", text)
                text = re.sub(r"(?<![\w:])G\b", "typename Class::Group", text) if "Gaussian" in function.scope else text
                text = re.sub(r"(?<![\w:])D\b", "typename Class::Density", text) if function.scope == "Mixture" else text
                text = re.sub(r"(?<![\w:])D\b", value.removeprefix("BatchEvaluator< ").removesuffix(" >"), text)
            return text

        parameters = ", ".join(resolved(p) for p in function.parameters)
        text = function.line.replace("\\", "\\\\").replace('"', '\\"')
        if len(variants) > 1:
            text += f"  [{value}]"
        namespace = function.scope if not is_member else ""
        opened = f"  using namespace posemix::{namespace};\n" if namespace else ""
        if is_member:
            target = f"  using Class [[maybe_unused]] = {value};\n"
            if function.last == function.scope.rpartition("::")[2]:
                target += f"  return constructor_calls<Class{', ' if parameters else ''}{parameters}>();\n"
            elif function.is_static:
                target += attacked(parameters, f"Class::{function.last}")
            else:
                own = f"{'const ' if function.is_const else ''}Class&"
                target += attacked(f"{own}, {parameters}" if parameters else own, f"object.{function.last}", "auto& object, ")
        else:
            is_deduced = all(re.search(rf"(?<!typename )\b{letter}\b", " ".join(function.parameters)) for letter in replaced)
            explicit = "" if is_deduced else f"< {value} >"
            target = attacked(parameters, f"posemix::{function.name}{explicit}")
        lines.append(f'const Callee kCallee{number}_{index}{{"{text}", [] {{\n{opened}{target}}}}};\n')
    return "".join(lines)


def fields_of(lines, structs):
    """Name and type of the fields of every struct."""
    fields = {name: [] for name in structs}
    for line in lines:
        match = re.fullmatch(r"(?P<type>[^()]+) posemix::(?P<struct>[\w:]+)::(?P<field>\w+)", line)
        if match and match["struct"] in fields and not line.startswith(("static", "enum", "using", "constexpr", "template", "struct", "class")):
            fields[match["struct"]].append((match["field"], match["type"]))
    return fields


def write(path, text):
    """Replace the file where it is another, so that nothing is compiled anew without need."""
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def samples(lines):
    """Values of the structs and enumerations."""
    structs = {}
    for line in lines:
        match = re.fullmatch(r"struct posemix::(\w+)(?: : (\w+))?", line)
        if match:
            structs[match[1]] = match[2]
    fields = fields_of(lines, structs)
    enums = {}
    for line in lines:
        match = re.fullmatch(r"enum posemix::(\w+)::(\w+)", line)
        if match:
            enums.setdefault(match[1], []).append(match[2])
    text = "// Written by generate.py.\n#pragma once\n\nnamespace posemix::arguments {\n\n"
    for name, words in enums.items():
        text += f"template <>\nstruct Samples<{name}> : Enumerators<{', '.join(f'{name}::{word}' for word in words)}> {{}};\n"
    for name, base in structs.items():
        own = fields[name] + (fields.get(base, []) if base else [])
        text += f"\ntemplate <>\nstruct Fields<{name}> {{\n  static constexpr auto all() {{\n    return std::tuple{{"
        text += ", ".join(f"&{name}::{field}" for field, _ in own)
        text += "};\n  }\n"
        names = ", ".join(f'"{field}"' for field, _ in own)
        text += f"  static constexpr std::array<std::string_view, {len(own)}> kNames{{{names}}};\n}};\n"
    return text + "\n}  // namespace posemix::arguments\n"


def main():
    listing, folder, files = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
    lines = listing.read_text().splitlines()
    folder.mkdir(parents=True, exist_ok=True)
    headers = [line for line in lines if line.startswith("#include ") and "/testing" not in line]
    write(folder / "public_headers.hpp", "// Written by generate.py.\n#pragma once\n\n" + "\n".join(headers) + "\n")
    write(folder / "samples_of_types.hpp", samples(lines))
    classes, nested = set(), {}
    for line in lines:
        match = re.match(r"(?:template <[^()]*> )?(?:class|struct) posemix::([\w:]+)", line)
        if match:
            classes.add(match[1])
            if "::" in match[1]:
                nested.setdefault(match[1].rpartition("::")[0], []).append(match[1].rpartition("::")[2])
        match = re.match(r"using .* posemix::([\w:]+)::(\w+)$", line)
        if match:
            nested.setdefault(match[1], []).append(match[2])
    texts = [[] for _ in range(files)]
    for number, function in enumerate(functions(lines)):
        text = call(function, number, classes, nested)
        if text:
            texts[number % files].append(text)
    for number, calls in enumerate(texts):
        text = '// Written by generate.py.\n#include "attack.hpp"\n\nnamespace posemix::arguments {\nnamespace {\n\n'
        text += "".join(calls) + "\n}  // namespace\n}  // namespace posemix::arguments\n"
        write(folder / f"calls_{number + 1}.cpp", text)


if __name__ == "__main__":
    main()
