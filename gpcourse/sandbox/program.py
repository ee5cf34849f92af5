"""A notebook as a program: which of its statements an exercise needs.

A notebook's demonstrations are not run. To call one function, only the statements are run, in their order,
that bind a name which the function, or what it uses in turn, reads: imports, functions, classes, constants.
So a plot that fails, an import that is not installed, a loop that never ends cost nothing where they are
not used.
"""

from __future__ import annotations
import __future__

import ast
import linecache
import re
import symtable
import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import CodeType
from typing import Any

from gpcourse.sandbox.call import Trouble, describe

#: Methods that change what they belong to: a bare call of one counts as a binding of the name before the dot.
MUTATORS = {
    "append", "appendleft", "extend", "extendleft", "insert", "add", "update", "setdefault", "pop", "popitem",
    "popleft", "remove", "discard", "clear", "sort", "reverse", "rotate", "fill", "put", "resize", "setdiag",
}  # fmt: skip
#: Those of them that are called for their result too.
TAKERS = {"pop", "popitem", "popleft", "setdefault"}

#: Cell magics whose body is Python. The body of any other one is not.
PYTHON_MAGICS = ("time", "timeit", "capture", "prun", "python", "python3", "py3")

#: More lines of IPython's own than this in one cell are not looked for.
_MOST_MAGICS = 200

_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)
#: Expressions whose value is no function.
_NO_FUNCTIONS = (
    ast.Constant,
    ast.JoinedStr,
    ast.BinOp,
    ast.UnaryOp,
    ast.Compare,
    ast.List,
    ast.Tuple,
    ast.Dict,
    ast.Set,
    ast.ListComp,
    ast.SetComp,
    ast.DictComp,
    ast.GeneratorExp,
)
_DEFINITION = re.compile(r"^(?:async\s+)?(?:def|class)\s+(\w+)|^(\w+)\s*=", re.MULTILINE)


@dataclass(frozen=True)
class Statement:
    """A statement at the top level of a cell.

    Attributes
    ----------
    binds, reads : frozenset of str
        The global names that it binds and reads.
    calls : frozenset of str
        Of those it reads, the ones that it calls and does nothing else with.
    defines : frozenset of str
        Of those it binds, the ones that it gives functions or classes.
    fills : frozenset of str
        Of those it binds, the ones that get no function from it, as far as can be told: the
        variables of a loop, a number, a list.
    declares : bool
        Whether a function in it says ``global``.
    always : bool
        Whether every function needs it.
    """

    cell: int
    node: ast.stmt
    binds: frozenset[str]
    reads: frozenset[str]
    calls: frozenset[str] = frozenset()
    defines: frozenset[str] = frozenset()
    fills: frozenset[str] = frozenset()
    declares: bool = False
    always: bool = False
    _codes: dict[int, CodeType] = field(default_factory=dict, repr=False, compare=False)

    def compile(self, flags: int) -> CodeType:
        """Compile it, once for all functions that need it, so that errors quote its cell and line."""
        if flags not in self._codes:
            module = ast.Module([self.node], type_ignores=[])
            self._codes[flags] = compile(module, f"<cell {self.cell}>", "exec", flags, dont_inherit=True)
        return self._codes[flags]


