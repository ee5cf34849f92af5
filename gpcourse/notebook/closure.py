"""What a function of our sources needs to stand alone: imports, private functions, constants."""

from __future__ import annotations

import ast
import symtable
from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass, field
from functools import cache
from importlib.util import find_spec
from inspect import unwrap
from pathlib import Path
from typing import Any

from gpcourse.errors import NotebookError

#: What is defined in these packages is copied; everything else is imported.
COPIED = ("gpcourse.reference", "gpcourse.exercises")


@dataclass(frozen=True)
class Import:
    """``import module as alias``, or ``from module import name as alias``."""

    module: str
    name: str
    alias: str


@dataclass(frozen=True)
class Definition:
    """A function, class or constant of one of our modules, as source under its new name."""

    name: str
    source: str


@dataclass
class Closure:
    """Imports, and definitions in an order in which they can be run; the function itself is the last."""

    imports: list[Import] = field(default_factory=list)
    definitions: list[Definition] = field(default_factory=list)


def closure(function: Callable[..., Any], name: str = "", given: frozenset[str] = frozenset()) -> Closure:
    """Collect what `function` needs.

    Parameters
    ----------
    function : callable
        A function at the top level of a module of `COPIED`.
    name : str
        What it is called in the result; its own name by default.
    given : set of str
        Names that exist where the result will run: functions of `gpcourse.reference` with these names
        are not copied.

    Raises
    ------
    NotebookError
        If the source of `function` is not to be found.
    """
    function = unwrap(function)
    name = name or function.__name__
    module = _module(function.__module__)
    node = _node_of(function, module)
    collector = _Collector(given - {name}, taken={name})
    collector.renamed[(module.name, id(node))] = name
    collector.define(module, node)
    return collector.result


@dataclass
class _Module:
    """A module's source and what each of its global names stands for."""

    name: str
    lines: list[bytes]
    tree: ast.Module
    globals: dict[str, ast.stmt | Import]


@dataclass
class _Collector:
    given: frozenset[str]
    taken: set[str]
    result: Closure = field(default_factory=Closure)
    renamed: dict[tuple[str, int], str] = field(default_factory=dict)

    def define(self, module: _Module, node: ast.stmt) -> None:
        """Add a definition, after all that it needs."""
        name, node = self.renamed[(module.name, id(node))], _without_declaration(node)
        edits: list[tuple[ast.expr, str]] = []
        read = _global_names(node) & module.globals.keys()
        for part in ast.walk(node):
            if isinstance(part, ast.Attribute) and isinstance(part.value, ast.Name) and part.value.id in read:
                source = module.globals[part.value.id]
                if isinstance(source, Import) and _is_module(source):
                    edits.append((part, self.refer(_module(_full(source)), part.attr)))
            elif isinstance(part, ast.Name) and part.id in read:
                source = module.globals[part.id]
                if not (isinstance(source, Import) and _is_module(source)):
                    edits.append((part, self.refer(module, part.id)))
        self.result.definitions.append(Definition(name, _rewritten(module, node, name, edits)))

    def refer(self, module: _Module, name: str) -> str:
        """Make a global name of a module available, and return what it is called in the result."""
        binding = module.globals.get(name)
        if isinstance(binding, Import):
            if _is_copied(binding.module):
                return self.refer(_module(binding.module), binding.name)
            if binding not in self.result.imports:
                self.result.imports.append(binding)
            return binding.alias
        if binding is None:
            raise NotebookError(f"{module.name} has no {name}; a solution that uses it cannot be copied")
        key = (module.name, id(binding))
        if key not in self.renamed:
            if name in self.given and module.name.startswith("gpcourse.reference"):
                return name
            self.renamed[key] = self._free(name)
            self.define(module, binding)
        return self.renamed[key]

    def _free(self, name: str) -> str:
        """Return `name`, or one like it where another definition has it."""
        while name in self.taken:
            name = name + "_" if name.startswith("_") else f"_{name}"
        self.taken.add(name)
        return name


