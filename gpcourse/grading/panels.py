"""Stopgap until feedback lands."""

from __future__ import annotations

import html

from gpcourse.exercises.judging import Verdict


def as_text(verdict: Verdict) -> str:
    lines = [f"{verdict.exercise.name}: {verdict.outcome}, {verdict.points} of {verdict.exercise.points}"]
    for result in verdict.results:
        lines.append(f"  {'ok' if result.outcome == 'passed' else result.outcome}: {result.check.claim}")
    problem = verdict.first_problem
    if problem is not None:
        if problem.wrong is not None:
            lines.append(
                f"  {problem.wrong.message} {problem.wrong.yours} {problem.wrong.truth} {problem.wrong.on}"
            )
        if problem.trouble is not None:
            lines.append(f"  {problem.trouble.types[0]}: {problem.trouble.message} {problem.trouble.source}")
        if problem.mistake is not None:
            lines.append(f"  it looks as if {problem.mistake.name}. {problem.mistake.hint}")
        if problem.fault:
            lines.append(problem.fault)
    return "\n".join(lines)


def as_html(verdict: Verdict) -> str:
    return f"<pre style='white-space:pre-wrap'>{html.escape(as_text(verdict))}</pre>"
