# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The type of path arguments."""

from __future__ import annotations

import os

Path = str | os.PathLike[str]