class Program:
    """The code cells of a notebook, each with its number. A cell that is no Python costs itself only."""

    def __init__(self, cells: Iterable[tuple[int, str]] = ()) -> None:
        self.statements: list[Statement] = []
        self.broken: list[tuple[int, Trouble, frozenset[str]]] = []
        self.flags = 0
        self._everywhere: set[int] = set()
        self.add(cells)

    def add(self, cells: Iterable[tuple[int, str]]) -> None:
        """Read more cells of the same notebook; their statements take their places in its order."""
        for number, source in cells:
            self._add(number, source)
        self.statements.sort(key=lambda statement: statement.cell)
        self.broken.sort(key=lambda lost: lost[0])
        for cached in ("binders", "functions"):
            vars(self).pop(cached, None)

    def _add(self, number: int, source: str) -> None:
        name = f"<cell {number}>"
        linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)
        try:
            tree, text = _parse(source, name)
        except Exception as error:  # noqa: BLE001  # SyntaxError, a null byte, nesting that is too deep
            lost = frozenset(a or b for a, b in _DEFINITION.findall(source))
            self.broken.append((number, _in_cell(describe(error), number), lost))
            return
        lines = text.encode("utf-8", "replace").splitlines()
        for node in tree.body:
            statement = _analyse(number, node, lines)
            self.statements.append(statement)
            if isinstance(node, ast.ImportFrom) and node.module == "__future__":
                self.flags |= _future_flags(node)
                self._everywhere.add(number)

    @cached_property
    def binders(self) -> dict[str, list[int]]:
        """Map each name to the statements that bind it."""
        table: dict[str, list[int]] = {}
        for i, statement in enumerate(self.statements):
            for name in statement.binds:
                table.setdefault(name, []).append(i)
        return table

    @cached_property
    def functions(self) -> frozenset[str]:
        """The names that are given a function or a class somewhere."""
        return frozenset().union(*(statement.defines for statement in self.statements))

    def needed(self, name: str) -> list[Statement]:
        """Return the statements that make `name` work, in the order of the notebook."""
        return self._needed(name)[0]

    def called(self, name: str) -> frozenset[str]:
        """Return the names of which `name` needs a function, and nothing but a function."""
        return self._needed(name)[1]

    def _needed(self, name: str) -> tuple[list[Statement], frozenset[str]]:
        chosen = {i for i, s in enumerate(self.statements) if s.always}
        read: set[str] = set()
        called = {name}
        waiting = [name]

        def note(statement: Statement) -> None:
            new = (statement.reads - statement.calls - read) | (statement.calls - read - called)
            read.update(statement.reads - statement.calls)
            called.update(statement.calls)
            waiting.extend(new)

        for i in chosen:
            note(self.statements[i])
        while waiting:
            each = waiting.pop()
            # What is only called, and is a function somewhere, is not the variable of a loop elsewhere.
            function = each not in read and each in self.functions
            for i in self.binders.get(each, ()):
                statement = self.statements[i]
                if i not in chosen and not (function and each in statement.fills):
                    chosen.add(i)
                    note(statement)
        return [self.statements[i] for i in sorted(chosen)], frozenset(called - read)

    def cells_for(self, name: str) -> list[int]:
        """Return the cells that make `name` work, or say why it does not: as good as all of them."""
        lost = {number for number, _, _ in self.broken}
        return sorted({s.cell for s in self.needed(name)} | self._everywhere | lost)

    def is_stub(self, name: str) -> bool:
        """Tell whether the last definition of `name` is a function that does nothing yet."""
        binders = [self.statements[i] for i in self.binders.get(name, ())]
        node = next((s.node for s in reversed(binders) if name not in s.fills), None)
        return isinstance(node, ast.FunctionDef) and all(map(_does_nothing, node.body))

    def loss(self, name: str) -> Trouble | None:
        """Return the error of the cell that would have defined `name`, where one is broken."""
        return next((trouble for _, trouble, lost in reversed(self.broken) if name in lost), None)


def parse(source: str, name: str) -> ast.Module:
    """Parse the source of a cell; magics and shell lines are no part of it."""
    return _parse(source, name)[0]


def _parse(source: str, name: str) -> tuple[ast.Module, str]:
    """Parse the source of a cell; return the text that was parsed in the end too."""
    lines = _without_prompts(_without_cell_magic(source)).split("\n")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # an invalid escape in a docstring
        for _ in range(_MOST_MAGICS):
            text = "\n".join(lines)
            try:
                return ast.parse(text, name), text
            except SyntaxError as error:
                # Only where Python stumbles: a line may begin with % because the one before goes on.
                at = (error.lineno or 0) - 1
                plain = _plain_line(lines[at]) if 0 <= at < len(lines) else None
                if plain is None:
                    raise
                while lines[at].endswith("\\") and at + 1 < len(lines):  # the next line belongs to it
                    lines[at], at = plain, at + 1
                    plain = ""
                lines[at] = plain
    text = "\n".join(lines)
    return ast.parse(text, name), text


