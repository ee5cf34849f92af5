"""What a hostile function is: what it does, what it deserves, and what it must have left in its own folder.

Each is a notebook cell that defines ``twice``, which should return two times its argument. `ran` and
`attempt` write into the working folder: `says` has to be found there, so that no attack passes for harmless
because it never ran, and "did it" must not be, which `attempt` writes when what it tries succeeds. OUTSIDE
stands for a folder with another submission and a grade book, COURSE for the installed package.
"""

from dataclasses import dataclass
from textwrap import indent

TOOLS = """
import os, sys
def ran(what="ran"):
    with open(os.path.join(os.environ["HOME"], "ran.txt"), "a") as file:
        file.write(f"{what}\\n")
def attempt(action):
    try:
        ran(f"did it: {action()!r}"[:300])
    except BaseException as error:
        ran(f"{type(error).__name__}: {error}")
"""


@dataclass(frozen=True)
class Attack:
    """`deserves` names the outcomes that are true; a point is deserved only by ``passed``.

    `says` lists what may be found, between bars. What is `confined` is harmless only where the level is at least
    ``restricted``; `least` is the level that it takes to stop it.
    """

    what: str
    cell: str
    deserves: tuple[str, ...]
    says: str = "ran"
    confined: bool = False
    least: str = "limits"

    @property
    def name(self):
        return self.what.replace(" ", "-")


def function(what, body, *deserves, says="ran", **options):
    return Attack(what, "def twice(x):\n" + indent(body, "    "), deserves, says, **options)


def cell(what, code, *deserves, says="ran"):
    return Attack(what, code, deserves, says)


def tries(what, *actions, setup="", says="PermissionError", confined=True):
    """A function that tries what it should not and then answers well: it deserves its points."""
    body = "\n".join([*setup.splitlines(), *(f"attempt(lambda: {a})" for a in actions), "return 2 * x"])
    return function(what, body, "passed", says=says, confined=confined)