def _global_names(node: ast.stmt) -> set[str]:
    """Return the names that a statement, or a function in it, looks up outside all functions."""
    waiting = [symtable.symtable(ast.unparse(node), "<source>", "exec")]
    names: set[str] = set()
    while waiting:
        table = waiting.pop()
        waiting.extend(table.get_children())
        outside = symtable.Symbol.is_referenced if table.get_type() == "module" else symtable.Symbol.is_global
        names |= {symbol.get_name() for symbol in table.get_symbols() if outside(symbol)}
    return names


def _is_copied(module: str) -> bool:
    return any(module == home or module.startswith(f"{home}.") for home in COPIED)


def _full(source: Import) -> str:
    return f"{source.module}.{source.name}" if source.name else source.module


def _is_module(source: Import) -> bool:
    """Tell whether the import names a module whose parts are copied, as ``reference`` does."""
    try:
        return _is_copied(_full(source)) and find_spec(_full(source)) is not None
    except ModuleNotFoundError:  # its parent is a module, not a package
        return False


@cache
def _module(name: str) -> _Module:
    spec = find_spec(name)
    if spec is None or spec.origin is None or not _is_copied(name):
        raise NotebookError(f"the source of {name} is not ours; write the solution in a module of the course")
    source = Path(spec.origin).read_bytes().replace(b"\r\n", b"\n")
    tree = ast.parse(source)
    table: dict[str, ast.stmt | Import] = {}
    for node in _top_level(tree):
        table.update(_bindings(node))
    return _Module(name, source.split(b"\n"), tree, table)


def _top_level(tree: ast.Module) -> Iterator[ast.stmt]:
    """Yield the statements of a module, those under ``if TYPE_CHECKING`` included."""
    for node in tree.body:
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            yield from node.body
        else:
            yield node


def imports_of(node: ast.Import | ast.ImportFrom) -> Iterator[Import]:
    """Yield what a statement imports; nothing for ``from __future__``."""
    module = node.module or "" if isinstance(node, ast.ImportFrom) else ""
    for alias in node.names if module != "__future__" else []:
        name = alias.asname or alias.name
        yield Import(module, alias.name, name) if module else Import(alias.name, "", name)


def _bindings(node: ast.stmt) -> Iterator[tuple[str, ast.stmt | Import]]:
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        yield from ((each.alias, each) for each in imports_of(node))
    elif isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        yield node.name, node
    elif isinstance(node, (ast.Assign, ast.AnnAssign)):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        yield from ((target.id, node) for target in targets if isinstance(target, ast.Name))


def _node_of(function: Callable[..., Any], module: _Module) -> ast.FunctionDef:
    line = function.__code__.co_firstlineno
    for node in module.tree.body:
        if isinstance(node, ast.FunctionDef):
            starts = {node.lineno, *(decorator.lineno for decorator in node.decorator_list)}
            if line in starts:
                return node
    raise NotebookError(
        f"{function.__name__} is not at the top level of {module.name}; move it there to have it copied"
    )


def _rewritten(module: _Module, node: ast.stmt, name: str, edits: list[tuple[ast.expr, str]]) -> str:
    """Return the source of a definition under its new name, with what it refers to renamed."""
    lines = dict(enumerate(module.lines[node.lineno - 1 : node.end_lineno], start=node.lineno))
    for part, new in sorted(edits, key=lambda edit: (-edit[0].lineno, -edit[0].col_offset)):
        if part.lineno == part.end_lineno and part.lineno in lines:
            line = lines[part.lineno]
            lines[part.lineno] = line[: part.col_offset] + new.encode() + line[part.end_col_offset :]
    decorators = ""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        decorators = "".join(f"@{ast.unparse(decorator)}\n" for decorator in node.decorator_list)
        keyword = b"class " if isinstance(node, ast.ClassDef) else b"def "
        first = lines[node.lineno]
        lines[node.lineno] = first.replace(keyword + node.name.encode(), keyword + name.encode(), 1)
    return decorators + b"\n".join(lines.values()).decode("utf-8")


def _without_declaration(node: ast.stmt) -> ast.stmt:
    """Leave out the decorator that declares a variant or a mistake, as ``@GENUS.variant(...)``."""
    if not isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        return node
    bare = copy(node)
    bare.decorator_list = [d for d in node.decorator_list if not ast.unparse(d).split(".")[0].isupper()]
    return bare
