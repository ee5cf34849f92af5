"""The examples of docs/viewer.md run, each after the ones before it."""

import ast
import re
from pathlib import Path

import pytest

from gpcourse import view

PAGE = (Path(__file__).parents[2] / "docs" / "viewer.md").read_text("utf-8")


def test_the_examples_of_the_page_on_pictures_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    pictures = []
    for block in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        for statement in ast.parse(block).body:
            if isinstance(statement, ast.Expr):
                pictures.append(eval(compile(ast.Expression(statement.value), "viewer.md", "eval"), names))
            else:
                exec(compile(ast.Module([statement], []), "viewer.md", "exec"), names)
    shown = [picture for picture in pictures if picture is not None]  # save() gives nothing
    assert all(isinstance(picture, view.Picture) and picture.page() for picture in shown)
    assert len(shown) >= 14
    assert sorted(path.name for path in tmp_path.iterdir()) == ["torus.html", "torus.pdf", "torus.png"]


@pytest.mark.parametrize("name", [n for n in view.__all__ if n.islower() and n not in ("scene",)])
def test_every_function_that_draws_is_on_the_page(name):
    assert name.endswith("_scene") or f"view.{name}(" in PAGE
