# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What is taken for a path."""

from __future__ import annotations

import os

Path = str | os.PathLike[str]
