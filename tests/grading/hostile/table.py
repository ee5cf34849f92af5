"""Hostile functions: what each does, what it deserves, and what it must have left in its own folder.

Each is a notebook cell that defines ``twice``, which should return two times its argument. `ran` and
`attempt` write into the working folder: `says` has to be found there, so that no attack passes for harmless
because it never ran, and "did it" must not be, which `attempt` writes when what it tries succeeds. OUTSIDE
stands for a folder with another submission and a grade book, COURSE for the installed package.
"""

from dataclasses import dataclass
from textwrap import indent

TOOLS = """
import os, sys
def ran(what="ran"):
    with open(os.path.join(os.environ["HOME"], "ran.txt"), "a") as file:
        file.write(f"{what}\\n")
def attempt(action):
    try:
        ran(f"did it: {action()!r}"[:300])
    except BaseException as error:
        ran(f"{type(error).__name__}: {error}")
"""


@dataclass(frozen=True)
class Attack:
    """`deserves` names the outcomes that are true; a point is deserved only by ``passed``."""

    what: str
    cell: str
    deserves: tuple[str, ...]
    says: str = "ran"
    confined: bool = False

    @property
    def name(self):
        return self.what.replace(" ", "-")


def function(what, body, *deserves, says="ran", confined=False):
    return Attack(what, "def twice(x):\n" + indent(body, "    "), deserves, says, confined)


def cell(what, code, *deserves, says="ran"):
    return Attack(what, code, deserves, says)


def tries(what, *actions, setup="", says="PermissionError", confined=True):
    """A function that tries what it should not and then answers well: it deserves its points."""
    body = "\n".join([*setup.splitlines(), *(f"attempt(lambda: {a})" for a in actions), "return 2 * x"])
    return function(what, body, "passed", says=says, confined=confined)


ENDING = [
    function("endless loop", "ran()\nwhile True: pass", "timeout"),
    cell(
        "endless loop at import",
        "y = ran()\nwhile True:\n    y = 1\ndef twice(x): return y * ran()",
        "timeout",
    ),
    function(
        "loop that swallows everything",
        "ran()\nwhile True:\n    try:\n        while True: pass\n    except BaseException: pass",
        "timeout",
    ),
    function("loop in compiled code", "ran()\nreturn sum(range(10**12))", "timeout"),
    function(
        "signals ignored",
        "ran()\nimport signal\nfor s in range(1, 32):\n    try: signal.signal(s, signal.SIG_IGN)\n"
        "    except (OSError, ValueError): pass\nwhile True: pass",
        "timeout",
    ),
    function("os._exit", "ran()\nos._exit(0)", "crashed"),
    cell("os._exit at import", "y = ran() or os._exit(0)\ndef twice(x): return y * ran()", "crashed"),
    function("exit by ctypes", "ran()\nimport ctypes\nctypes.CDLL(None)._exit(0)", "crashed"),
    function("sys.exit", "ran()\nsys.exit(0)", "error"),
    # Alone in its numbering of processes it is the first one, which cannot signal itself.
    function("SIGKILL to itself", "ran()\nos.kill(os.getpid(), 9)", "crashed", "failed"),
    function("segmentation fault", "ran()\nimport ctypes\nctypes.string_at(0)", "crashed"),
    function("recursion", "if x > 0: ran()\nreturn twice(-abs(x) - 1)", "error"),
    function(
        "thread that never ends",
        "ran()\nimport threading, time\nthreading.Thread(target=time.sleep, args=(1000,)).start()\nreturn 2 * x",
        "passed",
    ),
    function(
        "exit handler that hangs",
        "ran()\nimport atexit, time\natexit.register(time.sleep, 1000)\nreturn 2 * x",
        "passed",
    ),
    function("fork bomb", "ran()\nwhile True: os.fork()", "error", confined=True),
    tries("orphan after a double fork", "os.fork() or (os.setsid(), os.fork())"),
    function("input", "ran()\nreturn int(input())", "error"),
]

