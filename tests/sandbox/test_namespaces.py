"""Workers of an ordinary user: the way through a user namespace, taken here whoever runs the tests."""

import time
from pathlib import Path

import pytest

from gpcourse.sandbox import confine, home, proxy
from gpcourse.sandbox.forking import can_fork
from gpcourse.sandbox.proxy import Worker

if not can_fork():
    pytest.skip("this system forks no workers", allow_module_level=True)

#: What root may do at once is left out, so that it goes the way of the others.
AS_ROOT = "    if _libc().unshare(kinds) == 0:\n        return\n    if ctypes.get_errno() != errno.EPERM:\n"
AS_USER = "    if False:\n"


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    package = home.build(tmp_path_factory.mktemp("run") / "home")
    path = package / "gpcourse" / "sandbox" / "namespaces.py"
    text = path.read_text("utf-8")
    assert text.count(AS_ROOT) == 1
    path.write_text(text.replace(AS_ROOT, AS_USER), "utf-8")
    return package


@pytest.fixture(scope="module")
def launch(package):
    with confine.launcher(package) as launch:
        line = launch(package, confine.Limits())
        line.close()
        if line.confinement.level != "full":
            pytest.skip(f"user namespaces cannot be made here: {line.confinement.missing}")
        yield launch


def asked(launch, package, *cells):
    return Worker(list(enumerate(cells, start=1)), package, confine.Limits(patience=1.0), launch)


def test_two_workers_at_once_are_alone_and_each_has_its_folder(launch, package):
    cell = (
        "import os\n"
        "def f(n):\n"
        "    open('mine', 'a').write(str(n))\n"
        "    return open('mine').read(), os.getpid(), os.path.exists('/proc/1')"
    )
    with asked(launch, package, cell) as one, asked(launch, package, cell) as two:
        assert one.ask("f", (1,), {}, 2.0).value == ("1", 1, False)
        assert two.ask("f", (2,), {}, 2.0).value == ("2", 1, False)
        assert one.ask("f", (3,), {}, 2.0).value[0] == "13"


def test_the_clock_of_a_worker_is_read_by_its_number_here(launch, package, monkeypatch):
    """A loop in compiled code is ended by its processor time, long before its time on the clock is up."""
    w = asked(launch, package, "def f(): return sum(range(10**11))\ndef g(): return 1")
    w.limits = confine.Limits(patience=100.0)
    monkeypatch.setattr(proxy, "GRACE", 0.3)
    start = time.monotonic()
    assert w.ask("f", (), {}, 0.1).status == "timeout"
    assert time.monotonic() - start < w.limits.wall(0.1) / 2
    assert w.ask("g", (), {}, 1.0).value == 1
    w.close()


def test_a_crash_is_told_and_nothing_is_left(launch, package):
    with asked(launch, package, "import ctypes\ndef f(): return ctypes.string_at(0)\ndef g(): return 1") as w:
        assert "SIGSEGV" in w.ask("f", (), {}, 1.0).trouble.message
        assert w.ask("g", (), {}, 1.0).value == 1
    assert not list(package.parent.glob("scratch-*"))


def test_all_end_with_the_grader(package):
    with confine.launcher(package) as launch:
        line = launch(package, confine.Limits())
        assert line.process.code() is None
    place, end = Path(f"/proc/{line.process.pid}"), time.monotonic() + 10
    while place.exists() and time.monotonic() < end:
        time.sleep(0.01)
    assert not place.exists()
    line.close()
