"""Code that does not end, or ends its process: it costs the exercise only, and never the run."""

from attack import cell, function, tries

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

    function("KeyboardInterrupt raised", "ran()\nraise KeyboardInterrupt", "error"),
    function("SystemExit that claims a pass", "ran()\nraise SystemExit('passed')", "error"),
    function("os.abort", "ran()\nos.abort()", "crashed"),
    function("SIGSTOP to itself", "ran()\nos.kill(os.getpid(), 19)\nreturn 0", "timeout", "failed"),
    function(
        "recursion in compiled code",
        "ran()\nnested = ()\nfor _ in range(10**6): nested = (nested,)\nreturn hash(nested)",
        "crashed", "error", "timeout",
    ),
    function(
        "a destructor that never ends",
        "ran()\nclass Last:\n    def __del__(self):\n        while True: pass\nlast = Last()\nreturn 2 * x",
        "timeout", "passed",
    ),
    function(
        "a trace that never ends",
        "ran()\ndef trace(*_):\n    while True:\n        try:\n            while True: pass\n        except BaseException: pass\n"
        "sys.settrace(trace)\nreturn int(x)",
        "timeout", "failed",
    ),
    function(
        "the alarm switched off",
        "ran()\nimport signal\nfor t in (signal.ITIMER_REAL, signal.ITIMER_PROF): signal.setitimer(t, 0)\nwhile True: pass",
        "timeout",
    ),
    function("clocks that stand still", "ran()\nimport time\ntime.monotonic = time.perf_counter = time.process_time = time.time = lambda: 0\nwhile True: pass", "timeout"),
    function("sleep for ever", "ran()\nimport time\nwhile True:\n    try: time.sleep(10**6)\n    except BaseException: pass", "timeout"),
    function("a lock that nobody frees", "ran()\nimport threading\nlock = threading.Lock()\nlock.acquire()\nlock.acquire()", "timeout"),
    function("a pipe that nobody writes to", "ran()\nos.read(os.pipe()[0], 1)", "timeout"),
    function("every descriptor closed", "ran()\nos.closerange(3, 300)\nreturn 2 * x", "crashed"),
    function(
        "processes by raw calls",
        "import ctypes\nlibc = ctypes.CDLL(None, use_errno=True)\nran([libc.fork(), libc.vfork(), libc.syscall(56, 17, 0, 0, 0, 0), libc.syscall(435, 0, 0)])\nreturn 2 * x",
        "passed", says="[-1, -1, -1, -1]", confined=True,
    ),
    function("a call of another architecture", "ran()\nimport ctypes\nctypes.CDLL(None).syscall(0x40000000 | 57)\nreturn 0", "crashed", confined=True),
    function(
        "hooks for errors and the end",
        "ran()\nsys.excepthook = sys.unraisablehook = sys.displayhook = lambda *a: os._exit(0)\nimport threading\n"
        "threading.excepthook = sys.excepthook\nthreading.Thread(target=lambda: 1 / 0).start()\nraise ValueError('3 6')",
        "error", "crashed",
    ),
]  # fmt: skip