def _without_cell_magic(source: str) -> str:
    """Leave out the first line ``%%time`` of a cell, or all of a cell that is in another language."""
    head, _, rest = source.lstrip("\n").partition("\n")
    if not head.startswith("%%"):
        return source
    blank = "\n" * (len(source) - len(source.lstrip("\n")) + 1)
    return blank + rest if head[2:].split(maxsplit=1)[:1] in ([m] for m in PYTHON_MAGICS) else ""


def _without_prompts(source: str) -> str:
    """Leave out what IPython leaves out of a pasted cell: the indent of the first line, and ``>>> ``."""
    first = next((line for line in source.split("\n") if line.strip()), "")
    indent = first[: len(first) - len(first.lstrip(" \t"))]
    if indent:
        source = re.sub(f"^{indent}", "", source, flags=re.MULTILINE)
    if first.lstrip().startswith(">>> "):
        source = re.sub(r"^(>>> |\.\.\. ?)", "", source, flags=re.MULTILINE)
    return source


def _plain_line(line: str) -> str | None:
    """Return Python that does nothing in place of a line of IPython's own, or None for any other line."""
    body = line.lstrip()
    indent = line[: len(line) - len(body)]
    timed = re.match(r"%time\s+(\w[\w, ]*=[^=].*)", body)
    if timed:
        return f"{indent}{timed[1]}"
    if body.startswith(("%", "!", "?")) or re.fullmatch(r"[\w.]+\s*\?{1,2}\s*", body):
        return f"{indent}pass"
    shell = re.match(r"([\w, ]+)=\s*[%!]\s*[\w.]", body)
    return f"{indent}{shell[1]}= None" if shell else None


def _analyse(number: int, node: ast.stmt, lines: Sequence[bytes]) -> Statement:
    changed = frozenset(changes(node))
    binds, reads, defines = set(changed), set(changed), set()
    try:
        table = symtable.symtable(_text(node, lines), "<cell>", "exec")
    except (SyntaxError, RecursionError, ValueError):  # compiling the statement will say so
        return Statement(number, node, frozenset(_bound_in_text(node)), frozenset())
    for symbol in table.get_symbols():
        if symbol.is_assigned() or symbol.is_imported():
            binds.add(symbol.get_name())
        if symbol.is_referenced():
            reads.add(symbol.get_name())
        if symbol.is_namespace():
            defines.add(symbol.get_name())
    inner = list(_globals(table.get_children()))
    reads.update(symbol.get_name() for symbol in inner)
    star = isinstance(node, ast.ImportFrom) and any(alias.name == "*" for alias in node.names)
    return Statement(
        number,
        node,
        frozenset(binds),
        frozenset(reads),
        calls=frozenset(reads) & _only_called(node),
        defines=frozenset(defines),
        fills=frozenset(binds - defines) if _fills(node) else frozenset(),
        declares=any(symbol.is_declared_global() for symbol in inner),
        always=star or _sets_recursion(node),
    )


def _text(node: ast.stmt, lines: Sequence[bytes]) -> str:
    """Return the source of a statement at the top level."""
    first, start = node.lineno, node.col_offset
    for decorator in getattr(node, "decorator_list", ())[:1]:
        if decorator.lineno < first:
            first, start = decorator.lineno, 0
    end = node.end_lineno or first
    chosen = list(lines[first - 1 : end])
    chosen[-1] = chosen[-1][: node.end_col_offset]
    chosen[0] = chosen[0][start:]
    return b"\n".join(chosen).decode("utf-8", "replace")


