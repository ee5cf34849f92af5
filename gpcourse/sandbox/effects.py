"""What else a function of a notebook may need: statements that act on its names without binding them.

`Program.needed` goes by the names that statements bind. Python can also fill a table in a function, put a
function into a registry by a decorator, or make names from strings. What may do that is run where a function
has not passed without it; so no honest student loses points because a statement was left out. Such statements
may be demonstrations too, slow or broken ones. Therefore this is the second try and not the first.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import cached_property

from gpcourse.sandbox.program import Program, Statement, changes, outside_functions

#: With these a program finds names by their text: any statement may then bind or read any name.
_BY_TEXT = {"exec", "eval", "globals", "locals", "vars", "__main__"}
#: What is called to show something. It changes none of its arguments.
_SHOWS = {"print", "display", "check", "hint", "solution", "progress", "view", "help", "plt", "repr", "len"}

_IMPORTS = (ast.Import, ast.ImportFrom)
_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_FIXED = (*_IMPORTS, *_DEFINITIONS)


class Effects:
    """What the statements of a program may change without binding it."""

    def __init__(self, program: Program) -> None:
        self.program = program
        statements = program.statements
        # What is no function and not imported may change.
        self.values = frozenset().union(*(s.binds for s in statements if not isinstance(s.node, _FIXED)))
        self.imported = frozenset().union(*(s.binds for s in statements if isinstance(s.node, _IMPORTS)))
        self.by_text = any(map(_by_text, statements))
        effects = [_Effect(s, self) for s in statements]
        # Functions that change a name when they are called.
        self.workers = frozenset().union(*(e.statement.binds for e in effects if e.inside))
        self.effects = [e for e in effects if e.acts or e.calls]

    def needed_at_most(self, name: str) -> list[Statement]:
        """Return the statements that `name` may need, in the order of the notebook: as `needed`, or more."""
        chosen = {id(s): s for s in self.program.needed(name)}
        if not self.effects and not self.by_text:
            return list(chosen.values())
        names = {name}.union(*(s.reads for s in chosen.values()))
        new: set[str] = set()  # names that only what was added needs
        workers: set[str] = set()  # functions that change one of the names
        more = self._found_by_text() if self.by_text else []
        while more := [s for s in more if id(s) not in chosen] or self._acting(names, workers, chosen):
            for statement in more:
                chosen[id(statement)] = statement
                new |= (statement.reads | statement.binds) - names
                names |= new
            places = {i for each in new for i in self.program.binders.get(each, ())}
            more = [self.program.statements[i] for i in places]
        return [s for s in self.program.statements if id(s) in chosen]

    def _found_by_text(self) -> list[Statement]:
        decorated = {id(e.statement) for e in self.effects if e.decorators}
        return [s for s in self.program.statements if s.binds or id(s) in decorated or _by_text(s)]

    def _acting(self, names: set[str], workers: set[str], chosen: Mapping[int, Statement]) -> list[Statement]:
        found = []
        for effect in self.effects:
            if effect.inside & names:
                workers |= effect.statement.binds
            if id(effect.statement) not in chosen and effect.acts_on(names, workers):
                found.append(effect.statement)
        return found


class _Effect:
    """A statement, and which names it may change without binding them."""

    def __init__(self, statement: Statement, program: Effects) -> None:
        self.statement = statement
        self._program = program

    def acts_on(self, names: set[str], workers: set[str]) -> bool:
        """Tell whether it may change one of the `names`, or calls one of the functions `workers`."""
        return bool(self.acts & names) or bool(self.calls & workers)

    @cached_property
    def acts(self) -> set[str]:
        """The names that it may change."""
        return self.decorators | self.touched | self.aliased | self.inside

    @cached_property
    def decorators(self) -> set[str]:
        """The notebook's own names that decorate a definition."""
        found = {_root(each) for each in getattr(self.statement.node, "decorator_list", ())}
        return found - self._program.imported - {""}

    @cached_property
    def calls(self) -> set[str]:
        """The functions of `Effects.workers` that it calls or is decorated with."""
        if not self.statement.reads & self._program.workers:
            return set()
        nodes = (n for n in outside_functions(self.statement.node) if isinstance(n, ast.Call))
        called = self.decorators | {n.func.id for n in nodes if isinstance(n.func, ast.Name)}
        return called & self._program.workers

    @cached_property
    def touched(self) -> set[str]:
        """What is given to a call whose result is dropped, what that is a method of, or what it is."""
        if isinstance(self.statement.node, _FIXED) or not self.statement.reads & self._program.values:
            return set()
        found: set[str] = set()
        for inner in _expressions(self.statement.node):
            call = inner.value
            if isinstance(call, ast.Call) and (root := _root(call.func)) not in _SHOWS:
                found.update(map(_root, (*call.args, *(k.value for k in call.keywords))))
                found.add(root)
        return found & self._program.values

    @cached_property
    def aliased(self) -> set[str]:
        """The names of what it gives another name."""
        node = self.statement.node
        return {_root(node.value)} & self._program.values if isinstance(node, ast.Assign) else set()

    @cached_property
    def inside(self) -> set[str]:
        """The global names that its functions bind or change when they are called."""
        node, statement = self.statement.node, self.statement
        if isinstance(node, _IMPORTS) or not (statement.declares or statement.reads & self._program.values):
            return set()
        return {name for each in _functions(node) for name in _changed_by(each)} & self.statement.reads


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


def _expressions(node: ast.AST) -> Iterator[ast.Expr]:
    """Yield the statements that are expressions, in loops and branches too."""
    if isinstance(node, ast.Expr):
        yield node
    elif not isinstance(node, (*_DEFINITIONS, ast.ClassDef)):
        for part in ("body", "orelse", "finalbody", "handlers", "cases"):
            for inner in getattr(node, part, ()):
                yield from _expressions(inner)


def _root(node: ast.AST) -> str:
    """Return the name that an expression such as ``a.b[0].c()`` begins with, or nothing."""
    while isinstance(node, (ast.Attribute, ast.Subscript, ast.Call, ast.Starred)):
        node = node.func if isinstance(node, ast.Call) else node.value
    return node.id if isinstance(node, ast.Name) else ""
