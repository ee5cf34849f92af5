"""Write the notebooks of data/sample_class.

``python data/make_sample_class.py`` fills the stubs of chapter 1 with right and with wrong solutions,
keeps the cells that matter for grading, and then damages some. The README there says what each deserves.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from gpcourse.errors import NotebookError
from gpcourse.exercises.course import find
from gpcourse.exercises.exercise import Exercise
from gpcourse.notebook import document, solving
from gpcourse.notebook.closure import closure

HERE = Path(__file__).resolve().parent
NOTEBOOK = HERE.parent / "notebooks" / "1_halfedge.ipynb"
CLASS = HERE / "sample_class"

Solution = Callable[..., Any]
Notebook = dict[str, Any]


def cell(source: str, kind: str = "code") -> Notebook:
    """Make a cell; a code cell as one that was not run."""
    ran = {"execution_count": None, "outputs": []} if kind == "code" else {}
    return {"cell_type": kind, "metadata": {}, "source": source, **ran}


def reference_of(exercise: Exercise) -> Solution:
    """Choose the reference."""
    return exercise.reference


def variant_of(exercise: Exercise) -> Solution:
    """Choose another right solution, where there is one that can be copied into a notebook."""
    for variant in exercise.variants:
        with contextlib.suppress(NotebookError):
            closure(variant.function, exercise.name)
            return variant.function
    return exercise.reference


def mistaken(**names: str) -> Callable[[Exercise], Solution]:
    """Choose the reference, but for the exercises named the mistake that goes by that name."""

    def choose(exercise: Exercise) -> Solution:
        wanted = names.get(exercise.name)
        if wanted is None:
            return exercise.reference
        return next(m.function for m in exercise.mistakes if m.name == wanted)

    return choose


def handed_in(choose: Callable[[Exercise], Solution | None]) -> Notebook:
    """Fill the stubs of chapter 1 and keep its imports, its exercises, and a word of text."""
    solved = solving.solve(document.read(NOTEBOOK), choose)
    cells = [cell("# Half-edge meshes", "markdown")]
    for one in solved["cells"]:
        source = document.source_of(one)
        if one["cell_type"] == "code" and (one.get("id") == "imports" or "gpcourse" in one["metadata"]):
            cells.append(cell(source))
    for i, one in enumerate(cells):
        one["id"] = f"cell-{i}"
    return {"cells": cells, "metadata": solved["metadata"], "nbformat": 4, "nbformat_minor": 5}


def edit(notebook: Notebook, name: str, change: Callable[[str], str]) -> Notebook:
    """Change the source of the cell that defines `name`."""
    for one in notebook["cells"]:
        if f"def {name}(" in one["source"]:
            one["source"] = change(one["source"])
    return notebook


def swapped(notebook: Notebook, a: str, b: str) -> Notebook:
    """Exchange the names of two functions."""
    notebook = edit(notebook, a, lambda source: source.replace(f"def {a}(", "def swapped("))
    notebook = edit(notebook, b, lambda source: source.replace(f"def {b}(", f"def {a}("))
    return edit(notebook, "swapped", lambda source: source.replace("def swapped(", f"def {b}("))


def body(name: str, lines: str) -> str:
    """Write a function with the exercise's arguments and other lines in its body."""
    arguments = ", ".join(find(name).signature.parameters)
    return f"def {name}({arguments}):\n" + "".join(f"    {line}\n" for line in lines.splitlines())


def chatty(notebook: Notebook) -> Notebook:
    """Add what honest notebooks have: prints, plots, magics, comments, old metadata, stale outputs."""
    extra = [
        "%matplotlib inline\n%timeit sum(range(100))\n!pip list",
        "import warnings\n\n\ndef 打印(*什么):  # 调试\n    print('调试', *什么)\n    warnings.warn('慢')\n",
        "mesh = reference.halfedge_mesh(*shapes.torus(24))\nview.mesh(mesh)\nplt.plot([1, 2, 3])\nplt.show()",
    ]
    notebook["cells"][2:2] = [cell(source) for source in extra]
    notebook = edit(notebook, "genus", lambda source: source + "\n\n\n# 亏格：环柄的个数\ngenus_of = genus\n")
    told = "def euler_characteristic(mesh):\n    打印(mesh)  # 看一看\n    return _count(mesh)"
    notebook = edit(
        notebook,
        "euler_characteristic",
        lambda source: source.replace("def euler_characteristic(", "def _count(") + f"\n\n\n{told}\n",
    )
    for one in notebook["cells"]:
        del one["metadata"]
        one.pop("id", None)
    return {**notebook, "nbformat_minor": 0}


def make() -> dict[str, str]:
    """Return the text of each file, by its path in the folder of the class."""
    books = {
        "amara.ipynb": handed_in(reference_of),
        "bruno.ipynb": handed_in(variant_of),
        "chunhua.ipynb": chatty(handed_in(variant_of)),
        "dmitri.ipynb": swapped(handed_in(reference_of), "vertex_neighbours_ccw", "vertex_neighbours_cw"),
        "esi.ipynb": handed_in(mistaken(build_halfedges="the half-edges along holes are missing")),
        "farid.ipynb": handed_in(
            mistaken(
                dual_mesh="the faces of the dual are clockwise",
                read_off="comments were read as data",
            )
        ),
        "greta.ipynb": handed_in(lambda exercise: None),
        "hamid.ipynb": edit(
            handed_in(reference_of),
            "face_centroid",
            lambda source: source.replace("-> FloatArray:", "-> FloatArray"),
        ),
        "ines.ipynb": edit(
            handed_in(reference_of),
            "boundary_loops",
            lambda _: body(
                "boundary_loops",
                "loops = []\nh = 0\nwhile len(loops) < 100:\n    h = mesh.next[h]\nreturn loops",
            ),
        ),
        "jonas.ipynb": edit(
            handed_in(reference_of),
            "is_flippable",
            lambda _: "import ctypes\n\n\n" + body("is_flippable", "return bool(ctypes.string_at(0))"),
        ),
        "kalinda.ipynb": edit(
            handed_in(reference_of),
            "face_vertices",
            lambda _: body("face_vertices", "corners = [mesh.face_halfedge[f]]\nreturn corners[f + 1000]"),
        ),
        "mina/Halfedge final (2).ipynb": edit(
            handed_in(reference_of), "cube", lambda source: source.replace("def cube(", "def my_cube(")
        ),
    }
    files = {name: json.dumps(book, indent=1, ensure_ascii=False) + "\n" for name, book in books.items()}
    return files | {"lars.ipynb": files["amara.ipynb"][:5000]}


if __name__ == "__main__":
    for name, text in make().items():
        path = CLASS / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
