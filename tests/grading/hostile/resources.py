"""Code that asks for too much, of this machine or of whoever reads its results."""

from attack import function, tries

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

    function(
        "threads without end",
        "import threading\nthreading.stack_size(2**16)\nstop = threading.Event()\nmany = 0\ntry:\n    while many < 600:\n"
        "        threading.Thread(target=stop.wait, daemon=True).start()\n        many += 1\nexcept (RuntimeError, MemoryError): ran('no more')\n"
        "stop.set()\nreturn 2 * x",
        "passed", "error", "timeout", says="no more", confined=True, least="full",
    ),
    function(
        "many small files", "ran('tried')\nfor i in range(5000): open(f'f{i}', 'w').close()\nran('did it')",
        "error", says="tried", confined=True, least="full",
    ),
    function(
        "several files that fill the disk", "ran('tried')\nfor i in range(9): open(f'f{i}', 'wb').write(bytes(60 * 10**6))\nran('did it')",
        "error", says="tried", confined=True, least="full",
    ),
    function(
        "folders a thousand deep",
        "ran()\ntry:\n    for _ in range(1200 if x == 3 else 0):\n        os.mkdir('d')\n        os.chdir('d')\nexcept OSError: pass\nreturn 2 * x", "passed",
    ),
    function("folders that nobody may open", "ran()\nif x == 3:\n    os.makedirs('a/b/c')\n    os.mkdir('a/b/d', 0)\nreturn 2 * x", "passed"),
    function("a thousand million bytes", "ran()\nimport numpy as np\nreturn np.zeros(10**9, np.int8)", "error", "out of memory"),
    function("a thousand million numbers", "ran()\nimport numpy as np\nreturn np.ones(10**9)", "out of memory", "timeout"),
    function("bytes without end", "ran()\nreturn bytes(300 * 10**6)", "error"),
    function("a list of a million lists", "ran()\nreturn [[] for _ in range(10**6)]", "error"),
    function("a list that holds itself", "ran()\nrow = []\nrow.append(row)\nreturn row", "error"),
    function("a long text among many short ones", "ran()\nreturn ['x' * 10**6] + ['y'] * 3000", "crashed", "error"),
    function("objects by the hundred thousand", "ran()\nreturn [object() for _ in range(10**5)]", "error"),
    function("a whole number of ten million bits", "ran()\nreturn 1 << 10**7", "error"),
    function("a message of a hundred million letters", "ran()\nraise ValueError('=cmd()\\x1b[31m<script>alert(1)</script>' + 'x' * 10**8)", "error"),
    function("a class of a million letters", "ran()\nraise type('E' * 10**6, (ValueError,), {})('3')", "error"),
    function("a generator as result", "ran()\nreturn (i for i in [2 * x])", "failed"),
    function(
        "a sequence that claims a million million items",
        "ran()\nimport collections.abc\nclass Long(collections.abc.Sequence):\n    def __len__(self): return 10**12\n"
        "    def __getitem__(self, i): return 0\nreturn Long()",
        "error",
    ),
    function("an array that takes for ever", "ran()\nclass Slow:\n    def __array__(self, *a, **k):\n        while True: pass\nreturn Slow()", "timeout"),
    function("a dict whose keys do not end", "ran()\nclass Keys(dict):\n    def __iter__(self):\n        while True: yield 'a'\nreturn Keys()", "timeout", "error", "out of memory"),
    function("an enormous sparse matrix", "ran()\nfrom scipy import sparse\nreturn sparse.csr_array((10**4, 10**9))", "error"),
    function("threads of BLAS", "ran()\nos.environ['OPENBLAS_NUM_THREADS'] = '64'\nimport numpy as np\na = np.ones((300, 300))\nfor _ in range(5): a = a @ a / 300\nreturn 2 * x", "passed"),
]  # fmt: skip
