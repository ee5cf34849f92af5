"""Gentle words for the exceptions that students meet most."""

from __future__ import annotations

from gpcourse.exercises.course import by_name
from gpcourse.exercises.exercise import Exercise
from gpcourse.sandbox.call import Trouble

_NONE = (
    "Something is None there that should hold a value. Does a function that you call end without `return`?"
)
_NOT_WHOLE = "An index is not a whole number. `/` always gives a float, `//` does not."

#: Exception, a part of its message, advice. The first line that fits counts.
_ADVICE = (
    ("UnboundLocalError", "", "On some path through the function, this name is used before it gets a value."),
    (
        "NameError",
        "",
        "Python does not know this name. Is it spelled as where it is defined? Was that cell run?",
    ),
    ("IndexError", "too many indices", "The array has fewer dimensions than you use. What is its `.shape`?"),
    ("IndexError", "only integers", _NOT_WHOLE),
    ("IndexError", "", "An index points past the end. A list of n items has the indices 0 to n - 1."),
    ("KeyError", "", "The dictionary has no entry for this key. Which keys does it have at that point?"),
    ("TypeError", "NoneType", _NONE),
    ("AttributeError", "NoneType", _NONE),
    ("AttributeError", "", "This object has no such attribute. What is its type at that point?"),
    (
        "TypeError",
        "unexpected keyword argument",
        "The function was called with an option that it does not take. Which ones has the stub?",
    ),
    ("TypeError", "positional argument", "The number of arguments is not what the function takes."),
    (
        "TypeError",
        "not callable",
        "What stands before the parentheses is no function. Is it a list or an array?",
    ),
    ("TypeError", "must be integers", _NOT_WHOLE),
    ("TypeError", "only integer", _NOT_WHOLE),
    ("ValueError", "could not be broadcast", "Two arrays do not fit together. What are their shapes?"),
    (
        "ValueError",
        "truth value",
        "An array of many values is neither true nor false: use `.all()` or `.any()`.",
    ),
    ("ValueError", "to unpack", "The number of names on the left is not the number of values on the right."),
    (
        "ZeroDivisionError",
        "",
        "The divisor is zero for this input. Can that be, and what should come out then?",
    ),
    (
        "RecursionError",
        "",
        "The function calls itself without end. Which case should stop it, and is it reached?",
    ),
    (
        "ModuleNotFoundError",
        "",
        "This package is not installed here. The exercises need numpy and scipy only.",
    ),
    ("LinAlgError", "Singular", "The matrix has no inverse for this input. What is its rank?"),
    ("SystemExit", "", "The function ends the program. Leave it with `return` instead."),
    (
        "SyntaxError",
        "",
        "Python cannot read this line. A parenthesis or a colon may be missing, here or before.",
    ),
)


def advice(exercise: Exercise, trouble: Trouble) -> str:
    """Return a sentence or two on an exception, or an empty string."""
    if "NotImplementedError" in trouble.types:
        return _on_stub(exercise, trouble.function)
    for kind, part, words in _ADVICE:
        if kind in trouble.types and part in trouble.message:
            return words
    return ""


def _on_stub(exercise: Exercise, function: str) -> str:
    if function in by_name() and function != exercise.name:
        return f"`{exercise.name}` calls `{function}`, which is still a stub: solve that one first."
    return "A part of the function is still to be written."
