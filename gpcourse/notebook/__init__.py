"""Layer 3: what a student calls in a notebook, and the making of the notebooks themselves.

``check``, ``hint``, ``solution``, ``progress`` and ``working`` are for students. `stubs` keeps the stubs
of a notebook in step with the references; `solving` fills them.
"""

from __future__ import annotations

from gpcourse.notebook.checking import Panel, check
from gpcourse.notebook.guidance import hint, solution
from gpcourse.notebook.standing import progress, working

__all__ = ["Panel", "check", "hint", "progress", "solution", "working"]
