"""Colours by name: a small palette that the colour-blind can tell apart, and the colour maps.

A scene names its colours with ``#rrggbb`` or one of `PALETTE`; no drawing library is asked, so that
a wrong name is refused where the scene is made and not where it is shown.
"""

from __future__ import annotations

import re
from reprlib import repr as short

from gpcourse.errors import ArrayError

#: Names for ``colour=`` arguments; the hues follow Okabe and Ito's advice for colour vision of all kinds.
PALETTE = {
    "black": "#1b1f24",
    "grey": "#8a939e",
    "silver": "#ccd3da",
    "white": "#ffffff",
    "blue": "#0b5fa5",
    "sky": "#56b4e9",
    "green": "#009e73",
    "yellow": "#e8c13a",
    "orange": "#e08a00",
    "red": "#c8450c",
    "pink": "#c2187a",
    "purple": "#9b6bd0",
}

#: The two sides of a surface, and what is drawn on it.
FRONT = "#c9d9ea"
BACK = "#f0c794"
#: Under arrows and numbers, and away from what matters.
PALE, FAR = "#dde8f3", "#eef2f6"
NO_VALUE = "#b9bcc0"
INK = PALETTE["black"]
FACE_HALFEDGE = PALETTE["blue"]
HOLE_HALFEDGE = PALETTE["red"]
QUIET_HALFEDGE = "#66768a"
HIGHLIGHT = PALETTE["pink"]

SEQUENTIAL_MAPS = ("viridis", "cividis", "magma", "twilight")
DIVERGING_MAPS = ("RdBu_r", "PuOr_r", "coolwarm")

_HEX = re.compile(r"#[0-9a-f]{6}")


def as_colour(value: object, name: str = "colour") -> str:
    """Return `value` as ``#rrggbb``: a name of `PALETTE` or six hexadecimal digits.

    Raises
    ------
    ArrayError
        If it is neither; the message lists the names.
    """
    if isinstance(value, str):
        text = PALETTE.get(value.strip().lower(), value.strip().lower())
        if _HEX.fullmatch(text):
            return text
    raise ArrayError(f"{name} is {short(value)}; give '#rrggbb' or one of {', '.join(PALETTE)}")


def as_colour_map(value: object, name: str = "colour_map") -> str:
    """Return `value` when it is a colour map that the course uses.

    Raises
    ------
    ArrayError
        If it is not; the message lists the maps.
    """
    known = SEQUENTIAL_MAPS + DIVERGING_MAPS
    if isinstance(value, str) and value in known:
        return value
    raise ArrayError(f"{name} is {short(value)}; choose one of {', '.join(known)}")
