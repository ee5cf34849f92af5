"""Every notebook in JupyterLab, all cells run, each picture drawn; a stored one in Notebook 7 too."""

import json
import os
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path

import nbformat
import numpy as np
import pytest
from nbformat.sign import NotebookNotary

from gpcourse import view
from gpcourse.geometry import shapes

pytestmark = [pytest.mark.browser, pytest.mark.xdist_group("lab")]

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
#: A fair part of its frame; points of a scan cover the least.
LEAST = 0.05
KERNEL = {"name": "python3", "display_name": "Python 3", "language": "python"}
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
    (folder / "data").mkdir()
    for name, trusted in (("trusted", True), ("untrusted", False)):
        store_picture(folder / f"{name}.ipynb", folder / "data" if trusted else None)
    environment = os.environ | {
        "JUPYTER_DATA_DIR": str(folder / "data"),  # where the signatures of trusted notebooks lie
        "JUPYTERLAB_SETTINGS_DIR": str(settings), "GPCOURSE_STATIC": "0",
        "GPCOURSE_PROGRESS": str(folder / "progress.json"), "OPENBLAS_NUM_THREADS": "1",
    }  # fmt: skip
    command = [
        sys.executable, "-m", "jupyterlab", "--no-browser", f"--port={port}", "--ip=127.0.0.1",
        "--IdentityProvider.token=course", f"--ServerApp.root_dir={folder}", "--allow-root",
        "--expose-app-in-browser",
    ]  # fmt: skip
    with (folder / "log.txt").open("wb") as log:
        server = subprocess.Popen(command, env=environment, stdout=log, stderr=log, cwd=folder)
    try:
        _wait_for(port, server, folder)
        yield f"http://127.0.0.1:{port}"
    finally:
        server.terminate()
        server.wait(20)


def store_picture(path, signed_in=None):
    """Write a notebook whose only cell has been run; sign it if there is a folder for signatures."""
    picture = view.mesh(shapes.cube(), np.arange(8.0), alt=path.stem)
    output = nbformat.v4.new_output("display_data", {"text/plain": "a cube", "text/html": picture.html()})
    cell = nbformat.v4.new_code_cell("view.mesh(cube)", outputs=[output], execution_count=1)
    notebook = nbformat.v4.new_notebook(cells=[cell], metadata={"kernelspec": KERNEL})
    nbformat.write(notebook, path)
    if signed_in is not None:
        with NotebookNotary(data_dir=str(signed_in)) as notary:
            notary.sign(notebook)


def _wait_for(port, server, folder):
    for _ in range(300):
        assert server.poll() is None, (folder / "log.txt").read_text("utf-8", "replace")[-2000:]
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.2)
    raise AssertionError("JupyterLab did not start within a minute")


def address(lab, name):
    """Return where a notebook is opened, in a workspace of its own: a shared one opens the others again."""
    return f"{lab}/lab/workspaces/{name.split('.')[0]}/tree/{name}?token=course"


def is_a_fault(message):
    """Whether a page complains; that Jupyter's server refuses something on a busy machine is not ours."""
    return message.type == "error" and "/api/" not in message.location.get("url", "")


def outside(url):
    return url.startswith(("http", "ws")) and "//127.0.0.1:" not in url


def drawn(picture):
    """Return the frame of a picture once it has been scrolled to, and drawn."""
    from playwright.sync_api import TimeoutError as TooLate

    for _ in range(20):
        picture.scroll_into_view_if_needed()  # again, since formulas above may still grow
        frame = picture.element_handle().content_frame()
        try:
            frame.wait_for_selector("body[data-drawn]", state="attached", timeout=1000)
        except TooLate:
            continue
        return frame
    state = "JSON.stringify([document.body.dataset, innerWidth, innerHeight, wanted, busy, !!live])"
    raise AssertionError(f"not drawn within 20 s: {frame.evaluate(state)}")


def run_all(page):
    """Run every cell; return how many pictures the outputs hold, once the page holds as many.

    JupyterLab is asked itself: what it writes on the page lags behind on a busy machine.
    """
    page.wait_for_function(READY, timeout=60_000)
    page.evaluate("() => jupyterapp.commands.execute('notebook:run-all-cells')")
    page.wait_for_function(DONE, timeout=120_000)
    made = page.evaluate(PICTURES)
    page.wait_for_function("n => document.querySelectorAll('.jp-OutputArea iframe').length >= n", arg=made)
    return made


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_every_picture_of_a_notebook_is_drawn(lab, browser, notebook):
    context = browser.new_context(viewport={"width": 1200, "height": 900})
    page = context.new_page()
    went_out, faults = [], []
    page.on("request", lambda r: went_out.append(r.url) if outside(r.url) else None)
    page.on("console", lambda m: faults.append(m.text) if is_a_fault(m) else None)
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.goto(address(lab, notebook.name), timeout=60_000)
    made = run_all(page)
    assert page.locator("[data-mime-type='application/vnd.jupyter.stderr']").all_text_contents() == []
    frames = page.locator(".jp-OutputArea iframe")
    assert frames.count() == made
    assert made >= (0 if notebook.stem.startswith("0") else 1)
    for i in range(made):
        frame = drawn(frames.nth(i))
        assert frame.evaluate(INK) > LEAST, f"picture {i} is nearly blank"
        assert frame.evaluate(NAMELESS) == 0, f"a colour bar of picture {i} does not say what it shows"
    assert went_out == []
    assert faults == []
    context.close()


