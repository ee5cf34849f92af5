"""Pictures in the pages that are made of notebooks: no kernel, no network."""

import nbformat
import numpy as np
import pytest

from gpcourse import view
from gpcourse.geometry import shapes

pytestmark = [pytest.mark.browser, pytest.mark.xdist_group("browser")]


def test_a_picture_is_drawn_in_the_html_of_nbconvert(browser, tmp_path):
    from nbconvert import HTMLExporter

    data = {"text/html": view.mesh(shapes.cube(), np.arange(8.0)).html(), "text/plain": "a cube"}
    cell = nbformat.v4.new_code_cell("cube", outputs=[nbformat.v4.new_output("display_data", data)])
    html, _ = HTMLExporter(theme="dark").from_notebook_node(nbformat.v4.new_notebook(cells=[cell]))
    (tmp_path / "cube.html").write_text(html, encoding="utf-8")
    context = browser.new_context(viewport={"width": 900, "height": 800}, offline=True)
    page = context.new_page()
    page.goto((tmp_path / "cube.html").as_uri(), wait_until="domcontentloaded")
    frame = page.locator(".jp-OutputArea iframe").element_handle().content_frame()
    frame.wait_for_selector("body[data-drawn]", timeout=20_000)
    frame.wait_for_selector("html.dark")
    frame.locator("canvas").first.hover()
    assert frame.get_by_role("status").text_content().startswith("vertex ")
    context.close()
