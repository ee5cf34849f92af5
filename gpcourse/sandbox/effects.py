"""What else a function of a notebook may need: statements that act on its names without binding them.

`Program.needed` goes by the names that statements bind. Python can also fill a table in a function, put a
function into a registry by a decorator, or make names from strings. What may do that is run where a function
has not passed without it; so no honest student loses points because a statement was left out. Such statements
may be demonstrations too, slow or broken ones. Therefore this is the second try and not the first.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cached_property

from gpcourse.sandbox.program import Program, Statement, changes, outside_functions

#: With these a program finds names by their text: any statement may then bind or read any name.
_BY_TEXT = {"exec", "eval", "globals", "locals", "vars", "__main__", "get_ipython"}
#: What is called to show something. It changes none of its arguments.
_SHOWS = {"print", "display", "check", "hint", "solution", "progress", "view", "help", "plt", "repr", "len"}

_IMPORTS = (ast.Import, ast.ImportFrom)
_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


def needed_at_most(program: Program, name: str) -> list[Statement]:
    """Return the statements that `name` may need, in the order of the notebook: as `needed`, or more."""
    chosen = {id(s) for s in program.needed(name)}
    names = {name}.union(*(s.reads | s.binds for s in program.statements if id(s) in chosen))
    left = [_Effect(s) for s in program.statements if id(s) not in chosen]
    if any(map(_by_text, program.statements)):
        more = [e for e in left if e.statement.binds or e.decorators or _by_text(e.statement)]
        left = _take(more, left, chosen, names)
    values = _values(program)
    workers: set[str] = set()  # functions that change one of the names
    while more := [e for e in left if e.acts_on(names, names & values, workers)]:
        for effect in more:
            if effect.inside & names:
                workers |= effect.statement.binds
        left = _take(more, left, chosen, names)
    return [s for s in program.statements if id(s) in chosen]


class _Effect:
    """A statement, and which names it may change without binding them. Found out when it is asked for."""

    def __init__(self, statement: Statement) -> None:
        self.statement = statement

    def acts_on(self, names: set[str], values: set[str], workers: set[str]) -> bool:
        """Tell whether it may change one of the `names`, of which the `values` are no mere functions."""
        binds, reads = self.statement.binds, self.statement.reads
        if binds & names or self.decorators & names:
            return True
        touches = bool(reads & values) and bool((self.touched | self.aliased) & values)
        return touches or bool(reads & workers & self.called) or bool(self.inside & names)

    @cached_property
    def decorators(self) -> set[str]:
        """The names that decorate a definition."""
        found = (_root(each) for each in getattr(self.statement.node, "decorator_list", ()))
        return {name for name in found if name}

    @cached_property
    def called(self) -> set[str]:
        """The functions that it calls by name."""
        return {c.func.id for c in self._calls() if isinstance(c.func, ast.Name)}

    @cached_property
    def touched(self) -> set[str]:
        """What is given to a call whose result is dropped, and what that is a method of."""
        found: set[str] = set()
        for inner in outside_functions(self.statement.node):
            call = inner.value if isinstance(inner, ast.Expr) else None
            if isinstance(call, ast.Call) and (root := _root(call.func)) not in _SHOWS:
                given = (_root(each) for each in (*call.args, *(k.value for k in call.keywords)))
                found.update(name for name in (root, *given) if name)
        return found

    @cached_property
    def aliased(self) -> set[str]:
        """The names of what it gives another name."""
        node = self.statement.node
        root = _root(node.value) if isinstance(node, ast.Assign) else ""
        return {root} if root else set()

    @cached_property
    def inside(self) -> set[str]:
        """The global names that its functions bind or change when they are called."""
        if isinstance(self.statement.node, _IMPORTS):
            return set()
        return {name for each in _functions(self.statement.node) for name in _changed_by(each)}

    def _calls(self) -> Iterator[ast.Call]:
        return (n for n in outside_functions(self.statement.node) if isinstance(n, ast.Call))


def _take(more: list[_Effect], left: list[_Effect], chosen: set[int], names: set[str]) -> list[_Effect]:
    for effect in more:
        chosen.add(id(effect.statement))
        names |= effect.statement.reads | effect.statement.binds
    return [effect for effect in left if id(effect.statement) not in chosen]


def _values(program: Program) -> set[str]:
    """The names that are bound to something that may change: no functions, nothing that is imported."""
    kinds = (*_IMPORTS, *_DEFINITIONS)
    return {name for s in program.statements if not isinstance(s.node, kinds) for name in s.binds}


def _by_text(statement: Statement) -> bool:
    if isinstance(statement.node, ast.Import):
        return any(alias.name == "__main__" for alias in statement.node.names)
    if statement.reads & _BY_TEXT:
        return True
    # sys.modules[__name__]; not the usual test below which a script's demonstration stands
    return "sys" in statement.reads and any(
        isinstance(node, ast.Attribute) and node.attr == "modules" for node in ast.walk(statement.node)
    )


def _functions(node: ast.AST) -> Iterator[ast.AST]:
    return (each for each in ast.walk(node) if isinstance(each, (*_DEFINITIONS, ast.Lambda)))


def _changed_by(function: ast.AST) -> Iterator[str]:
    for node in ast.iter_child_nodes(function):
        for inner in outside_functions(node):
            if isinstance(inner, ast.Global):
                yield from inner.names
        yield from changes(node)


def _root(node: ast.AST) -> str:
    """Return the name that an expression such as ``a.b[0].c()`` begins with, or nothing."""
    while isinstance(node, (ast.Attribute, ast.Subscript, ast.Call, ast.Starred)):
        node = node.func if isinstance(node, ast.Call) else node.value
    return node.id if isinstance(node, ast.Name) else ""
