"""Layer 4: the command line.

Exit codes: 0 all is well; 1 an exercise is not right, or something is missing on this machine;
2 the command cannot be carried out, and nothing was written.
"""

from __future__ import annotations

from typing import Any

import click

from gpcourse import __version__
from gpcourse.cli.course import check, exercises, solve
from gpcourse.cli.data import data
from gpcourse.cli.doctor import doctor
from gpcourse.cli.grade import grade
from gpcourse.cli.gradescope import gradescope
from gpcourse.cli.lab import lab
from gpcourse.errors import GpcourseError

__all__ = ["main"]


class _Refusal(click.ClickException):
    exit_code = 2


class _Course(click.Group):
    """Turns errors that name their cause into one line, without a traceback."""

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except GpcourseError as error:
            raise _Refusal(str(error)) from None
        except OSError as error:
            name = f"{error.filename}: " if error.filename else ""
            raise _Refusal(f"{name}{error.strerror or error}") from None


@click.group(cls=_Course, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="gpcourse")
def main() -> None:
    """A course companion for geometry processing."""


for _command in (lab, check, solve, exercises, grade, gradescope, data, doctor):
    main.add_command(_command)
