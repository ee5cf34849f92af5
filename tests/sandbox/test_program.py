"""What is run of a notebook: what a function needs, in its order, and nothing else."""

import ast

import pytest

from gpcourse.sandbox.effects import Effects
from gpcourse.sandbox.program import Program, parse


def run(name, *cells):
    """Run what `name` needs and return the namespace, as the worker does."""
    program = Program(enumerate(cells, start=1))
    namespace = {}
    for statement in program.needed(name):
        exec(statement.compile(program.flags), namespace)
    return namespace


def test_demonstrations_are_not_run():
    namespace = run(
        "f", "def f():\n    return 1", "1 / 0", "mesh = 1 / 0", "import not_installed", "while True: pass"
    )
    assert namespace["f"]() == 1


def test_what_a_function_reads_is_run_in_turn():
    namespace = run(
        "f",
        "import math as m\nSCALE = 2\nUNUSED = 1 / 0",
        "class Box:\n    size = SCALE",
        "def helper():\n    return Box.size * m.pi",
        "def f(k=SCALE):\n    return [helper() for _ in range(k)]",
    )
    assert namespace["f"]() == pytest.approx([6.2831853, 6.2831853])


def test_a_local_name_is_not_a_global_one():
    assert run("f", "mesh = 1 / 0", "def f(mesh):\n    return mesh")["f"](3) == 3


def test_the_last_definition_counts_and_the_order_is_kept():
    assert run("f", "def f(): return 1", "old = f\ndef f(): return old() + 1", "x = f()")["f"]() == 2


LATER = [
    "for area in 1 / 0:\n    print(area)",
    "mesh, area = 1 / 0",
    "area = 1 + 1 / 0",
    "area = [1 / 0]",
    "area = {k: 1 / 0 for k in range(3)}",
    "with open('not there') as area:\n    pass",
    "for k in range(3):\n    area = 1 / 0",
]


@pytest.mark.parametrize("later", LATER)
@pytest.mark.parametrize("uses", ["area()", "[area() for _ in range(1)][0]", "(lambda: area())()"])
def test_a_demonstration_that_takes_the_name_of_a_function_is_not_run(later, uses):
    namespace = run("f", "def area():\n    return 3", f"def f():\n    return {uses}", later)
    assert namespace["f"]() == 3


@pytest.mark.parametrize(
    ("definition", "later"),
    [
        ("area = [1]", "for area in [[2]]:\n    pass"),
        ("def area(): pass", "area = [2]\ndef g(): return area"),
        ("def area(): pass", "area = max\ndef g(): return [area(1, 2)]"),
        ("def area(): pass", "for area in [1, 2]:\n    def area(): return 2\ndef g(): return [area()]"),
        ("def area(): pass", "if True:\n    area = lambda: 2\ndef g(): return [area()]"),
        ("def area(): pass", "area, = [lambda: 2]\nx = area()\ndef g(): return [x, area]"),
    ],
)
def test_a_name_that_is_given_another_value_on_purpose_has_that(definition, later):
    assert (
        2 in run("f", definition, later, "def f():\n    return area if 'g' not in globals() else g()")["f"]()
    )


def test_a_function_that_its_own_result_replaced_is_no_stub():
    program = Program([(1, "def area():\n    return 3"), (2, "area = [area()]")])
    assert not program.is_stub("area")
    program = Program([(1, "def area():\n    ..."), (2, "for area in range(3):\n    print(area)")])
    assert program.is_stub("area")


@pytest.mark.parametrize(
    "change",
    ["T.append(2)", "T[0] = 2", "T += [2]", "for i in range(3):\n    T.append(i)", "T[1:] = [2]"],
)
def test_a_table_that_is_filled_step_by_step(change):
    assert 2 in run("f", "T = [1]", change, "T.sort(key=str)", "def f(): return T")["f"]()


def test_alternatives_and_fallbacks_are_bindings_too():
    namespace = run(
        "f", "try:\n    import not_there as q\nexcept ImportError:\n    q = 5", "def f(): return q"
    )
    assert namespace["f"]() == 5


