# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Views by their names, as parameters of programs have them."""

from __future__ import annotations

from typing import Any

from posemix.live_view.foxglove_view import FoxgloveView
from posemix.live_view.rerun_view import RerunView
from posemix.live_view.view import View

__all__ = ["VIEWS", "open_view"]

VIEWS = ("rerun", "foxglove")


def open_view(kind: str, address: str = "", **options: Any) -> View:
    """A view by the name of its viewer.

    Parameters
    ----------
    kind : {"rerun", "foxglove"}
        The viewer.
    address : str
        A file that ends in .rrd or .mcap, or the viewer's address; empty: that which the viewer has by default.
    **options
        As for `RerunView` or `FoxgloveView`.

    Raises
    ------
    ValueError
        For another name, and an address that is none.
    ImportError, OSError
        As for `RerunView` and `FoxgloveView`.
    """
    if kind not in VIEWS:
        raise ValueError(f"view is '{kind}'; expected one of {', '.join(VIEWS)}")
    ending = ".rrd" if kind == "rerun" else ".mcap"
    place = {"file": address} if address.endswith(ending) else {"address": address or None}
    return RerunView(**place, **options) if kind == "rerun" else FoxgloveView(**place, **options)
