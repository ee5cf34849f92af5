"""Work that is right, however it is written: it deserves every point."""

from dataclasses import dataclass
from textwrap import indent


@dataclass(frozen=True)
class Work:
    """A cell that defines ``twice`` for whole numbers, or ``scaled`` for arrays, and what stands around it."""

    what: str
    cell: str
    name: str = "twice"

    @property
    def id(self):
        return self.what.replace(" ", "-")


def number(what, body, before=""):
    return Work(what, f"{before}\ndef twice(x):\n    ran()\n{indent(body, '    ')}")


def array(what, expression, before=""):
    """``scaled(v)`` is two times an array of shape (n, 3); y is that array, np is numpy."""
    body = f"    ran()\n    y = 2 * np.asarray(v)\n    {expression}"
    return Work(what, f"import numpy as np\n{before}\ndef scaled(v):\n{body}", "scaled")


NUMBERS = [
    number("prints", "for i in range(300): print(i, x, flush=True)\nreturn 2 * x"),
    number("prints on stderr", "import sys\nprint('x' * 10**5, file=sys.stderr)\nreturn 2 * x"),
    number(
        "warnings",
        "import warnings\nwarnings.warn('careful')\nimport numpy as np\nnp.log(-1.0)\nreturn 2 * x",
    ),
    number("logging", "import logging\nlogging.warning('x is %s', x)\nreturn 2 * x"),
    number(
        "a plot",
        "fig, ax = plt.subplots()\nax.plot([0, x])\nplt.show()\nreturn 2 * x",
        "import matplotlib.pyplot as plt",
    ),
    number(
        "a progress bar", "for _ in track(range(20)): pass\nreturn 2 * x", "from rich.progress import track"
    ),
    number(
        "a progress bar by hand",
        "for i in range(100): print(f'\\r{i} %', end='')\nprint('\\x1b[32m done \\x1b[0m')\nreturn 2 * x",
    ),
    number("a numpy number", "return np.float64(2 * x)", "import numpy as np"),
    number("an array of one number", "return np.array([[2.0 * x]])", "import numpy as np"),
    number("a list of one number", "return [2 * x]"),
    number("a whole float", "return 2.0 * x"),
    number("an int32", "return np.int32(2 * x)", "import numpy as np"),
    number("a fraction of numpy's", "return np.divide(4 * x, 2)", "import numpy as np"),
    number(
        "recursion",
        "return 0 if x == 0 else (2 + twice(x - 1) if x < 50 else 2 * twice(x // 2) + 2 * (x % 2))",
    ),
    number(
        "deep recursion",
        "def down(n): return 0 if n == 0 else 1 + down(n - 1)\nreturn 2 * x + down(3000) - 3000",
        "import sys\nsys.setrecursionlimit(5000)",
    ),
    number(
        "a class of one's own",
        "return (Pair(x) + Pair(x)).n",
        "class Pair:\n    def __init__(self, n): self.n = n\n    def __add__(self, o): return Pair(self.n + o.n)",
    ),
    number(
        "a dataclass",
        "return Box(x, x).sum()",
        "from dataclasses import dataclass\n@dataclass\nclass Box:\n    a: int\n    b: 'int'\n    def sum(self): return self.a + self.b",
    ),
    number("exercises that call each other", "return plus_one(x) + x - 1"),
    number("a comment in Chinese", "答案 = 2 * x  # 两倍\nreturn 答案"),
    number("an emoji", "print('🎉')\nreturn 2 * x"),
    Work("Windows line ends", "def twice(x):\r\n    ran()\r\n    y = x\r\n    return 2 * y\r\n"),
    Work("old Mac line ends in a text", "def twice(x):\n    ran('a\\r\\nb')\n    return 2 * x"),
    Work("tabs", "def twice(x):\n\tran()\n\tif x:\n\t\treturn 2 * x\n\treturn 0"),
    Work("a lambda", "twice = lambda x: ran() or 2 * x"),
    Work(
        "a cache", "from functools import lru_cache\n@lru_cache\ndef twice(x):\n    ran()\n    return 2 * x"
    ),
    Work(
        "a decorator of one's own",
        "def loud(f):\n    def g(x):\n        print(f, x)\n        return f(x)\n    return g\n@loud\ndef twice(x):\n    ran()\n    return 2 * x",
    ),
    Work(
        "a callable object",
        "class Twice:\n    def __call__(self, x):\n        ran()\n        return 2 * x\ntwice = Twice()",
    ),
    Work(
        "a partial function",
        "from functools import partial\ndef times(n, x):\n    ran()\n    return n * x\ntwice = partial(times, 2)",
    ),
    Work("a helper below", "def twice(x):\n    ran()\n    return helper(x)\ndef helper(x): return x + x"),
    Work(
        "annotations of the future",
        "from __future__ import annotations\ndef twice(x: Number) -> Vector[Number]:\n    ran()\n    return 2 * x",
    ),
    Work("names that come later", "def twice(x):\n    ran()\n    return FACTOR * x\nFACTOR = 1\nFACTOR += 1"),
    Work(
        "a table that a function fills",
        "T = {}\ndef fill():\n    T['k'] = 2\nfill()\ndef twice(x):\n    ran()\n    return T['k'] * x",
    ),
    Work(
        "functions in a registry",
        "R = {}\ndef register(f):\n    R[f.__name__] = f\n    return f\n@register\ndef g(x): return 2 * x\n"
        "def twice(x):\n    ran()\n    return R['g'](x)",
    ),
    Work(
        "functions called by their names",
        "def g(x): return 2 * x\ndef twice(x):\n    ran()\n    return globals()['g'](x)",
    ),
    Work("a function made from a text", "exec('def twice(x):\\n    ran()\\n    return 2 * x')"),
    Work(
        "magics and shell lines",
        "%matplotlib inline\n!pip install nothing\nfiles = !ls\ndef twice(x):\n    ran()\n    return 2 * x\n%timeit twice(3)",
    ),
    Work("a timed cell", "%%time\ndef twice(x):\n    ran()\n    return 2 * x"),
    Work(
        "calls of the course",
        "from gpcourse import check, hint, progress, solution, view, working\ndef twice(x):\n    ran()\n    return 2 * x\ncheck(twice)\nhint(twice)\nsolution(twice)\nprogress()\ntwice = working(twice)",
    ),
    Work(
        "a demonstration that fails",
        "def twice(x):\n    ran()\n    return 2 * x\nassert twice(3) == 7\nraise SystemExit",
    ),
    Work(
        "a demonstration that never ends", "def twice(x):\n    ran()\n    return 2 * x\nwhile True: twice(3)"
    ),
    Work(
        "a second definition that is right",
        "def twice(x): return 0\ndef twice(x):\n    ran()\n    return 2 * x",
    ),
    Work(
        "match and walrus",
        "def twice(x):\n    ran()\n    match (y := x):\n        case 0: return 0\n        case _: return 2 * y",
    ),
    number(
        "slow, but within its limit",
        "import time\nend = time.process_time() + 0.05\nwhile time.process_time() < end: pass\nreturn 2 * x",
    ),
    number("sleep", "import time\ntime.sleep(0.05)\nreturn 2 * x"),
    number(
        "threads",
        "with ThreadPoolExecutor(4) as pool: return sum(pool.map(int, [x, x]))",
        "from concurrent.futures import ThreadPoolExecutor",
    ),
    number(
        "random numbers",
        "r = random.random() + np.random.rand()\nreturn 2 * x + r - r",
        "import random\nimport numpy as np",
    ),
    number(
        "a file of its own",
        "with open('notes.txt', 'w') as f: f.write(str(2 * x))\nwith open('notes.txt') as f: return int(f.read())",
    ),
    number(
        "a folder for a while",
        "with tempfile.TemporaryDirectory() as d:\n    open(d + '/a', 'w').write('1')\n    return 2 * x",
        "import tempfile",
    ),
    number("a count of its calls", "global calls\ncalls += 1\nreturn 2 * x", "calls = 0"),
    number(
        "an exception that is caught", "try: return 2 * x + 1 / 0\nexcept ZeroDivisionError: return 2 * x"
    ),
    number("SciPy", "return float(special.gamma(3.0)) * x", "from scipy import special"),
]

