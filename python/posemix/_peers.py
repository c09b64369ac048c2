# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Optional packages."""

from __future__ import annotations

import importlib
from typing import Any


def peer(module: str, user: str, install: str) -> Any:
    """The imported `module`; the error says which `user` needs it and how to `install` it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise ImportError(
            f"{user} needs the package {module.split('.')[0]}: pip install {install}"
        ) from error
