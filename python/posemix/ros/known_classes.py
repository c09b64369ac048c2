# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What a run learns of classes: symmetries that come late, and which classes have several objects."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from posemix._core import SymmetryGroup
from posemix.ros.configuration import Configuration
from posemix.ros.surroundings import ReadyImage

__all__ = ["KnownClasses"]

# Detections in one image are of two objects where they are further apart than this part of their distance.
_APART = 0.05


@dataclass
class KnownClasses:
    """What is known of classes besides the configuration.

    Attributes
    ----------
    symmetries : dict of str to SymmetryGroup
        Symmetries by class.
    several : set of str
        Classes that are not declared, and of which the detector has shown several in one image.
    """

    symmetries: dict[str, SymmetryGroup] = field(default_factory=dict)
    several: set[str] = field(default_factory=set)
    # Number of images with several objects of a class that is not declared.
    _images: Counter[str] = field(default_factory=Counter, repr=False)

    def newly_several(self, ready: ReadyImage, of: Configuration) -> list[str]:
        """Classes that are not declared, and of which so many images have shown several objects only now."""
        ids = ready.image.class_ids
        if len(set(ids)) == len(ids) or of["on_sight_instances"] == 1 or not of["on_sight"]:
            return []
        found = []
        for name in set(ids) - self.several - set(of.declared):
            places = [ready.components[i][0].pose.translation for i, other in enumerate(ids) if other == name]
            least_m = of["existence.exclusion_m"] + _APART * float(np.linalg.norm(places, axis=1).max())
            if max(float(np.linalg.norm(a - b)) for a in places for b in places) < least_m:
                continue
            self._images[name] += 1
            if self._images[name] >= of["confirming_detections"]:
                self.several.add(name)
                found.append(name)
        return found
