"""Make the pictures of the README: a check panel, and the report of the sample class.

Needs chromium and the test extras: ``.venv/bin/python docs/make_pictures.py``
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

from gpcourse.exercises.course import find
from gpcourse.exercises.feedback import as_html
from gpcourse.exercises.judging import ask_here, judge
from gpcourse.grading import grade

HERE = Path(__file__).parent
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]


def panel() -> str:
    """Return the page of a panel: a walk around a vertex that stops at the hole."""
    exercise = find("flip_edge")
    (mistake,) = [m for m in exercise.mistakes if "inside out" in m.name]
    verdict = judge(exercise, ask_here(mistake.function), 0)
    return f'<body style="font: 15px sans-serif; margin: 12px; width: 820px">{as_html(verdict)}</body>'


def main() -> None:
    """Write docs/pictures/*.png."""
    (HERE / "pictures").mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        work = Path(folder)
        (work / "panel.html").write_text(panel(), encoding="utf-8")
        grade(HERE.parent / "data" / "sample_class", work / "grades", seed=7)
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        pages = (
            ("check-panel", work / "panel.html", 850, 10),
            ("grade-report", work / "grades" / "index.html", 1200, 900),
        )
        for name, path, width, height in pages:
            page = browser.new_page(viewport={"width": width, "height": height})
            page.goto(path.as_uri())
            page.screenshot(path=HERE / "pictures" / f"{name}.png", full_page=height < 100)
        browser.close()


if __name__ == "__main__":
    main()