RESOURCES = [
    function("one huge allocation", "ran()\nreturn bytearray(10**13)", "out of memory"),
    function(
        "memory that grows",
        "ran()\nimport numpy as np\nheld = []\nwhile True: held.append(np.zeros(2**22))",
        "out of memory",
        "timeout",  # macOS limits no memory
    ),
    function(
        "output flood",
        "ran()\nfor fd in (1, 2):\n    for _ in range(200): os.write(fd, b'x' * 10**6)\nreturn 2 * x",
        "passed",
    ),
    tries("one file that fills the disk", "open('big', 'wb').truncate(10**12)", says="OSError", confined=False),
    function("endless iterator as result", "ran()\nimport itertools\nreturn itertools.count()", "failed", "error"),
    function(
        "endless list as result",
        "ran()\nclass Endless(list):\n    def __len__(self): return 2\n    def __iter__(self):\n"
        "        while True: pass\nreturn Endless()",
        "timeout",
    ),
    function("range of a million millions", "ran()\nreturn range(10**12)", "error"),
    function(
        "array of a thousand million zeros",
        "ran()\nimport numpy as np\nreturn np.broadcast_to(0.0, 10**9)",
        "error", "out of memory",
    ),
]  # fmt: skip

TAMPERING = [
    function(
        "patched numpy",
        "ran()\nimport numpy as np, numpy.testing as t\n"
        "np.allclose = np.isclose = np.array_equal = lambda *a, **k: True\n"
        "t.assert_allclose = t.assert_equal = lambda *a, **k: None\nreturn 0",
        "failed",
    ),
    function(
        "patched builtins",
        "ran()\nimport builtins\nbuiltins.AssertionError = builtins.ValueError = KeyError\n"
        "builtins.abs = lambda *a: 0\nbuiltins.isinstance = lambda *a: True\nreturn 0",
        "failed", "error", "crashed",
    ),
    function(
        "sys.modules emptied",
        "ran()\nfor name in list(sys.modules):\n    if 'gpcourse' in name: del sys.modules[name]\nreturn 0",
        "failed",
    ),
    function(
        "the worker's own module patched",
        "ran()\nfrom gpcourse.sandbox import worker\n"
        "worker._message = lambda answer, number: {'number': number, 'status': 'passed', 'points': 99}\nreturn 0",
        "crashed", "error",
    ),
    function(
        "later answers replaced",
        "ran()\nfrom gpcourse.sandbox import worker\n"
        "worker.call = lambda *a, **k: worker.Answer('returned', 0)\nreturn 0",
        "failed",
    ),
    function(
        "frames searched",
        "frame, seen = sys._getframe(), set()\nwhile frame:\n    seen |= set(frame.f_locals) | set(frame.f_globals)\n"
        "    frame = frame.f_back\nran(sorted(seen & {'Exercise', 'judge', 'expected', 'seed', 'rng', 'verdict'}))\n"
        "return 0",
        "failed", says="[]",
    ),
    function(
        "memory searched",
        "import gc\nran(sorted({type(o).__name__ for o in gc.get_objects()} & {'Exercise', 'Verdict', 'Check'}))\n"
        "return 0",
        "failed", says="[]",
    ),
    tries(
        "checks and reference imported",
        "importlib.import_module('gpcourse.exercises')", "importlib.import_module('gpcourse.grading')",
        "importlib.import_module('gpcourse.reference.welcome').triangle_area(1, 2, 3)",
        setup="import importlib", says="ModuleNotFoundError", confined=False,
    ),
    tries(
        "reference imported from its place",
        "importlib.import_module('gpcourse.reference.halfedge').genus.__code__",
        setup="import importlib\nsys.path.insert(0, os.path.dirname('COURSE'))\n"
        "for name in [n for n in sys.modules if n.startswith('gpcourse')]: del sys.modules[name]\n"
        "importlib.invalidate_caches()",
        says="Error",
    ),
    tries(
        "reference read", "open('COURSE/reference/halfedge.py').read()", "os.listdir('COURSE/reference')",
        "open('COURSE/exercises/welcome.py').read()",
    ),
    tries("the folder above", "os.listdir('..')", "open('../mine', 'w')", "os.symlink('/etc', '../x')"),
    tries(
        "the grader's process", "open(f'/proc/{(os.getppid() or 10**6)}/environ', 'rb').read()",
        "open(f'/proc/{(os.getppid() or 10**6)}/mem', 'rb')", "os.listdir(f'/proc/{(os.getppid() or 10**6)}/fd')",
        "os.kill((os.getppid() or 10**6), 15)", "resource.prlimit((os.getppid() or 10**6), resource.RLIMIT_CPU, (1, 1))",
        setup="import resource",
    ),
    tries("another submission", "open('OUTSIDE/bob.ipynb').read()", "os.listdir('OUTSIDE')"),
    tries("a link to another submission", "open(f'link{x}').read()", setup="os.symlink('OUTSIDE/bob.ipynb', f'link{x}')"),
    function("the environment", "ran([k for k in os.environ if 'SECRET' in k])\nreturn 2 * x", "passed", says="[]"),
    tries(
        "grade book changed", "open('OUTSIDE/grades.csv', 'a').write('ada,99')", "os.remove('OUTSIDE/grades.csv')",
        "os.rename('OUTSIDE/grades.csv', 'mine')", "os.truncate('OUTSIDE/grades.csv', 0)",
        "os.chmod('OUTSIDE/grades.csv', 0o666)", "os.utime('OUTSIDE/grades.csv', (0, 0))",
        "os.mkdir('OUTSIDE/new')",
    ),
    tries(
        "sockets", "socket.socket()", "socket.socketpair()", "socket.socket(socket.AF_UNIX)",
        "socket.create_connection(('127.0.0.1', 22), 1)", setup="import socket",
    ),
    tries(
        "other programs", "subprocess.run(['true'])", "os.execv('/bin/true', ['true'])",
        "os.posix_spawn('/bin/true', ['true'], {})", setup="import subprocess",
    ),
    function(
        "forged verdict on every descriptor",
        "ran()\nfrom gpcourse.sandbox import wire\nfor fd in range(64):\n    try:\n"
        "        os.write(fd, wire.pack({'number': 1, 'status': 'returned', 'value': 2 * x, 'points': 9}))\n"
        "    except OSError: pass\nreturn 0",
        "crashed", "failed",
    ),
    function(
        "forged verdict on stdout",
        "ran()\nprint('passed', {'status': 'passed', 'points': 9}, file=sys.__stdout__, flush=True)\nreturn 0",
        "failed",
    ),
    function(
        "a result that equals everything",
        "ran()\nclass Same:\n    def __eq__(self, other): return True\n    __hash__ = None\n"
        "    def __array__(self, *a, **k): ran('array'); return 0\n"
        "    def __array_function__(self, *a): return True\nreturn Same()",
        "failed", "error",
    ),
    function(
        "an array that equals everything",
        "ran()\nimport numpy as np\nclass Same(np.ndarray):\n    def __eq__(self, other): return np.True_\n"
        "    __array_ufunc__ = lambda self, *a, **k: 0.0\nreturn np.zeros(()).view(Same)",
        "failed", "error",
    ),
    function(
        "a pickle",
        "ran()\nimport pickle\nclass Bomb:\n    def __reduce__(self): return os.mkdir, ('OUTSIDE/pwned',)\n"
        "return pickle.dumps(Bomb()) if x > 4 else Bomb()",
        "failed", "error",
    ),
    cell(
        "state between calls",
        "calls = []\ndef twice(x):\n    ran()\n    calls.append(x)\n    return 2 * x if len(calls) == 1 else 0",
        "failed",
    ),
    function(
        "works only outside of grading",
        "ran(sys.argv)\nhere = ('pytest', 'gpcourse.grading', 'ipykernel')\n"
        "seen = any(n in sys.modules for n in here) or len(sys.argv) > 1 or 'PYTEST_CURRENT_TEST' in os.environ\n"
        "return 2 * x if seen else 0",
        "failed", says="['']",
    ),
]  # fmt: skip

ATTACKS = [*ENDING, *RESOURCES, *TAMPERING]