ARRAYS = [
    array("a list of lists", "return y.tolist()"),
    array("a tuple of tuples", "return tuple(map(tuple, y.tolist()))"),
    array("a list of arrays", "return list(y)"),
    array("rows of Python numbers", "return [[float(a) for a in row] for row in y]"),
    array("single precision", "return y.astype(np.float32)"),
    array("columns first in memory", "return np.asfortranarray(y)"),
    array("high byte first", "return y.astype('>f8')"),
    array("a view with strides", "return np.repeat(y, 2, axis=0)[::2]"),
    array("a view backwards", "return y[::-1][::-1]"),
    array("an array that may not be written to", "y.flags.writeable = False\n    return y"),
    array("a matrix", "return np.matrix(y)"),
    array("a masked array", "return np.ma.masked_array(y)"),
    array("an array of objects", "return y.astype(object)"),
    array("a subclass", "return y.view(Own)", "class Own(np.ndarray): pass"),
    array("memory in a file", "m = np.memmap('m', float, 'w+', shape=y.shape)\n    m[:] = y\n    return m"),
    array("a class with an array in it", "return Own(y)", "class Own:\n    def __init__(self, y): self.y = y\n    def __array__(self, dtype=None, copy=None): return self.y"),
    array("a deque", "return deque(y.tolist())", "from collections import deque"),
    array("input changed in place", "v *= 2\n    return v"),
    array("long double", "return y.astype(np.longdouble)"),
    *(array(f"sparse {f}", f"return sparse.{f}_array(y)", "from scipy import sparse") for f in ("csr", "csc", "coo", "lil", "dok", "dia", "bsr")),
    array("a sparse matrix of old", "return sparse.csr_matrix(y)", "from scipy import sparse"),
    array("sparse with entries twice", "return sparse.coo_array((np.tile(y.ravel() / 2, 2), (np.tile(i.ravel(), 2), np.tile(j.ravel(), 2))), shape=y.shape)", "from scipy import sparse\ni, j = np.indices((5, 3))"),
]  # fmt: skip

HONEST = [*NUMBERS, *ARRAYS]
