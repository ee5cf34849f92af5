"""The verdicts as JUnit's XML, which CI services show as tests.

A check is a test case: a wrong answer, an exception, a crash or a timeout is a failure, a fault of ours an
error, an exercise that was not attempted is skipped. Times are left out, so that the same class gives the
same file.

References
----------
The elements and attributes are those of https://github.com/testmoapp/junitxml.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from xml.etree import ElementTree

from gpcourse.exercises import feedback
from gpcourse.exercises.judging import CheckResult
from gpcourse.grading.judge import Judged, Report

#: What XML cannot hold.
_NO_XML = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def junit(reports: Sequence[Report]) -> str:
    """Return the XML of a class: a test suite a student, a test case a check."""
    root = ElementTree.Element("testsuites", name="gpcourse")
    counts = [0, 0, 0, 0]
    for report in reports:
        suite = ElementTree.SubElement(root, "testsuite", name=_plain(report.student))
        for judged in report.judged:
            _add(suite, judged)
        own = [len(suite), *(len(suite.findall(f"*/{kind}")) for kind in ("failure", "error", "skipped"))]
        _count(suite, own)
        counts = [a + b for a, b in zip(counts, own, strict=True)]
    _count(root, counts)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _count(element: ElementTree.Element, counts: Sequence[int]) -> None:
    for name, count in zip(("tests", "failures", "errors", "skipped"), counts, strict=True):
        element.set(name, str(count))


def _add(suite: ElementTree.Element, judged: Judged) -> None:
    verdict = judged.verdict
    if not verdict.results or verdict.outcome == "not attempted":
        for check in verdict.exercise.checks:
            case = ElementTree.SubElement(
                suite, "testcase", classname=verdict.exercise.name, name=_plain(check.claim)
            )
            ElementTree.SubElement(case, "skipped", message="not attempted")
        return
    words = _plain(feedback.as_text(verdict, answers=False))
    for result in verdict.results:
        case = ElementTree.SubElement(
            suite, "testcase", classname=verdict.exercise.name, name=_plain(result.check.claim)
        )
        _say(case, result, words)


def _say(case: ElementTree.Element, result: CheckResult, words: str) -> None:
    if result.outcome == "passed":
        return
    if result.outcome == "not attempted":
        ElementTree.SubElement(case, "skipped", message="not attempted")
        return
    kind = "error" if result.outcome == "grader fault" else "failure"
    message = result.wrong.message if result.wrong else result.outcome
    ElementTree.SubElement(case, kind, type=result.outcome, message=_plain(message)[:300]).text = words


def _plain(text: str) -> str:
    return _NO_XML.sub("�", text)