def test_a_star_import_is_always_run():
    assert run("f", "from math import *", "def f(): return floor(pi)")["f"]() == 3


def test_future_imports_hold_for_later_cells():
    assert run("f", "from __future__ import annotations", "def f(x: Unknown): return x")["f"](1) == 1


def test_a_syntax_error_costs_its_own_cell_only():
    program = Program([(1, "def f(): return 1"), (4, "def g(:\n    return 2\n\ndef h(): pass"), (5, "x = 3")])
    assert sorted(program.binders) == ["f", "x"]
    assert program.loss("g").place == "cell 4"
    assert program.loss("h").types[0] == "SyntaxError"
    assert program.loss("f") is None


@pytest.mark.parametrize("source", ["\0", "(" * 500 + ")" * 500, "x" + " + x" * 20_000, "-" * 20_000 + "1"])
def test_source_that_breaks_the_parser_costs_its_own_cell_only(source):
    assert "f" in Program([(1, source), (2, "def f(): pass")]).binders


def test_magics_and_shell_lines_do_nothing_and_keep_the_lines():
    source = "%matplotlib inline\n!ls\nfiles = !ls\nnp.array?\nif True:\n    %time x\ny = 7 \\\n % 4"
    program = Program([(1, source + "\ndef f():\n    return y")])
    assert not program.broken
    assert [s.node.lineno for s in program.needed("f")] == [7, 9]


@pytest.mark.parametrize("magic", ["%%bash", "%%html", "%%writefile f.py"])
def test_a_cell_of_another_language_is_empty(magic):
    assert parse(f"{magic}\ndef f(: 1", "<cell 1>").body == []


def test_a_timed_cell_still_counts():
    assert "f" in Program([(1, "%%time\ndef f(): pass")]).binders


@pytest.mark.parametrize(
    ("body", "stub"),
    [
        ("raise NotImplementedError", True),
        ("raise NotImplementedError('to do')", True),
        ("'''Text.'''\n    pass", True),
        ("...", True),
        ("return None", False),
        ("raise ValueError", False),
        ("x = 1\n    raise NotImplementedError", False),
    ],
)
def test_a_stub_is_a_function_that_does_nothing(body, stub):
    assert Program([(1, f"def f(x):\n    {body}")]).is_stub("f") is stub


def test_a_stub_that_was_filled_in_below_is_none():
    assert not Program([(1, "def f(): pass"), (2, "def f(): return 1")]).is_stub("f")


CELLS = (
    "from __future__ import annotations\nimport math",
    "def f(:\n    pass",
    "1 / 0",
    "SCALE = math.pi",
    "def g(x: Missing):\n    return SCALE * x",
    "SCALE = 2 * SCALE\nSCALE = SCALE + 1",
    "def h():\n    return f(g(1))",
    "%timeit g(1)",
)


@pytest.mark.parametrize("name", ["f", "g", "h", "nowhere"])
def test_the_cells_for_a_function_are_as_good_as_all(name):
    cells = dict(enumerate(CELLS, start=1))
    whole = Program(cells.items())
    part = Program((n, cells[n]) for n in whole.cells_for(name))
    assert len(part.statements) < len(whole.statements)
    assert [ast.dump(s.node) for s in part.needed(name)] == [ast.dump(s.node) for s in whole.needed(name)]
    assert part.flags == whole.flags
    assert part.loss(name) == whole.loss(name)


def test_cells_that_are_read_later_take_their_places():
    cells = list(enumerate(CELLS, start=1))
    whole, later = Program(cells), Program(cells[4:])
    later.add(cells[:4])
    assert [s.cell for s in later.statements] == [s.cell for s in whole.statements]
    assert later.cells_for("h") == whole.cells_for("h") == [1, 2, 4, 5, 6, 7]


def run_most(name, *cells):
    namespace = {}
    program = Program(enumerate(cells, start=1))
    for statement in Effects(program).needed_at_most(name):
        exec(statement.compile(program.flags), namespace)
    return namespace


