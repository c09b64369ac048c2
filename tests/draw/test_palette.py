# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The colours of pictures (C++), of the page (TypeScript) and of the plots (Python) are the same, and can be read on white."""

import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COLOUR = re.compile(r'"(#[0-9A-F]{6})"')


def text_of(path):
    return (ROOT / path).read_text(encoding="utf-8")


def list_of(path, name):
    """The colours after the name of a list, up to the bracket that closes it."""
    text = text_of(path)
    start = re.search(rf"\b{name}\b[^=\n{{]*[={{]", text).end()
    return COLOUR.findall(text[start : re.compile(r"[\])}]").search(text, text.index('"', start)).start()])


def contrast_on_white(colour):
    """The contrast of WCAG 2."""
    channels = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 1.05 / (0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2] + 0.05)


class Palette(unittest.TestCase):
    def test_objects_have_the_same_colours_everywhere(self):
        colours = list_of("src/draw/picture_colours.hpp", "kObjectColours")
        self.assertEqual(len(colours), 10)
        self.assertEqual(len(set(colours)), 10)
        self.assertEqual(colours, list_of("report/src/ui/palette.ts", "COLOURS"))
        self.assertEqual(colours, list_of("python/posemix/plot/style.py", "PALETTE"))

    def test_axes_have_the_same_colours_everywhere_and_no_object_has_them(self):
        axes = list_of("src/draw/picture_colours.hpp", "kAxisColours")
        self.assertEqual(len(axes), 3)
        self.assertEqual(axes, list_of("report/src/ui/palette.ts", "AXIS_COLOURS"))
        self.assertEqual(axes, list_of("python/posemix/plot/style.py", "AXIS_COLOURS"))
        self.assertFalse(set(axes) & set(list_of("src/draw/picture_colours.hpp", "kObjectColours")))

    def test_lines_can_be_read_on_white(self):
        for colour in list_of("src/draw/picture_colours.hpp", "kObjectColours"):
            self.assertGreaterEqual(contrast_on_white(colour), 3.0, colour)

    def test_methods_have_the_same_colours_in_figures_and_in_the_page(self):
        cpp = re.findall(r'\{"([^"]+)", (\w+), (true|false)\}', text_of("src/draw/method_colours.hpp"))
        cpp = {name: (-1 if colour == "kReferenceColour" else int(colour), dash) for name, colour, dash in cpp}
        page = re.findall(r'"([^"]+)": \{ colour: (-?\d+), dashed: (true|false) \}', text_of("report/src/ui/methods.ts"))
        self.assertGreater(len(cpp), 10)
        self.assertEqual(cpp, {name: (int(colour), dash) for name, colour, dash in page})

    def test_no_study_and_no_plot_has_colours_of_its_own(self):
        for folder, ending in (("src/study", "*.cpp"), ("src/draw", "*.cpp"), ("python/posemix/plot", "*.py")):
            for path in (ROOT / folder).rglob(ending):
                if path.name == "style.py":
                    continue
                text = re.sub(r'colour="#?[^"]*"', "", path.read_text(encoding="utf-8"))
                own = [c for c in COLOUR.findall(text.upper().replace("#FFFFFF", "")) if not is_grey(c)]
                self.assertEqual(own, [], path)


def is_grey(colour):
    return colour[1:3] == colour[3:5] == colour[5:7]


if __name__ == "__main__":
    unittest.main()