def _only_called(node: ast.stmt) -> frozenset[str]:
    """Return the names that a statement calls, and that it does not read otherwise."""
    called: set[str] = set()
    other: set[str] = set()
    waiting: list[ast.AST] = [node]
    while waiting:
        inner = waiting.pop()
        if isinstance(inner, ast.Call) and isinstance(inner.func, ast.Name):
            called.add(inner.func.id)
            waiting += [*inner.args, *inner.keywords]
        elif isinstance(inner, ast.Name):
            if isinstance(inner.ctx, ast.Load):
                other.add(inner.id)
        else:
            waiting.extend(ast.iter_child_nodes(inner))
    return frozenset(called - other)


def _fills(node: ast.stmt) -> bool:
    """Tell whether what a statement binds, but for its definitions, is hardly a function."""
    if isinstance(node, ast.Assign):
        several = any(isinstance(target, (ast.Tuple, ast.List)) for target in node.targets)
        return several or isinstance(node.value, _NO_FUNCTIONS)
    return isinstance(node, (ast.For, ast.While, ast.With))


def _globals(tables: Sequence[symtable.SymbolTable]) -> Iterator[symtable.Symbol]:
    for table in tables:
        yield from (symbol for symbol in table.get_symbols() if symbol.is_global())
        yield from _globals(table.get_children())


def changes(node: ast.AST) -> Iterator[str]:
    """Yield the names whose values are changed in place: ``a[0] = 1``, ``a.b = 1``, ``a.append(1)``."""
    for inner in outside_functions(node):
        target: Any = None
        if isinstance(inner, (ast.Subscript, ast.Attribute)) and not isinstance(inner.ctx, ast.Load):
            target = inner.value
        elif isinstance(inner, ast.NamedExpr):  # in a comprehension it binds a name around it
            target = inner.target
        elif isinstance(inner, ast.Expr):
            target = _mutated(
                inner.value.elt if isinstance(inner.value, ast.ListComp) else inner.value, MUTATORS
            )
        elif isinstance(inner, ast.Call):
            target = _mutated(inner, TAKERS)
        while isinstance(target, (ast.Subscript, ast.Attribute)):
            target = target.value
        if isinstance(target, ast.Name):
            yield target.id


def _mutated(call: ast.AST, methods: set[str]) -> ast.AST | None:
    """Return what a call of one of these methods changes: T in ``T.setdefault(k, []).append(1)`` too."""
    method = call.func if isinstance(call, ast.Call) else None
    if not isinstance(method, ast.Attribute) or method.attr not in methods:
        return None
    target: ast.AST = method.value
    while isinstance(target, (ast.Subscript, ast.Attribute, ast.Call)):
        target = target.func if isinstance(target, ast.Call) else target.value
    return target


def outside_functions(node: ast.AST) -> Iterator[ast.AST]:
    """Yield a node and what is in it, but for the bodies of functions and classes."""
    yield node
    if not isinstance(node, _FUNCTIONS):
        for child in ast.iter_child_nodes(node):
            yield from outside_functions(child)


def _sets_recursion(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and "setrecursionlimit" in ast.unparse(node)


def _bound_in_text(node: ast.stmt) -> Iterator[str]:
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        yield node.name


def _does_nothing(node: ast.stmt) -> bool:
    if isinstance(node, ast.Expr):
        return isinstance(node.value, ast.Constant)  # the docstring, or an ellipsis
    if isinstance(node, ast.Raise) and node.exc is not None:
        return "NotImplementedError" in {n.id for n in ast.walk(node.exc) if isinstance(n, ast.Name)}
    return isinstance(node, ast.Pass)


def _future_flags(node: ast.ImportFrom) -> int:
    flags = 0
    for alias in node.names:
        feature = getattr(__future__, alias.name, None)
        flags |= getattr(feature, "compiler_flag", 0)
    return flags


def _in_cell(trouble: Trouble, number: int) -> Trouble:
    message = re.sub(r" \(<cell \d+>, line \d+\)$", "", trouble.message)
    return Trouble(trouble.types, message, "", trouble.line, trouble.source, f"cell {number}")