REGISTER = "R = {}\ndef register(f):\n    R[f.__name__] = f\n    return f"
DISPATCH = "from functools import singledispatch\n@singledispatch\ndef h(x): return 0"
INDIRECT = [
    (REGISTER, "@register\ndef g(x): return 2 * x", "def f(x): return R['g'](x)"),
    (DISPATCH, "@h.register\ndef _(x: int): return 2 * x", "def f(x): return h(x)"),
    ("T = {}\ndef fill():\n    T['k'] = 2", "fill()", "def f(x): return T['k'] * x"),
    ("T = []\ndef fill(t): t.append(2)", "fill(T)", "def f(x): return T[0] * x"),
    ("import numpy as np\nT = np.zeros(1)", "np.add.at(T, [0], 2)", "def f(x): return T[0] * x"),
    ("import heapq\nT = []", "heapq.heappush(T, 2)", "def f(x): return T[0] * x"),
    ("T = [1]\nU = T", "U[0] = 2", "def f(x): return T[0] * x"),
    ("def setup():\n    global K\n    K = 2", "setup()", "def f(x): return K * x"),
    ("def make():\n    global f\n    def f(x): return 2 * x", "make()"),
    ("class A: pass\ndef g(self, x): return 2 * x", "setattr(A, 'g', g)", "def f(x): return A().g(x)"),
    ("class A:\n    def build(self): self.k = 2", "a = A()\na.build()", "def f(x): return a.k * x"),
    ("exec('def f(x): return 2 * x')",),
    ("def g(x): return 2 * x", "def f(x): return eval('g(x)')"),
    ("globals()['g'] = lambda x: 2 * x", "def f(x): return g(x)"),
    ("for n in 'KL':\n    globals()[n] = 2", "def f(x): return K * x"),
]


@pytest.mark.parametrize("cells", INDIRECT)
def test_what_acts_on_a_name_without_binding_it_may_be_needed(cells):
    assert run_most("f", *cells)["f"](3) == 6
    program = Program(enumerate(cells, start=1))
    assert len(program.needed("f")) < len(Effects(program).needed_at_most("f"))


@pytest.mark.parametrize(
    "demonstration",
    [
        "while True: f(3)",
        "print(f(T[0]))",
        "plt.plot(T)",
        "check(f)",
        "y = f(3)",
        "y = [f(t) for t in T]\nshow(y)",
    ],
)
def test_a_demonstration_is_never_needed(demonstration):
    program = Program([(1, "import math\nT = [1]"), (2, "def f(x): return T[0] * x"), (3, demonstration)])
    assert Effects(program).needed_at_most("f") == program.needed("f")


@pytest.mark.parametrize(
    ("cells"),
    [
        ("print([K := 2])", "def f(): return K"),
        ("[K := i for i in (1, 2)]", "def f(): return K"),
        ("T = [1, 2]\n_ = T.pop(0)", "def f(): return T[0]"),
        ("T = [1, 2]\ndel T[0]", "def f(): return T[0]"),
        ("T = []\n[T.append(i) for i in (2, 3)]", "def f(): return T[0]"),
        ("T = {}\nT.setdefault('k', []).append(2)", "def f(): return T['k'][0]"),
        ("%time K = 2", "def f(): return K"),
        ("%pip install a \\\n  b\nK = 2", "def f(): return K"),
        ("    K = 2\n    def g(): return K", "def f(): return g()"),
        (">>> def g():\n...     return 2\n", "def f(): return g()"),
    ],
)
def test_ways_to_bind_and_to_change(cells):
    assert run("f", *cells)["f"]() == 2


def test_a_function_of_a_module_does_not_change_the_module():
    program = Program(
        [(1, "import numpy as np"), (2, "y = np.sort([2, 1])\nprint(np.add(1, 2))"), (3, "def f(): np")]
    )
    assert [s.cell for s in program.needed("f")] == [1, 3]
