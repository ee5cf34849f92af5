"""Show a mesh in a browser, and see how large and how slow the pages of other libraries are.

A torus coloured by height. Each library makes a page that is to need no network: k3d's full snapshot,
plotly with its program inside, pyvista's HTML export. A page is opened in Chromium without a network and
with software rendering; the clock runs until a picture of the window shows the colours, and taking such a
picture takes a tenth of a second itself. Making is measured in processor time. Of ours the size and the
making are those of a notebook's output, with the still image; what is opened is the page alone, so that
the still image is not taken for a drawing. The least of several rounds is reported, which other programs
disturb least.
"""

from __future__ import annotations

import argparse
import json
import shutil
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from html import unescape
from io import BytesIO
from pathlib import Path
from typing import Any

from interleaved import forget_openblas_settings

forget_openblas_settings()
import numpy as np  # noqa: E402

OURS = "gpcourse"
#: A page that shows nothing in so many seconds is taken to be blank.
PATIENCE = 60.0
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--enable-unsafe-swiftshader",
)  # fmt: skip

#: Takes (n, 3) vertices, (m, 3) faces and (n,) values; gives a page and, if it differs, a notebook's output.
Maker = Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[str, ...]]


@dataclass(frozen=True)
class Shown:
    """What one library took for one size, at its best: bytes, seconds of the processor, seconds on the clock.

    `first_picture` is None where nothing was drawn.
    """

    faces: int
    contender: str
    size: int
    making: float
    first_picture: float | None


def torus(faces: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the vertices, the faces and the heights of a torus of about so many faces."""
    from gpcourse.geometry import shapes

    sides = round((faces / 2 / 1.25) ** 0.5)
    mesh = shapes.torus(round(1.25 * sides), sides)
    return mesh.vertices, np.asarray(mesh.faces), mesh.vertices[:, 2]


def ours(vertices: np.ndarray, faces: np.ndarray, values: np.ndarray) -> tuple[str, ...]:
    """Return the page, and what a notebook shows: the page in a frame over a still image."""
    from gpcourse import view

    output = view.mesh((vertices, faces), values).html()
    return unescape(output.split('srcdoc="')[1].split('"')[0]), output


def with_k3d(vertices: np.ndarray, faces: np.ndarray, values: np.ndarray) -> tuple[str, ...]:
    """Return k3d's snapshot, with its program."""
    import k3d

    plot = k3d.plot()
    plot += k3d.mesh(
        vertices.astype(np.float32), faces.astype(np.uint32), attribute=values.astype(np.float32)
    )
    plot.snapshot_type = "full"
    return (str(plot.get_snapshot()),)


def with_plotly(vertices: np.ndarray, faces: np.ndarray, values: np.ndarray) -> tuple[str, ...]:
    """Return plotly's page, with its program."""
    from plotly import graph_objects

    (x, y, z), (i, j, k) = vertices.T, faces.T
    mesh = graph_objects.Mesh3d(x=x, y=y, z=z, i=i, j=j, k=k, intensity=values, colorscale="Viridis")
    return (str(graph_objects.Figure(mesh).to_html(include_plotlyjs=True)),)


def with_pyvista(vertices: np.ndarray, faces: np.ndarray, values: np.ndarray) -> tuple[str, ...]:
    """Return pyvista's export."""
    import pyvista

    plotter = pyvista.Plotter(off_screen=True)
    mesh = pyvista.PolyData.from_regular_faces(vertices, faces)
    plotter.add_mesh(mesh, scalars=values)
    page = plotter.trame.export_html(None)
    plotter.close()
    return (str(page.getvalue()),)


MAKERS: dict[str, Maker] = {OURS: ours, "k3d": with_k3d, "plotly": with_plotly, "pyvista": with_pyvista}


def installed() -> dict[str, Maker]:
    """Return the libraries that are here; say which are not."""
    vertices, faces, values = torus(200)
    found = {}
    for name, maker in MAKERS.items():
        try:
            maker(vertices, faces, values)
        except (ImportError, AttributeError) as error:
            print(f"{name} is left out: {error}")
        else:
            found[name] = maker
    return found


def first_picture(browser: Any, page_text: str, folder: Path) -> float | None:
    """Return the seconds until a page shows colours, or None."""
    from PIL import Image
    from playwright.sync_api import Error

    file = folder / "page.html"
    file.write_text(page_text, encoding="utf-8")
    context = browser.new_context(viewport={"width": 800, "height": 600}, offline=True)
    page = context.new_page()
    start = time.perf_counter()
    page.goto(file.as_uri(), wait_until="commit")
    try:
        while time.perf_counter() - start < PATIENCE:
            try:
                shot = page.screenshot(timeout=1000 * PATIENCE)
            except Error:  # nothing has been painted yet
                continue
            seen = Image.open(BytesIO(shot)).convert("RGB")
            if page.frames[-1].query_selector("canvas") and np.ptp(np.asarray(seen), axis=2).mean() > 4:
                return time.perf_counter() - start
    finally:
        context.close()
    return None


def measure(sizes: list[int], repeat: int) -> list[Shown]:
    """Make and open every page, library after library in each round."""
    from playwright.sync_api import sync_playwright

    makers = installed()
    results = []
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        path = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
        browser = playwright.chromium.launch(executable_path=path, args=list(FLAGS))
        for faces in sizes:
            mesh = torus(faces)
            rounds: dict[str, list[tuple[int, float, float | None]]] = {name: [] for name in makers}
            for _ in range(repeat):
                for name, maker in makers.items():
                    start = time.process_time()
                    page, *output = maker(*mesh)
                    making = time.process_time() - start
                    shown = first_picture(browser, page, Path(folder))
                    rounds[name].append((len((*output, page)[0].encode()), making, shown))
            for name, taken in rounds.items():
                sizes_seen, makings, pictures = zip(*taken, strict=True)
                drawn = min((seconds for seconds in pictures if seconds is not None), default=None)
                results.append(Shown(len(mesh[1]), name, sizes_seen[0], min(makings), drawn))
        browser.close()
    return results


def table(results: list[Shown]) -> str:
    """Lay out the results."""
    lines = [f"{'faces':>8}  {'':<10}{'page':>10}{'to make it':>14}{'first picture':>16}"]
    for one in results:
        picture = "nothing drawn" if one.first_picture is None else f"{one.first_picture:.1f} s"
        numbers = f"{one.size / 1000:>7,.0f} KB{one.making:>12.2f} s{picture:>16}"
        lines.append(f"{one.faces:>8,}  {one.contender:<10}{numbers}")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=[5_000, 20_000, 100_000, 200_000])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--json", type=Path, help="write the results to this file")
    given = parser.parse_args()
    results = measure(given.sizes, given.repeat)
    print(table(results))
    if given.json:
        given.json.write_text(json.dumps([asdict(one) for one in results], indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
