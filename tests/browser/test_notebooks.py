"""Every notebook as a student opens it: in JupyterLab, all cells run, each picture drawn."""

import json
import os
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = [pytest.mark.browser, pytest.mark.xdist_group("lab")]

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
SETTINGS = {
    "@jupyterlab/apputils-extension/notification": {"fetchNews": "false", "checkForUpdates": False},
    # All cells are in the page, so that all pictures can be counted.
    "@jupyterlab/notebook-extension/tracker": {"windowingMode": "none"},
}


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """Yield the address of a JupyterLab on copies of the notebooks."""
    folder = tmp_path_factory.mktemp("lab")
    for notebook in NOTEBOOKS:
        shutil.copy(notebook, folder)
    settings = folder / "settings"
    for name, content in SETTINGS.items():
        path = settings / f"{name}.jupyterlab-settings"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(content))
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    environment = os.environ | {
        "JUPYTERLAB_SETTINGS_DIR": str(settings), "GPCOURSE_STATIC": "0",
        "GPCOURSE_PROGRESS": str(folder / "progress.json"), "OPENBLAS_NUM_THREADS": "1",
    }  # fmt: skip
    command = [
        sys.executable, "-m", "jupyterlab", "--no-browser", f"--port={port}", "--ip=127.0.0.1",
        "--IdentityProvider.token=course", f"--ServerApp.root_dir={folder}", "--allow-root",
    ]  # fmt: skip
    with (folder / "log.txt").open("wb") as log:
        server = subprocess.Popen(command, env=environment, stdout=log, stderr=log, cwd=folder)
    try:
        _wait_for(port, server, folder)
        yield f"http://127.0.0.1:{port}"
    finally:
        server.terminate()
        server.wait(20)


def _wait_for(port, server, folder):
    for _ in range(300):
        assert server.poll() is None, (folder / "log.txt").read_text("utf-8", "replace")[-2000:]
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.2)
    raise AssertionError("JupyterLab did not start within a minute")


def outside(address):
    return address.startswith(("http", "ws")) and "//127.0.0.1:" not in address


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_every_picture_of_a_notebook_is_drawn(lab, browser, notebook):
    context = browser.new_context(viewport={"width": 1200, "height": 900})
    page = context.new_page()
    went_out, faults = [], []
    page.on("request", lambda r: went_out.append(r.url) if outside(r.url) else None)
    page.on("console", lambda m: faults.append(m.text) if "cannot be drawn" in m.text else None)
    page.goto(f"{lab}/lab/tree/{notebook.name}?token=course", timeout=60_000)
    page.get_by_text("Python 3 (ipykernel) | Idle").wait_for(timeout=60_000)
    page.get_by_role("menuitem", name="Run", exact=True).click()
    page.get_by_text("Run All Cells", exact=True).click()
    prompts = ".jp-CodeCell .jp-InputPrompt"
    page.wait_for_function(
        f"() => {{ const p = [...document.querySelectorAll('{prompts}')].map((x) => x.textContent.trim());"
        " return p.length && p.every((t) => t !== '[*]:') && p.some((t) => /[0-9]/.test(t)); }",
        timeout=120_000,
    )
    assert page.locator("[data-mime-type='application/vnd.jupyter.stderr']").all_text_contents() == []
    frames = page.locator(".jp-OutputArea iframe")
    for i in range(frames.count()):
        frames.nth(i).scroll_into_view_if_needed()
        shown = frames.nth(i).element_handle().content_frame()
        shown.wait_for_selector("body[data-drawn]", timeout=20_000)
        assert shown.evaluate(INK) > 0.02, f"picture {i} is blank"
    assert frames.count() >= (0 if notebook.stem.startswith("0") else 1)
    assert went_out == []
    assert faults == []
    context.close()


#: The share of a picture that differs from its corner.
INK = """() => {
  const c = document.querySelector("canvas"), d = document.createElement("canvas");
  d.width = 120; d.height = 80;
  const pen = d.getContext("2d");
  pen.drawImage(c, 0, 0, 120, 80);
  const p = pen.getImageData(0, 0, 120, 80).data;
  let n = 0;
  for (let i = 0; i < p.length; i += 4)
    if (Math.abs(p[i] - p[0]) + Math.abs(p[i + 1] - p[1]) + Math.abs(p[i + 2] - p[2]) > 30) n++;
  return n / 9600;
}"""
