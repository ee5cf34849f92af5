"""The folder that a worker imports `gpcourse` from: geometry and sandbox, no checks, no solutions."""

from __future__ import annotations

import compileall
import shutil
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent

#: The modules of the sandbox that run in the worker.
_SANDBOX = ("__init__", "call", "deadline", "values", "encoding", "decoding", "wire", "program", "worker")


def build(folder: Path) -> Path:
    """Make the reduced package in `folder`, which exists, and return `folder`.

    Submodules of `gpcourse.reference` are there by name, so that a notebook's imports do not fail; calling
    what should be in them says that it is not there.
    """
    home = folder / "gpcourse"
    standin = PACKAGE / "sandbox" / "standin"
    shutil.copytree(PACKAGE / "geometry", home / "geometry", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(PACKAGE / "errors.py", home)
    (home / "sandbox").mkdir()
    for name in _SANDBOX:
        shutil.copy(PACKAGE / "sandbox" / f"{name}.py", home / "sandbox")
    shutil.copy(standin / "package.py", home / "__init__.py")
    shutil.copy(standin / "silent.py", home / "view.py")
    shutil.copy(standin / "silent.py", home / "notebook.py")
    (home / "reference").mkdir()
    for module in (PACKAGE / "reference").glob("[!.]*"):
        if module.name != "__pycache__":
            shutil.copy(standin / "absent.py", home / "reference" / f"{module.stem}.py")
    compileall.compile_dir(folder, quiet=2)
    return folder
