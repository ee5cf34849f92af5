"""Layer 3: from a folder of notebooks to a grade book.

``submission`` reads files, ``judge`` puts the questions of the exercises to the functions of a notebook
in a process of its own, ``gradebook`` and ``reports`` write what came of it, ``run.grade`` does all of it.
"""

from __future__ import annotations

from gpcourse.grading.run import GradeBook, grade

__all__ = ["GradeBook", "grade"]
