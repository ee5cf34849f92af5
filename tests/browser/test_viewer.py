"""The page in a real browser: it is drawn, answers the mouse, and asks nobody for anything."""

import shutil
import time
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from gpcourse import shapes, view
from gpcourse.view.interactive import page

pytestmark = pytest.mark.browser
FLAGS = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-background-networking"]


@pytest.fixture(scope="module")
def browser():
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("chromium is not installed")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        yield running
        running.close()


@pytest.fixture
def opened(browser, tmp_path):
    """Open HTML offline; afterwards nothing may have been requested, and no error reported."""
    context = browser.new_context(viewport={"width": 800, "height": 760}, offline=True)
    tab, asked, errors = context.new_page(), [], []
    tab.on("request", lambda request: asked.append(request.url))
    tab.on("pageerror", lambda error: errors.append(str(error)))
    tab.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)

    def open_html(html):
        path = tmp_path / "page.html"
        path.write_text(f'<meta charset="utf-8">{html}', encoding="utf-8")
        tab.goto(path.as_uri())
        return tab

    yield open_html
    context.close()
    assert [url for url in asked if not url.startswith(("file:", "data:", "about:", "blob:"))] == []
    assert errors == []


def coloured(tab):
    """The share of the page that is neither white nor grey."""
    rgb = np.asarray(Image.open(BytesIO(tab.screenshot())).convert("RGB")).astype(int)
    return (np.ptp(rgb, axis=2) > 12).mean()


def test_a_mesh_in_a_notebook_is_drawn_and_tells_its_vertices(opened):
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    picture = view.mesh((square, [[0, 1, 2], [0, 2, 3]]), [0.5, 1.5, 2.5, 3.5], direction=(0, 0, 1))
    tab = opened(picture._repr_html_())
    frame = tab.frames[-1]
    frame.wait_for_selector("body.drawn")
    assert coloured(tab) > 0.05
    for v, value in enumerate([0.5, 1.5, 2.5, 3.5]):
        inwards = (np.array([0.5, 0.5, 0]) - square[v]) * 0.1 + square[v]
        x, y, _ = frame.evaluate(f"project(views()[0], {inwards.tolist()}, 0)")
        tab.mouse.move(8 + x, 8 + y)
        assert frame.inner_text("#said").startswith(f"vertex {v}, face ")
        assert frame.inner_text("#said").endswith(f": {value}")


def test_keys_turn_and_reset_brings_back(opened):
    tab = opened(view.mesh(shapes.torus(16))._repr_html_())
    frame = tab.frames[-1]
    frame.wait_for_selector("body.drawn")
    start = frame.evaluate("camera.turn")
    frame.focus("#gl")
    tab.keyboard.press("ArrowLeft")
    assert frame.evaluate("camera.turn") != start
    frame.click("#reset")
    assert frame.evaluate("camera.turn") == start


def test_the_slider_shows_another_frame(opened):
    sphere = shapes.icosphere(2)
    frames = [view.mesh((sphere.vertices * [1, 1, 1 / k], sphere.faces)) for k in (1, 4)]
    tab = opened(view.animation(frames, names=["round", "flat"])._repr_html_())
    frame = tab.frames[-1]
    frame.wait_for_selector('body[data-drawn="0"]')
    before = coloured(tab)
    frame.focus("#frame")
    tab.keyboard.press("ArrowRight")
    frame.wait_for_selector('body[data-drawn="1"]')
    assert frame.inner_text("#name") == "flat"
    assert coloured(tab) < 0.85 * before


def test_a_large_mesh_is_drawn_in_three_seconds(opened):
    torus = shapes.torus(317)
    assert len(torus.faces) > 100_000
    html = page(view.mesh(torus, torus.vertices[:, 0]).frames)
    start = time.monotonic()
    tab = opened(html)
    tab.wait_for_selector("body.drawn")
    assert time.monotonic() - start < 3
    assert coloured(tab) > 0.15


def test_where_frames_are_taken_out_the_image_is_there(opened):
    html = view.mesh(shapes.torus(16))._repr_html_()
    tab = opened(html[: html.index("<iframe")] + "</div>")
    assert tab.evaluate("document.images[0].naturalWidth") > 300
    assert coloured(tab) > 0.05