@pytest.mark.parametrize("program", ["JupyterLab", "Notebook"])
def test_a_stored_picture_turns_where_it_is_trusted_and_is_seen_where_it_is_not(lab, browser, program):
    context = browser.new_context(viewport={"width": 1200, "height": 900})
    page, went_out = context.new_page(), []
    page.on("request", lambda r: went_out.append(r.url) if outside(r.url) else None)
    page.goto(stored(lab, "untrusted", program), timeout=60_000)
    still = page.locator(".jp-OutputArea img")
    still.wait_for(timeout=60_000)
    assert page.locator(".jp-OutputArea iframe").count() == 0
    assert still.get_attribute("alt") == "untrusted"
    assert still.evaluate("x => x.complete && x.naturalWidth") > 300
    page.goto(stored(lab, "trusted", program), timeout=60_000)
    picture = page.locator(".jp-OutputArea iframe")
    picture.wait_for(timeout=60_000)
    stop_every_kernel(context.request, lab)
    frame = drawn(picture)
    before = frame.evaluate(PIXELS)
    assert max(before[:3]) == 255
    picture.click()
    page.keyboard.press("ArrowLeft")
    page.wait_for_timeout(200)
    turned = frame.evaluate(PIXELS)
    assert sum(abs(a - b) > 30 for a, b in zip(before, turned, strict=True)) > 300
    choose_theme(page, "Dark")
    frame.wait_for_selector("html.dark", timeout=20_000)
    page.wait_for_timeout(100)
    assert max(frame.evaluate(PIXELS)[:3]) < 60
    choose_theme(page, "Light")
    frame.wait_for_selector("html:not(.dark)", state="attached", timeout=20_000)
    assert went_out == []
    context.close()


def choose_theme(page, name):
    page.get_by_role("menuitem", name="Settings", exact=True).click()
    page.get_by_text("Theme", exact=True).hover()
    page.get_by_text(f"JupyterLab {name}", exact=True).click()


def stored(lab, name, program):
    """Return where a stored notebook is opened; one server has JupyterLab 4 and Notebook 7."""
    if program == "JupyterLab":
        return address(lab, f"{name}.ipynb")
    return f"{lab}/notebooks/{name}.ipynb?token=course"


def stop_every_kernel(request, lab):
    """End every kernel, once that of the trusted notebook waits for work."""
    asked = {"Authorization": "token course"}
    for _ in range(200):
        sessions = request.get(f"{lab}/api/sessions", headers=asked).json()
        states = [s["kernel"]["execution_state"] for s in sessions if s["path"] == "trusted.ipynb"]
        if "idle" in states:
            break
        time.sleep(0.1)
    kernels = request.get(f"{lab}/api/kernels", headers=asked).json()
    assert kernels
    for kernel in kernels:
        assert request.delete(f"{lab}/api/kernels/{kernel['id']}", headers=asked).ok


NOTEBOOK = "const lab = window.jupyterapp, shown = lab && lab.shell.currentWidget;"
IDLE = "shown.sessionContext.session?.kernel?.status === 'idle'"
#: The notebook is open and its kernel waits for work.
READY = f"() => {{ {NOTEBOOK} return shown?.sessionContext?.isReady && {IDLE}; }}"
#: Every code cell that holds code has been run, and the kernel rests.
DONE = f"""() => {{ {NOTEBOOK}
  const code = [...shown.content.model.cells].filter((c) => c.type === "code" && c.sharedModel.source.trim());
  return {IDLE} && code.length && code.every((c) => c.executionCount > 0 && c.executionState !== "running");
}}"""
PICTURES = f"""() => {{ {NOTEBOOK}
  const outputs = [...shown.content.model.cells].flatMap((c) => c.outputs?.toJSON() ?? []);
  return outputs.filter((o) => [o.data?.["text/html"] ?? ""].flat().join("").includes("<iframe")).length;
}}"""
#: A picture as small numbers, its corner first.
PIXELS = """() => {
  const c = document.querySelector("canvas"), d = document.createElement("canvas");
  d.width = 120; d.height = 80;
  const pen = d.getContext("2d");
  pen.drawImage(c, 0, 0, 120, 80);
  return [...pen.getImageData(0, 0, 120, 80).data];
}"""
#: How many colour bars have no name.
NAMELESS = "document.querySelectorAll('.bar').length - document.querySelectorAll('.bar > b').length"
#: The share of a picture that differs from its corner.
INK = f"""() => {{
  const p = ({PIXELS})();
  let n = 0;
  for (let i = 0; i < p.length; i += 4)
    if (Math.abs(p[i] - p[0]) + Math.abs(p[i + 1] - p[1]) + Math.abs(p[i + 2] - p[2]) > 30) n++;
  return n / 9600;
}}"""
