"""The autograder for Gradescope: the zip file, and what it does with a submission there.

References
----------
The layout of /autograder and the fields of results.json: https://gradescope-autograders.readthedocs.io,
*Autograder Specifications*.
"""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
import traceback
import zipfile
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from pathlib import Path

from gpcourse.errors import UsageError
from gpcourse.grading.run import chapters_called, grade

_PACKAGE = Path(__file__).resolve().parent.parent
#: What grading needs: the packages of pyproject.toml, but for those of a notebook. A list of its own, since
#: what an installation in place says of itself may be old.
NEEDED = (
    "numpy", "scipy", "matplotlib", "scikit-image", "jinja2", "click", "rich", "pooch", "platformdirs",
    "requests", "filelock",
)  # fmt: skip
NOT_NEEDED = ("jupyterlab", "nbformat", "jsonschema")
#: The same files give the same zip file.
_TIME = (1980, 1, 1, 0, 0, 0)

_SETUP = """\
#!/usr/bin/env bash
# Gradescope runs this once, as root, when it builds the image. What is installed lies where everybody may
# read it: student code runs as nobody.
set -euo pipefail
root="${{GPCOURSE_AUTOGRADER:-/autograder}}"
home="${{GPCOURSE_HOME:-/opt/gpcourse}}"
if ! python3 -c 'import ensurepip, venv' 2> /dev/null; then
    apt-get update
    apt-get install -y --no-install-recommends python3-venv
fi
python3 -m venv "$home/uv"
"$home/uv/bin/pip" install --quiet uv
export UV_PYTHON_INSTALL_DIR="$home/pythons"
"$home/uv/bin/uv" venv --quiet --python {python} "$home/venv"
"$home/uv/bin/uv" pip install --quiet --python "$home/venv" --requirement "$root/source/requirements.txt"
PYTHONPATH="$root/source/package" "$home/venv/bin/python" -m gpcourse doctor || true
"""

_RUN = """\
#!/usr/bin/env bash
# Gradescope runs this for each submission. What it prints is for instructors only.
root="${GPCOURSE_AUTOGRADER:-/autograder}"
home="${GPCOURSE_HOME:-/opt/gpcourse}"
cd "$root"
export PYTHONPATH="$root/source/package"
exec "${GPCOURSE_PYTHON:-$home/venv/bin/python}" -c \\
    'import sys; from gpcourse.grading.gradescope import run; sys.exit(run(sys.argv[1]))' "$root"
"""

_BROKEN = (
    "The autograder could not grade this submission. That is not your fault, and what you handed in is kept: "
    "please tell your instructor."
)


def build(out: Path, chapters: Sequence[str], *, seed: int = 0, allow_unconfined: bool = False) -> None:
    """Write the zip file that an instructor uploads as the autograder of one assignment.

    Parameters
    ----------
    out : path
        The zip file; one that exists is replaced.
    chapters : sequence of str
        Numbers or stems, as for `grade`. They are what the assignment is out of.
    seed : int
        Decides the inputs that the checks draw; 0 or more. The class should not know it.
    allow_unconfined : bool
        Grade also where Gradescope's machine cannot confine student code.

    Raises
    ------
    UsageError
        If there is no such chapter, the seed is negative, or `out` is a folder.
    """
    if seed < 0:
        raise UsageError(f"the seed is {seed}; give a whole number that is not negative")
    if out.is_dir():
        raise UsageError(f"{out} is a folder; give the name of a zip file in it, as {out / 'autograder.zip'}")
    stems = [chapter.stem for chapter in chapters_called(chapters)]
    settings = {"chapters": stems, "seed": seed, "allow_unconfined": allow_unconfined}
    out.parent.mkdir(parents=True, exist_ok=True)
    part = out.with_name(f".{out.name}.part")
    try:
        with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as file:
            python = f"{sys.version_info.major}.{sys.version_info.minor}"
            _add(file, "setup.sh", _SETUP.format(python=python).encode(), 0o755)
            _add(file, "run_autograder", _RUN.encode(), 0o755)
            _add(file, "requirements.txt", _requirements().encode())
            _add(file, "settings.json", (json.dumps(settings, indent=1) + "\n").encode())
            for name, path in _files():
                _add(file, f"package/{name}", path.read_bytes())
        part.replace(out)
    finally:
        part.unlink(missing_ok=True)


def _add(file: zipfile.ZipFile, name: str, content: bytes, mode: int = 0o644) -> None:
    info = zipfile.ZipInfo(name, _TIME)
    info.create_system = 3  # Unix: then the rights count
    info.external_attr = (0o100000 | mode) << 16
    info.compress_type = zipfile.ZIP_DEFLATED
    file.writestr(info, content)


def _files() -> Iterator[tuple[str, Path]]:
    """Yield the files of this package and of the scans that its exercises take."""
    from gpcourse.data_sets import pebble_folder

    for path in sorted(_PACKAGE.rglob("*")):
        inner = path.relative_to(_PACKAGE)
        if path.is_file() and not {"__pycache__", "_course"} & set(inner.parts):
            yield f"gpcourse/{inner.as_posix()}", path
    for path in sorted(pebble_folder().iterdir()):
        if path.is_file():
            yield f"gpcourse/_course/scans/{path.name}", path


def _requirements() -> str:
    """Pin what is installed here, so that Gradescope's verdicts are those of this machine."""
    return "".join(f"{name}=={version(name)}\n" for name in NEEDED)


def run(root: str) -> int:
    """Grade the submission in ``root/submission`` and write ``root/results/results.json``; return 0.

    Whatever happens, there is a results.json that students may see; what broke is printed, for instructors.
    """
    folder = Path(root)
    results = folder / "results" / "results.json"
    results.parent.mkdir(parents=True, exist_ok=True)
    results.write_text(_broken(), encoding="utf-8")
    try:
        settings = json.loads((folder / "source" / "settings.json").read_text(encoding="utf-8"))
        with tempfile.TemporaryDirectory(prefix="gpcourse-", ignore_cleanup_errors=True) as scratch:
            work = Path(scratch)
            shutil.copytree(folder / "submission", work / "in" / "submission", symlinks=True)
            book = grade(work / "in", work / "out", jobs=1, **settings)
            shutil.copyfile(work / "out" / "gradescope" / "submission" / "results.json", results)
            print(f"{book.reports[0].status}, {book.reports[0].points} points, level {book.confinement}")
    except Exception:  # noqa: BLE001  # said to the instructor; the student has the sentence above
        traceback.print_exc(file=sys.stdout)
    return 0


def _broken() -> str:
    content = {
        "score": 0,
        "output": _BROKEN,
        "output_format": "text",
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "tests": [],
    }
    return json.dumps(content, indent=2) + "\n"
