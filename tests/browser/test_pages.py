"""Pages for a browser: those that nbconvert and Sphinx make of notebooks, and those of the grade book."""

import subprocess
import sys

import nbformat
import numpy as np
import pytest

from gpcourse import view
from gpcourse.exercises import expect
from gpcourse.exercises.course import CHAPTERS
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import ask_here, judge
from gpcourse.geometry import shapes
from gpcourse.grading import gradebook, reports
from gpcourse.grading.judge import Judged, Report

pytestmark = [pytest.mark.browser, pytest.mark.xdist_group("browser")]


def notebook_with_a_picture():
    """A notebook whose only cell has been run, and shows a cube."""
    data = {"text/html": view.mesh(shapes.cube(), np.arange(8.0)).html(), "text/plain": "a cube"}
    cell = nbformat.v4.new_code_cell("cube", outputs=[nbformat.v4.new_output("display_data", data)])
    return nbformat.v4.new_notebook(cells=[nbformat.v4.new_markdown_cell("# A cube"), cell])


def by_nbconvert(folder, **settings):
    from nbconvert import HTMLExporter

    html, _ = HTMLExporter(**settings).from_notebook_node(notebook_with_a_picture())
    (folder / "cube.html").write_text(html, encoding="utf-8")
    return folder / "cube.html"


def by_sphinx(folder):
    """Build a book of one notebook, as courses do."""
    nbformat.write(notebook_with_a_picture(), folder / "cube.ipynb")
    settings = {
        "extensions": "myst_nb", "html_theme": "sphinx_book_theme", "nb_execution_mode": "off",
        "root_doc": "cube",
    }  # fmt: skip
    given = [word for name, value in settings.items() for word in ("-D", f"{name}={value}")]
    command = [sys.executable, "-m", "sphinx", "-q", "-C", *given, str(folder), str(folder / "book")]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    return folder / "book" / "cube.html"


# The book's theme lays what a cell shows on a light ground, at night too.
@pytest.mark.parametrize(("maker", "dark"), [(by_nbconvert, False), (by_nbconvert, True), (by_sphinx, False)])
def test_a_picture_is_drawn_in_a_page_made_of_a_notebook(browser, tmp_path, maker, dark):
    file = maker(tmp_path, **({"theme": "dark"} if dark else {}))
    context = browser.new_context(viewport={"width": 900, "height": 800}, offline=True)
    page, asked = context.new_page(), []
    page.on("request", lambda r: asked.append(r.url) if r.frame != page.main_frame else None)
    page.goto(file.as_uri(), wait_until="domcontentloaded")
    frame = page.locator("iframe").element_handle().content_frame()
    frame.wait_for_selector("body[data-drawn]", timeout=20_000)
    frame.wait_for_selector("html.dark" if dark else "html:not(.dark)", state="attached")
    frame.locator("canvas").first.hover()
    assert frame.get_by_role("status").text_content().startswith("vertex ")
    assert asked in ([], ["about:srcdoc"])  # of a picture; the pages themselves ask for MathJax
    context.close()


HOSTILE = (
    "<script>document.title='ran'; alert(1)</script><img src=x onerror=\"document.title='ran'; alert(1)\">"
    "<svg onload=alert(1)><iframe srcdoc='<script>alert(1)</script>'></iframe><style>*{display:none}</style>"
    "<a href=\"javascript:alert(1)\">me</a><meta http-equiv=refresh content='0;url=http://127.0.0.1:9/'>"
    "\" onmouseover=alert(1) x=' ]]> {{ 7 * 7 }} {% raw %} \x1b[31m\x1b]8;;http://127.0.0.1:9/\x07 "
    "=cmd()|' /C calc'!A0"
)


def hostile_class(tmp_path):
    """Write both pages for a student whose name, answers, exceptions and notes are hostile."""

    def named(x):
        return HOSTILE

    named.__doc__ = HOSTILE
    exercise = Exercise(named, notes="", hints=())

    @exercise.check("<b>ours</b>")
    def _(f, rng):
        raise expect.Wrong(HOSTILE, yours=str(f(HOSTILE)), on=HOSTILE)

    @exercise.mistake("<b>ours</b>", hint="<b>ours</b>")
    def _(x):
        raise ValueError

    def raising(x):
        raise RuntimeError(HOSTILE)

    judged = tuple(Judged(judge(exercise, ask_here(f), 0), (HOSTILE,), True) for f in (named, raising))
    one = Report(HOSTILE, "grader fault", judged, (HOSTILE,), fault=HOSTILE)
    names = gradebook.file_names([HOSTILE])
    student = tmp_path / "students" / f"{names[HOSTILE]}.html"
    gradebook.write(student, reports.student_page(one, CHAPTERS[:1]))
    gradebook.write(
        tmp_path / "index.html", reports.class_page([one], CHAPTERS[:1], [exercise, exercise], 0, names)
    )
    return tmp_path / "index.html", student


def test_nothing_that_a_student_wrote_runs_in_the_grade_book(browser, tmp_path):
    for path in hostile_class(tmp_path):
        context = browser.new_context(viewport={"width": 900, "height": 900})
        page, events = context.new_page(), []
        page.on("dialog", lambda dialog, events=events: (events.append(dialog.message), dialog.dismiss()))
        page.on("request", lambda request, events=events: events.append(request.url))
        page.goto(path.as_uri(), wait_until="load")
        page.evaluate("document.querySelectorAll('details').forEach(d => d.open = true)")
        for element in page.locator("a, td, summary").all()[:40]:
            element.hover()
        page.wait_for_timeout(100)
        assert events == [path.as_uri()]
        assert "<script>" in page.locator("body").inner_text()
        assert page.locator("script, img, iframe, body style, meta[http-equiv]").count() == 0
        assert page.evaluate("getComputedStyle(document.querySelector('h1')).display") == "block"
        links = page.eval_on_selector_all("a", "all => all.map(a => a.protocol)")
        assert set(links) <= {"file:"}
        assert "\x1b" not in page.content()
        context.close()
