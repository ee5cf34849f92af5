"""The panel as HTML."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

from gpcourse.exercises.feedback.content import Problem, content
from gpcourse.exercises.judging import Outcome, Verdict

if TYPE_CHECKING:
    from gpcourse.view.scene import Scene

#: Red, green and blue of what frames a panel. They tint, so that they sit well on white and on black.
_TINTS: dict[Outcome, str] = {
    "passed": "35, 150, 70",
    "not attempted": "120, 130, 145",
    "grader fault": "150, 90, 190",
}
_WRONG = "215, 110, 20"
#: Letters are ten pixels high, and three panels as wide as a notebook.
PICTURE_DPI = 96


def handed_out(verdict: Verdict) -> str:
    """Return `as_html` without what gives the answers away."""
    return as_html(verdict, answers=False)


def as_html(verdict: Verdict, *, picture: bool = True, rerun: bool = False, answers: bool = True) -> str:
    """Return the feedback on one exercise as HTML, a single element.

    Parameters
    ----------
    picture : bool
        Whether to draw the picture, where there is one. Drawing takes about a fifth of a second.
    rerun : bool
        Whether to say how the failing call can be run again; true in a notebook only.
    answers : bool
        Whether to say and draw what is true; false on pages that are handed out.
    """
    said = content(verdict, answers=answers)
    image = _drawn(said.problem) if picture and said.problem else ""
    return template("panel.html").render(  # type: ignore[no-any-return]
        said=said, picture=image, rerun=rerun, tint=tint(said.outcome), tint_of=tint
    )


def tint(outcome: Outcome) -> str:
    """Return the red, green and blue that stand for an outcome, as ``"35, 150, 70"``."""
    return _TINTS.get(outcome, _WRONG)


def _drawn(problem: Problem) -> str:
    try:
        return "" if problem.picture is None else drawn(problem.picture)
    except Exception:  # noqa: BLE001  # the scene is made from a student's values: no picture is better than no panel
        return ""


def drawn(draw: Callable[[], Scene]) -> str:
    """Return the picture of a scene as an ``<img>`` element."""
    from gpcourse.view.picture import Picture

    return Picture(draw(), dpi=PICTURE_DPI).image("webp")


@cache
def template(name: str) -> Any:
    """Return a template of this package; what it inserts is escaped."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("gpcourse.exercises.feedback"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["code"] = _with_code
    return environment.get_template(name)


def _with_code(text: str) -> Any:
    """Set what stands between backquotes as code."""
    from markupsafe import Markup
    from markupsafe import escape as escaped

    parts = re.split(r"`([^`\n]+)`", text)
    return Markup("").join(
        Markup("<code>{}</code>").format(part) if i % 2 else escaped(part) for i, part in enumerate(parts)
    )
