"""What a student reads about an answer: a panel as HTML, and the same as plain text.

The HTML passes JupyterLab's sanitizer: tables, inline styles and data images only, no class, script or
outside resource. All text that comes from a student is escaped, clipped and free of control characters.
"""

from __future__ import annotations

from gpcourse.exercises.feedback.content import Content, Problem, Row, content
from gpcourse.exercises.feedback.panel import as_html, handed_out
from gpcourse.exercises.feedback.plain import as_text
from gpcourse.exercises.feedback.words import clean, without_paths

__all__ = [
    "Content",
    "Problem",
    "Row",
    "as_html",
    "as_text",
    "clean",
    "content",
    "handed_out",
    "without_paths",
]
