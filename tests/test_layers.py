"""The house: imports go down only, importing is cheap, and a chapter has one stem in every folder."""

import ast
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "gpcourse"

#: From the ground up. A module imports its own room and the rooms of the floors below, never a
#: neighbour on the same floor: reference solutions are not seen where student code runs.
FLOORS = (
    {"errors"},
    {"geometry"},
    {"sandbox", "view", "reference", "data_sets"},
    {"exercises"},
    {"notebook", "grading"},
    {"cli"},
    {"__main__"},
)
FLOOR_OF = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}

#: Modules of exercises/ that are not a chapter.
KIT = {"course", "exercise", "expect", "feedback", "judging", "pictures"}

HEAVY = (
    "scipy",
    "matplotlib",
    "nbformat",
    "IPython",
    "jinja2",
    "skimage",
    "jupyterlab",
    "rich",
    "pooch",
    "requests",
)

MODULES = sorted(PACKAGE.rglob("*.py"))
CHAPTERS = [path.stem.partition("_")[2] for path in sorted((ROOT / "notebooks").glob("[0-9]*_*.ipynb"))]


def dotted(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def room(module: str) -> str:
    """The room of ``gpcourse.room.module``; the package itself is no room."""
    return module.split(".")[1] if "." in module else ""


def exists(module: str) -> bool:
    place = ROOT.joinpath(*module.split("."))
    return place.is_dir() or place.with_suffix(".py").is_file()


def imported(tree: ast.AST, package: str) -> Iterator[tuple[int, str]]:
    """Line and name of everything of gpcourse that is imported, also inside functions."""
    for node in ast.walk(tree):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package.split(".")[: len(package.split(".")) + 1 - node.level] if node.level else []
            source = ".".join([*base, *filter(None, [node.module])])
            inner = [f"{source}.{alias.name}" for alias in node.names]
            names = [name if source == "gpcourse" or exists(name) else source for name in inner]
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            names = [value.value for value in node.args[:1] if isinstance(value, ast.Constant)]
        yield from ((node.lineno, name) for name in names if name.split(".")[0] == "gpcourse")


def upward(path: Path) -> list[str]:
    """The imports of a module that do not go down, as lines of text."""
    module = dotted(path)
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    here = room(module)
    found = []
    for line, name in imported(ast.parse(path.read_text(encoding="utf-8")), package):
        there = room(name)
        down = FLOOR_OF.get(there, len(FLOORS)) < FLOOR_OF[here]
        if not (down or there == here or name == "gpcourse.__version__"):
            found.append(f"{module}, line {line}: {here} imports {name}")
    return found


@pytest.mark.parametrize("path", [path for path in MODULES if dotted(path) != "gpcourse"], ids=dotted)
def test_imports_go_down_only(path):
    assert upward(path) == []


def test_every_room_has_a_floor():
    rooms = {room(dotted(path)) for path in MODULES} - {""}
    assert rooms <= set(FLOOR_OF)


def test_the_package_itself_imports_no_room():
    tree = ast.parse((PACKAGE / "__init__.py").read_text(encoding="utf-8"))
    assert list(imported(tree, "gpcourse")) == []


@pytest.mark.parametrize(
    ("line", "allowed"),
    [
        ("from gpcourse.errors import MeshError", True),
        ("import gpcourse.view.colours", True),
        ("from . import colours", True),
        ("from ..geometry import arrays", True),
        ("from gpcourse import __version__", True),
        ("def f():\n    from gpcourse.reference import halfedge", False),
        ("from gpcourse import sandbox", False),
        ("from gpcourse import check", False),
        ("from ..exercises.exercise import Exercise", False),
        ("from importlib import import_module\nimport_module('gpcourse.reference.halfedge')", False),
    ],
)
def test_the_search_finds_every_way_of_importing(line, allowed, tmp_path, monkeypatch):
    monkeypatch.setitem(globals(), "ROOT", tmp_path)
    for name in ("view", "geometry", "reference", "sandbox", "exercises"):
        (tmp_path / "gpcourse" / name).mkdir(parents=True)
    module = tmp_path / "gpcourse" / "view" / "module.py"
    module.write_text(line, encoding="utf-8")
    assert (upward(module) == []) is allowed


def loaded_after(*statements: str) -> set[str]:
    """The modules in memory of a fresh Python after these statements."""
    code = "; ".join([*statements, "import sys, json", "print(json.dumps(sorted(sys.modules)))"])
    seen = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    return set(json.loads(seen.stdout))


def test_importing_the_package_loads_nothing_heavy():
    loaded = loaded_after("import gpcourse")
    assert "gpcourse" in loaded
    assert loaded.isdisjoint(HEAVY)


def test_running_student_code_brings_in_neither_checks_nor_reference():
    loaded = loaded_after("import gpcourse.sandbox.call", "from gpcourse.geometry import halfedge_mesh")
    rooms = {room(name) for name in loaded if name.startswith("gpcourse.")}
    assert rooms <= {"errors", "geometry", "sandbox"}


def stems(folder: str) -> set[str]:
    """The modules, or the tests, in a folder; a large chapter may be a package."""
    entries = [path for path in (ROOT / folder).iterdir() if path.suffix == ".py" or path.is_dir()]
    return {path.stem.removeprefix("test_") for path in entries if not path.name.startswith(("_", "."))}


@pytest.mark.parametrize("stem", CHAPTERS)
@pytest.mark.parametrize(
    "folder", ["gpcourse/reference", "gpcourse/exercises", "tests/reference", "tests/exercises"]
)
def test_a_chapter_has_one_stem_in_every_folder(stem, folder):
    assert stem in stems(folder)


def test_every_chapter_of_exercises_has_a_notebook():
    assert stems("gpcourse/exercises") - KIT == set(CHAPTERS)


def test_every_test_file_is_named_after_what_it_tests():
    assert stems("tests/reference") <= stems("gpcourse/reference")
    assert stems("tests/exercises") <= stems("gpcourse/exercises")


def test_notebooks_have_the_numbers_of_their_chapters_each_its_own():
    """Chapters have the numbers of the notes, and are not finished in that order: there may be gaps."""
    names = sorted(path.stem for path in (ROOT / "notebooks").glob("*.ipynb"))
    numbers = [re.match(r"(\d+)_[a-z]\w*$", name)[1] for name in names]
    assert len(set(map(int, numbers))) == len(names)
