import pytest

from gpcourse.notebook import guidance


@pytest.fixture(autouse=True)
def own_progress(tmp_path, monkeypatch):
    """Every test has a progress file of its own, and has seen no hint."""
    path = tmp_path / "progress.json"
    monkeypatch.setenv("GPCOURSE_PROGRESS", str(path))
    monkeypatch.setattr(guidance, "_given", {})
    monkeypatch.setattr(guidance, "_offered", set())
    return path
