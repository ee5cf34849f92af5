"""What is granted around what is hidden, and what the filter of system calls says on either machine."""

import errno
import os

import pytest

from gpcourse.sandbox import landlock, seccomp
from gpcourse.sandbox.lockdown import LEVELS, Confinement

MACHINES = {"x86_64": 0, "aarch64": 1}
OWN = 4242
REFUSED, ALLOWED, KILLED = 0x50000 | errno.EPERM, 0x7FFF0000, 0x80000000


def tree(folder, *files):
    for name in files:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("")
    return folder.resolve()


def may_read(path, grants):
    """Tell whether the contents of a file are granted, as the kernel does: by any folder above it."""
    return any(allowed & landlock._READ_FILE and path.is_relative_to(root) for root, allowed in grants)


def test_all_is_readable_but_what_is_hidden(tmp_path):
    root = tree(
        tmp_path, "site/numpy/a.py", "site/six.py", "site/gpcourse/reference/a.py", "site/gpcourse.pth"
    )
    hidden = [root / "site/gpcourse", root / "site/gpcourse.pth"]
    grants = list(landlock.readings([root, root / "site"], hidden))
    readable = {str(p.relative_to(root)) for p in root.rglob("*") if p.is_file() and may_read(p, grants)}
    assert readable == {"site/numpy/a.py", "site/six.py"}
    assert (root / "site", landlock._READ_DIR) in grants  # imports list it


@pytest.mark.skipif(os.name == "nt", reason="links need rights on Windows")
def test_a_link_does_not_lead_to_what_is_hidden(tmp_path):
    root = tree(tmp_path, "site/gpcourse/a.py", "site/b.py")
    (root / "site/alias").symlink_to(root / "site/gpcourse")
    grants = list(landlock.readings([root / "site", root / "site/alias"], [root / "site/gpcourse"]))
    assert not may_read(root / "site/gpcourse/a.py", grants)
    assert may_read(root / "site/b.py", grants)


def decision(machine, number, argument=0, arch=None, second=0):
    """Run the filter on one call, as the kernel does."""
    program = list(seccomp._filter(machine, OWN))
    data = {
        0: number,
        4: seccomp._AUDIT[machine] if arch is None else arch,
        16: argument & 0xFFFFFFFF,
        24: second,
    }
    at = value = 0
    while True:
        code, if_true, if_false, constant = program[at]
        at += 1
        if code == seccomp._RETURN:
            return constant
        if code == seccomp._LOAD:
            value = data[constant]
            continue
        holds = {
            seccomp._EQUAL: value == constant,
            seccomp._AT_LEAST: value >= constant,
            seccomp._ANY_BIT: bool(value & constant),
        }[code]
        at += if_true if holds else if_false


@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)
def test_the_filter_refuses_what_it_lists_and_nothing_else(machine):
    denied = seccomp.denied(machine)
    assert {"execve", "socket", "ptrace", "memfd_create", "io_uring_setup", "keyctl", "bpf"} <= denied.keys()
    assert len(set(denied.values())) == len(denied)
    assert {decision(machine, number) for number in denied.values()} == {REFUSED}
    depending = {pair[machine] for pair in (
        seccomp._CLONE, seccomp._CLONE3, seccomp._KILL, seccomp._TGKILL, seccomp._PRLIMIT,
        seccomp._AFFINITY, seccomp._PRCTL, seccomp._FCNTL,
    )}  # fmt: skip
    others = set(range(500)) - set(denied.values()) - depending
    assert {decision(machine, number) for number in others} == {ALLOWED}


@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)
@pytest.mark.parametrize(
    ("call", "argument", "seen"),
    [
        (seccomp._CLONE, 0x3D0F00, ALLOWED), (seccomp._CLONE, 17, REFUSED), (seccomp._CLONE, 0x4111, REFUSED),
        (seccomp._CLONE3, 0, 0x50000 | errno.ENOSYS), (seccomp._KILL, OWN, ALLOWED),
        (seccomp._KILL, 1, REFUSED), (seccomp._KILL, -1, REFUSED), (seccomp._KILL, 0, REFUSED),
        (seccomp._TGKILL, OWN, ALLOWED), (seccomp._TGKILL, 1, REFUSED), (seccomp._PRLIMIT, 0, ALLOWED),
        (seccomp._PRLIMIT, OWN, ALLOWED), (seccomp._PRLIMIT, 1, REFUSED), (seccomp._PRCTL, 15, ALLOWED),
        (seccomp._PRCTL, 22, REFUSED), (seccomp._PRCTL, 4, REFUSED),
    ],
)  # fmt: skip
def test_calls_that_depend_on_their_first_argument(machine, call, argument, seen):
    assert decision(machine, call[machine], argument) == seen


@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)
def test_no_pipe_signals_another_process(machine):
    """fcntl: F_SETOWN, F_SETSIG and F_SETOWN_EX are refused; F_GETFL, F_SETFL and F_SETLK are not."""
    fcntl = seccomp._FCNTL[machine]
    assert [decision(machine, fcntl, 9, second=c) for c in (8, 10, 15)] == [REFUSED] * 3
    assert [decision(machine, fcntl, 8, second=c) for c in (3, 4, 6)] == [ALLOWED] * 3


@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)
def test_calls_of_another_architecture_end_the_process(machine):
    assert decision(machine, 1, arch=0x40000003) == KILLED  # 32 bits
    assert decision(machine, 0x40000000 | 39) == KILLED  # the x32 numbers


def test_the_levels_are_ordered():
    assert [Confinement("restricted").reaches(level) for level in LEVELS] == [True, True, False]
