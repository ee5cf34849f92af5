"""The folder that a worker imports `gpcourse` from: geometry and sandbox, no checks, no solutions."""

from __future__ import annotations

import compileall
import shutil
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent

#: The modules of the sandbox that run in the worker.
_SANDBOX = (
    "__init__", "call", "deadline", "values", "encoding", "decoding", "wire", "program", "effects", "worker",
    "landlock", "seccomp", "lockdown", "namespaces", "parent",
)  # fmt: skip

#: Where in the folder matplotlib finds its list of fonts, which takes it seconds to make.
FONTS = "matplotlib"


def build(folder: Path, *, fonts: bool = False) -> Path:
    """Make the reduced package in a new `folder`, and return it.

    The folder around it should be a new one too: others may then pass through it, not list it.

    Submodules of `gpcourse.reference` are there by name, so that a notebook's imports do not fail; calling
    what should be in them says that it is not there.
    """
    home = folder / "gpcourse"
    standin = PACKAGE / "sandbox" / "standin"
    folder.mkdir(parents=True)
    folder.chmod(0o755)
    folder.parent.chmod(0o711)  # a worker that was started by root becomes somebody else
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
    if fonts:
        _copy_fonts(folder / FONTS)
    compileall.compile_dir(folder, quiet=2)
    return folder


def _copy_fonts(folder: Path) -> None:
    import matplotlib as mpl
    import matplotlib.font_manager  # makes the list where there is none yet

    folder.mkdir()
    for cache in Path(mpl.get_cachedir()).glob("fontlist*.json"):
        shutil.copy(cache, folder)
