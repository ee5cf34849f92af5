"""A seccomp filter: the system calls that student code is refused.

The list says what is denied, not what is allowed: numpy, SciPy and Python's own library go on working, and
a new harmless call needs no change here. A refused call fails with EPERM, as for somebody without the right,
and Python raises PermissionError. Calls in another architecture's numbering end the process.

Threads may be made, processes may not; a process may signal and limit itself, nobody else.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import struct
import sys
from collections.abc import Iterator, Sequence

from gpcourse.sandbox.landlock import no_new_privileges

#: Name, number on x86_64, number on aarch64; a dash where it does not exist.
_DENIED = """
# processes: no other program, no second process
fork 57 -, vfork 58 -, execve 59 221, execveat 322 281,
# sockets: no network, and no other process on this machine
socket 41 198, socketpair 53 199, connect 42 203, bind 49 200, listen 50 201, accept 43 202,
accept4 288 242,
# other processes: not looked into, signalled or slowed down
ptrace 101 117, process_vm_readv 310 270, process_vm_writev 311 271, process_madvise 440 440,
process_mrelease 448 448, kcmp 312 272, pidfd_open 434 434, pidfd_send_signal 424 424,
pidfd_getfd 438 438, tkill 200 130, rt_sigqueueinfo 129 138, rt_tgsigqueueinfo 297 240,
setpriority 141 140, ioprio_set 251 30, sched_setscheduler 144 119, sched_setparam 142 118,
sched_setattr 314 274, migrate_pages 256 238, move_pages 279 239,
# kernel services that hold code or memory outside the limits
memfd_create 319 279, memfd_secret 447 447, io_uring_setup 425 425, io_uring_enter 426 426,
io_uring_register 427 427, keyctl 250 219, add_key 248 217, request_key 249 218, bpf 321 280,
perf_event_open 298 241, userfaultfd 323 282, seccomp 317 277, modify_ldt 154 -, personality 135 92,
iopl 172 -, ioperm 173 -,
# namespaces and mounts: no other view of the files
unshare 272 97, setns 308 268, mount 165 40, umount2 166 39, pivot_root 155 41, chroot 161 51,
open_tree 428 428, move_mount 429 429, fsopen 430 430, fsconfig 431 431, fsmount 432 432, fspick 433 433,
mount_setattr 442 442, name_to_handle_at 303 264, open_by_handle_at 304 265,
# the machine as a whole
init_module 175 105, finit_module 313 273, delete_module 176 106, kexec_load 246 104,
kexec_file_load 320 294, reboot 169 142, swapon 167 224, swapoff 168 225, sethostname 170 161,
setdomainname 171 162, settimeofday 164 170, clock_settime 227 112, adjtimex 159 171,
clock_adjtime 305 266, acct 163 89, quotactl 179 60, quotactl_fd 443 443, syslog 103 116, vhangup 153 58,
# what Landlock leaves open: modes, owners, times, a file cut short by its name
chmod 90 -, fchmod 91 52, fchmodat 268 53, fchmodat2 452 452, chown 92 -, fchown 93 55, lchown 94 -,
fchownat 260 54, utime 132 -, utimes 235 -, futimesat 261 -, utimensat 280 88, setxattr 188 5,
lsetxattr 189 6, fsetxattr 190 7, removexattr 197 14, lremovexattr 198 15, fremovexattr 199 16,
truncate 76 45,
# what would outlive the scratch folder, or tell what others do
mq_open 240 180, mq_unlink 241 181, msgget 68 186, msgsnd 69 189, msgrcv 70 188, msgctl 71 187,
semget 64 190, semop 65 193, semctl 66 191, semtimedop 220 192,
shmget 29 194, shmat 30 196, shmctl 31 195, inotify_init 253 -,
inotify_init1 294 26, inotify_add_watch 254 27, fanotify_init 300 262, fanotify_mark 301 263,
"""

#: Numbers, on x86_64 and aarch64, of calls that depend on an argument, and how the kernel names the machine.
_CLONE, _CLONE3, _KILL, _TGKILL, _PRLIMIT, _AFFINITY, _PRCTL, _FCNTL = (
    (56, 220), (435, 435), (62, 129), (234, 131), (302, 261), (203, 122), (157, 167), (72, 25),
)  # fmt: skip
_MACHINES = ("x86_64", "aarch64")
_AUDIT = (0xC000003E, 0xC00000B7)
_X32 = 0x40000000

_CLONE_THREAD = 0x10000
#: Options of prctl that name a thread or a piece of memory, or ask what holds.
_HARMLESS = (3, 15, 16, 21, 23, 39, 0x53564D41)
#: Commands of fcntl that let the kernel signal a process of one's choice when a pipe has something to read:
#: whoever reads the answers, with any signal. (F_SETOWN, F_SETSIG, F_SETOWN_EX)
_SIGNALLING = (8, 10, 15)

_KILL_PROCESS, _ALLOW, _ERRNO = 0x80000000, 0x7FFF0000, 0x00050000
_LOAD, _EQUAL, _AT_LEAST, _ANY_BIT, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_NUMBER_AT, _ARCH_AT, _ARGUMENT_AT, _SECOND_AT = 0, 4, 16, 24
_SECCOMP, _MODE_FILTER = 22, 2

Instruction = tuple[int, int, int, int]  # code, jump if true, jump if false, constant


class _Program(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.c_void_p))


def confine() -> None:
    """Filter the system calls of this process and all its threads, from now on and for good.

    Raises OSError if there is no filter for this machine, or
    the kernel refuses it.
    """
    if not sys.platform.startswith("linux") or platform.machine() not in _MACHINES or sys.maxsize < 2**32:
        raise OSError(errno.ENOSYS, f"there is no filter for {platform.machine()} with {sys.platform}")
    no_new_privileges()
    program = list(_filter(_MACHINES.index(platform.machine()), os.getpid()))
    code = b"".join(struct.pack("HBBI", *instruction) for instruction in program)
    buffer = ctypes.create_string_buffer(code, len(code))
    argument = _Program(len(program), ctypes.cast(buffer, ctypes.c_void_p))
    if ctypes.CDLL(None, use_errno=True).prctl(_SECCOMP, _MODE_FILTER, ctypes.byref(argument), 0, 0):
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def denied(machine: int) -> dict[str, int]:
    """Return the names and numbers of the calls that are always refused; `machine` indexes _MACHINES."""
    lines = (line for line in _DENIED.splitlines() if not line.startswith("#"))
    entries = (entry.split() for entry in " ".join(lines).split(",") if entry.strip())
    return {entry[0]: int(entry[1 + machine]) for entry in entries if entry[1 + machine] != "-"}


def _filter(machine: int, own: int) -> Iterator[Instruction]:
    """Yield the program: each rule leaves the number of the call where it was for the next one."""
    yield _LOAD, 0, 0, _ARCH_AT
    yield _EQUAL, 1, 0, _AUDIT[machine]
    yield _RETURN, 0, 0, _KILL_PROCESS
    yield _LOAD, 0, 0, _NUMBER_AT
    yield _AT_LEAST, 0, 1, _X32
    yield _RETURN, 0, 0, _KILL_PROCESS
    for number in denied(machine).values():
        yield from _refuse(number, errno.EPERM)
    yield from _refuse(_CLONE3[machine], errno.ENOSYS)  # its flags lie in memory; callers then use clone
    yield from _depends(_CLONE[machine], _ANY_BIT, (_CLONE_THREAD,))
    for call in (_KILL, _TGKILL):
        yield from _depends(call[machine], _EQUAL, (own,))
    for call in (_PRLIMIT, _AFFINITY):
        yield from _depends(call[machine], _EQUAL, (0, own))
    yield from _depends(_PRCTL[machine], _EQUAL, _HARMLESS)
    yield from _refuse_second(_FCNTL[machine], _SIGNALLING)
    yield _RETURN, 0, 0, _ALLOW


def _refuse(number: int, code: int) -> Iterator[Instruction]:
    yield _EQUAL, 0, 1, number
    yield _RETURN, 0, 0, _ERRNO | code


def _refuse_second(number: int, refused: Sequence[int]) -> Iterator[Instruction]:
    """Refuse the call `number` if its second argument is one of the constants `refused`."""
    yield _EQUAL, 0, len(refused) + 3, number
    yield _LOAD, 0, 0, _SECOND_AT
    for i, constant in enumerate(refused):
        yield _EQUAL, len(refused) - i, 0, constant
    yield _RETURN, 0, 0, _ALLOW
    yield _RETURN, 0, 0, _ERRNO | errno.EPERM


def _depends(number: int, test: int, allowed: Sequence[int]) -> Iterator[Instruction]:
    """Allow the call `number` if its first argument passes the `test` with one of the constants `allowed`."""
    yield _EQUAL, 0, len(allowed) + 3, number
    yield _LOAD, 0, 0, _ARGUMENT_AT
    for i, constant in enumerate(allowed):
        yield test, len(allowed) - i, 0, constant
    yield _RETURN, 0, 0, _ERRNO | errno.EPERM
    yield _RETURN, 0, 0, _ALLOW
