"""Finding out what a check asks whatever the answers are.

The check is run with answers that cannot be looked at: the first thing that it does with one ends the run.
All that it asked until then, it asks of everybody.
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any, NoReturn

from gpcourse.exercises.exercise import Check, Exercise
from gpcourse.exercises.judging import Asked, generator
from gpcourse.sandbox.call import Answer
from gpcourse.sandbox.proxy import question


class _Touched(BaseException):
    """Raised when an answer is looked at; no ``except Exception`` in a check keeps it."""


class _Sealed:
    """An answer that cannot be looked at. It says so to its plan, should the exception get lost."""

    __slots__ = ("_plan",)

    def __init__(self, plan: _Plan) -> None:
        object.__setattr__(self, "_plan", plan)


def _touch(sealed: _Sealed, *_: object, **__: object) -> NoReturn:
    object.__getattribute__(sealed, "_plan").over = True
    raise _Touched


_BINARY = (
    "add", "sub", "mul", "matmul", "truediv", "floordiv", "mod", "divmod", "pow", "lshift", "rshift", "and",
    "xor", "or",
)  # fmt: skip
_OTHER = (
    "getattribute", "getattr", "setattr", "delattr", "repr", "str", "bytes", "format", "lt", "le", "eq", "ne",
    "gt", "ge", "hash", "bool", "len", "length_hint", "iter", "next", "reversed", "contains", "getitem",
    "setitem", "delitem", "call", "int", "float", "complex", "index", "round", "trunc", "floor", "ceil",
    "neg", "pos", "abs", "invert", "enter", "exit", "array", "array_ufunc", "array_function",
    "array_interface", "copy", "deepcopy", "reduce", "reduce_ex",
)  # fmt: skip
for _name in (*_OTHER, *_BINARY, *(f"r{name}" for name in _BINARY), *(f"i{name}" for name in _BINARY)):
    setattr(_Sealed, f"__{_name}__", _touch)


class _Plan(Asked):
    """Stands for the student's function, and writes down what is asked."""

    def __init__(self, exercise: Exercise) -> None:
        super().__init__(exercise, self._refuse, exercise.time_limit)
        self.frames: list[bytes] = []
        self.refusals: list[bool] = []
        self.over = False

    def _refuse(self, *_: object) -> NoReturn:
        raise _Touched

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        return self._note(arguments, options, refusal=False)

    def answer(self, *arguments: Any, **options: Any) -> Answer:
        sealed: Answer = self._note(arguments, options, refusal=True)
        return sealed

    def _note(self, arguments: tuple[Any, ...], options: dict[str, Any], *, refusal: bool) -> Any:
        if self.over:
            raise _Touched
        self.frames.append(question(arguments, options))
        self.refusals.append(refusal)
        return _Sealed(self)


def planned(exercise: Exercise, check: Check, seed: int) -> tuple[tuple[bytes, ...], tuple[bool, ...]]:
    """Return the questions that a check asks whatever the answers are, as frames.

    Beside them stands for which of them the check goes on when the call raises an exception.
    """
    plan = _Plan(exercise)
    # Whatever else is wrong with the check is found when it is really run.
    with suppress(_Touched, Exception):
        check.run(plan, generator(exercise, check, seed))
    return tuple(plan.frames), tuple(plan.refusals)
