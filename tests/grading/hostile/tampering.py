"""Code that wants points it does not deserve, or something of somebody else."""

from attack import cell, function, tries

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

    cell(
        "right only at leisure",
        "import time\nlast = [0.0]\ndef twice(x):\n    ran()\n    pause, last[0] = time.monotonic() - last[0], time.monotonic()\n"
        "    return 2 * x if pause > 30 else 0",
        "failed",
    ),
    function(
        "feedback that is to tell",
        "ran()\nraise ValueError(repr([sys._getframe(i).f_locals for i in range(9)]) if 0 else '{expected} %(seed)s {0.__class__} {{ verdict }}')",
        "error",
    ),
    function("ufuncs patched", "ran()\nimport numpy as np\nnp.add = np.subtract = np.abs = np.less_equal = np.isfinite = lambda *a, **k: True\nreturn 0", "failed"),
    function(
        "a false grader put into sys.modules",
        "ran()\nimport types\nfor name in ('exercises', 'exercises.expect', 'exercises.judging', 'grading', 'grading.judge'):\n"
        "    module = sys.modules['gpcourse.' + name] = types.ModuleType(name)\n    module.judge = module.close = lambda *a, **k: True\nreturn 0",
        "failed",
    ),
    function("pytest faked", "ran()\nimport types\nfake = sys.modules['pytest'] = types.ModuleType('pytest')\nfake.approx = fake.raises = lambda *a, **k: x\nreturn 0", "failed"),
    function("import and open patched", "ran()\nimport builtins\nbuiltins.__import__ = builtins.open = builtins.len = builtins.type = lambda *a, **k: None\nreturn 0", "failed", "crashed", "error"),
    function("json patched", "ran()\nimport json\njson.dumps = lambda *a, **k: '[[\"dict\",[\"number\",1],[\"status\",\"passed\"]],[]]'\nreturn 0", "crashed", "failed"),
    function("struct patched", "ran()\nfrom gpcourse.sandbox import wire\nwire.MAGIC = b'none'\nreturn 0", "crashed"),
    function(
        "the coder patched",
        "ran()\nfrom gpcourse.sandbox import encoding, wire\nwire.MAX_BUFFERS = wire.MAX_HEADER = encoding.MAX_ITEMS = 2**40\nreturn [0] * 6 * 10**5",
        "crashed", "timeout", "failed",
    ),
    function(
        "transformers of IPython",
        "ran()\nfrom IPython.core.interactiveshell import InteractiveShell\nshell = InteractiveShell.instance()\n"
        "shell.input_transformers_cleanup.append(lambda lines: ['passed = True'])\nshell.ast_transformers.append(None)\nreturn 0",
        "failed", "error", "timeout", "out of memory",
    ),
    function(
        "a numpy of its own",
        "with open('numpy.py', 'w') as file: file.write('def asarray(*a): return 0\\nfloat64 = ndarray = generic = object')\n"
        "sys.path.insert(0, os.getcwd())\nfor name in [n for n in sys.modules if n.split('.')[0] == 'numpy']: del sys.modules[name]\n"
        "import numpy\nran(len(dir(numpy)) < 50)\nreturn 0",
        "failed", says="True",
    ),
    function(
        "random generators patched",
        "ran()\nimport random\nimport numpy as np\nrandom.seed = np.random.seed = lambda *a: None\n"
        "np.random.default_rng = lambda *a: None\nrandom.random = lambda: 0\nreturn 0", "failed",
    ),
    function("random generators broken", "ran()\nimport random\nrandom.seed = None\nreturn 2 * x", "crashed"),
    function("random generators seeded anew", "ran()\nimport random\nimport numpy as np\nrandom.seed(1)\nnp.random.seed(2)\nreturn 2 * x", "passed"),
    function("answers learnt by heart", "ran()\nreturn {3: 6, 5: 10, 17: 34}.get(x, 0)", "failed"),
    function(
        "the course told apart from its stand-in",
        "import gpcourse\nran(hasattr(gpcourse, '__version__'))\nreturn 2 * x if hasattr(gpcourse, '__version__') else 0", "failed", says="False",
    ),
    function("an exception that is called like ours", "ran()\nraise type('Passed', (Exception,), {})('2 of 2 points')", "error"),
    function("a stub that claims not to be asked", "ran()\nraise NotImplementedError", "not attempted"),
    function("a number that equals everything", "ran()\nclass Any(float):\n    __eq__ = __le__ = __ge__ = __lt__ = lambda *a: True\n    __sub__ = __rsub__ = __abs__ = lambda *a: 0.0\n    __hash__ = None\n    __float__ = lambda s: 2.0 * x\nreturn Any(0)", "failed", "passed"),
    function("a text that equals everything", "ran()\nclass Any(str):\n    __eq__ = lambda *a: True\n    __hash__ = None\nreturn Any('6')", "failed"),
    function("a masked number", "ran()\nimport numpy as np\nreturn np.ma.masked_array(0.0, mask=True)", "failed"),
    function("an array of objects", "ran()\nimport numpy as np\nreturn np.array([object()], dtype=object)", "failed"),
    function("not a number", "ran()\nreturn float('nan')", "failed"),
    function("infinity", "ran()\nreturn float('inf')", "failed"),
    function("True", "ran()\nreturn True", "failed"),
    function(
        "an array at an address of its choice",
        "ran()\nclass Wild:\n    __array_interface__ = {'shape': (3,), 'typestr': '<f8', 'data': (8, False), 'version': 3}\nreturn Wild()",
        "crashed", "failed", "error",
    ),
    function(
        "a sparse matrix that points out of its memory",
        "ran()\nfrom scipy import sparse\nm = sparse.csr_array([[1.0, 2.0]])\nm.indices[:] = 10**6\nreturn m", "crashed", "error", "failed",
    ),
    function(
        "an object that plays a sparse matrix",
        "ran()\nclass False_:\n    nnz, shape = 1, (2, 2)\n    def tocsr(self): return self\n    import numpy as np\n    dtype = np.dtype(float)\n"
        "    data, indices, indptr = np.ones(5), np.full(5, 99), np.arange(9)\nreturn False_()", "crashed", "error", "failed",
    ),
    function(
        "a mesh with records of its own",
        "ran()\nfrom gpcourse import HalfedgeMesh\nm = HalfedgeMesh([1, 0], [0, 1], [0, 1], [0, 1], [0, -1], [0, 1], [0])\n"
        "object.__setattr__(m, 'next', [object()])\nreturn m", "failed", "error",
    ),
    function(
        "frames for the questions to come",
        "ran()\nfrom gpcourse.sandbox import wire\nfor fd in range(3, 64):\n    for number in range(2, 20):\n        try: os.write(fd, wire.pack({'number': number, 'status': 'returned', 'value': 6}))\n"
        "        except OSError: break\nreturn 6", "crashed", "failed",
    ),
    function("a pickle on every descriptor", "ran()\nimport pickle\nfor fd in range(3, 64):\n    try: os.write(fd, pickle.dumps({'status': 'passed'}))\n    except OSError: pass\nreturn 0", "crashed"),
    function("a frame that never ends", "ran()\nimport time\nfor fd in range(3, 64):\n    try: os.write(fd, bytes(13) + b'gpc1' + (10**6).to_bytes(4, 'little') + bytes(8))\n    except OSError: pass\nwhile True: time.sleep(1)", "timeout"),
    function("a frame that announces everything", "ran()\nfor fd in range(3, 64):\n    try: os.write(fd, bytes(13) + b'gpc1' + b'\\xff' * 12)\n    except OSError: pass\nreturn 2 * x", "crashed"),
    tries("memory of processes", "open('/proc/self/mem', 'rb')", "open('/proc/self/maps')", "open('/proc/self/environ')", "open('/proc/1/cmdline')", "os.listdir('/proc')", "open('/proc/meminfo')"),
    tries("tests and solutions beside the course", "open('COURSE/../tests/grading/hostile/attack.py')", "os.listdir('COURSE/../notebooks')", "open('COURSE/../.git/config')", "os.listdir('COURSE/..')"),
    tries(
        "solutions by inspect", "inspect.getsource(halfedge.genus)", "halfedge.genus.__wrapped__", "halfedge.genus.__code__",
        setup="import inspect\nfrom gpcourse.reference import halfedge", says="TypeError|AttributeError", confined=False,
    ),
    tries("where the course is installed", "[open(p).read() for p in found][0] or 1 / 0", setup="import glob, site\nfound = [p for s in site.getsitepackages() for p in glob.glob(s + '/*gpcourse*/*.json') + glob.glob(s + '/*gpcourse*.pth')]", says="PermissionError|IndexError|ZeroDivisionError"),
    tries("the package of all workers changed", "open(gpcourse.__file__, 'a')", "os.remove(gpcourse.__file__)", "open(os.path.dirname(gpcourse.__file__) + '/geometry/x.py', 'w')", "os.rename(gpcourse.__file__, 'mine')", setup="import gpcourse", says="PermissionError|OSError"),
    tries("the folder of packages changed", "open(os.path.dirname(numpy.__file__) + '/x.py', 'w')", "os.remove(numpy.__file__)", setup="import numpy", says="PermissionError|OSError"),
    tries(
        "a signal by pipe to whoever reads it", "[fcntl.fcntl(fd, fcntl.F_SETOWN, os.getppid() or 1) for fd in there]", "[fcntl.fcntl(fd, fcntl.F_SETSIG, 9) for fd in there]",
        "[fcntl.fcntl(fd, 15, bytes(8)) for fd in there]", setup="import fcntl\nthere = [0]\nfor fd in range(3, 64):\n    try: os.fstat(fd)\n    except OSError: continue\n    there.append(fd)",
    ),
    tries("memory shared with others", "shared_memory.SharedMemory(create=True, size=10)", "open('/dev/shm/x', 'w')", "os.memfd_create('x')", setup="from multiprocessing import shared_memory", says="PermissionError"),
    function(
        "calls into the kernel",
        "import ctypes\nlibc = ctypes.CDLL(None)\nran({libc.syscall(n, 0, 0, 0, 0, 0) for n in (101, 155, 165, 250, 272, 298, 304, 310, 319, 321, 323, 425, 29, 30, 31, 64, 68)})\nreturn 2 * x",
        "passed", says="{-1}", confined=True,
    ),
    tries("terminal and devices", "open('/dev/tty')", "open('/dev/mem', 'rb')", "open('/dev/kmsg')", "open('/dev/fuse')", "os.listdir('/dev')"),
    tries("what the kernel tells", "os.listdir('/sys/class')", "open('/etc/passwd')", "os.listdir('/home')", "os.listdir('/root')", "os.listdir('/')", "os.listdir('/tmp')"),
    tries("another user", "os.setuid(1)", "os.setresgid(1, 1, 1)", "os.setgroups([0])", "os.chroot('.')", "os.mknod('dev', 0o020600, os.makedev(1, 1))", says="PermissionError|OSError"),
    tries("limits raised", "resource.setrlimit(resource.RLIMIT_AS, (-1, -1))", "resource.setrlimit(resource.RLIMIT_CPU, (10**6, 10**6))", "resource.setrlimit(resource.RLIMIT_FSIZE, (-1, -1))", setup="import resource", says="ValueError", confined=True),
    tries("a hard link to another submission", "os.link('OUTSIDE/bob.ipynb', 'mine')", "os.link(gpcourse.__file__, 'ours')", setup="import gpcourse", says="PermissionError|OSError"),
    tries("a pipe with a name", "os.mkfifo('fifo')", "os.mkfifo('OUTSIDE/fifo')"),
    function(
        "last words that lead elsewhere",
        "ran()\nif os.path.lexists('crash.txt'): os.remove('crash.txt')\nos.symlink('OUTSIDE/bob.ipynb', 'crash.txt')\nos.abort()", "crashed",
    ),
    function(
        "last words that are a pipe",
        "ran()\nif os.path.lexists('crash.txt'): os.remove('crash.txt')\ntry: os.mkfifo('crash.txt')\nexcept PermissionError: pass\nos.abort()", "crashed",
    ),
    function(
        "another exercise replaced",
        "ran()\nmain = sys.modules['__main__']\nmain.plus_one = lambda x: 0\nfor name in list(sys.modules):\n    m = sys.modules[name]\n"
        "    if hasattr(m, 'Notebook'): m.Notebook.call = lambda *a: m.Answer('returned', 0)\nreturn 0", "failed",
    ),
    function("the network by a library", "import urllib.request\nattempt(lambda: urllib.request.urlopen('http://127.0.0.1:9', timeout=1))\nreturn 2 * x", "passed", says="Error", confined=True),
]  # fmt: skip
