"""The probe tells what works here, and why what does not."""

import sys

import pytest

from gpcourse.sandbox import probe as probing
from gpcourse.sandbox.probe import probe


def test_each_layer_has_a_word():
    layers = probe()
    assert [layer.name for layer in layers] == [
        "own process", "resource limits", "namespaces", "Landlock", "seccomp",
    ]  # fmt: skip
    assert layers[0].works
    assert all(layer.words for layer in layers)


def test_the_kernels_reason_is_said(monkeypatch):
    monkeypatch.setattr(probing, "_in_child", lambda code: "namespaces: Operation not permitted")
    assert probing._namespaces() == "Operation not permitted"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory is limited on Linux")
def test_memory_can_be_limited_on_linux():
    assert next(layer for layer in probe() if layer.name == "resource limits").works


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="these are of Linux")
def test_a_layer_that_forbids_nothing_does_not_count(monkeypatch):
    assert probing._tried(probing._FORBIDDEN_CALL) in ("works", "the kernel says: Function not implemented")
    idle = "def confine(*_): pass\ndef forbidden(): pass\n"
    assert probing._tried(idle) == "it is there and forbids nothing"
