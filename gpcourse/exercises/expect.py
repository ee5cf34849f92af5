"""What a check can expect of an answer.

Structure comes first: the functions that take a student's value turn it into a plain array, number
or mesh of ours, or raise `Wrong` with the most basic thing that is not right. None of them raises
anything else, whatever the value is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from gpcourse.errors import GeometryError, HalfedgeError
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray, flatten_polygons
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh

if TYPE_CHECKING:
    from gpcourse.exercises.judging import Asked
    from gpcourse.exercises.pictures import Shown
    from gpcourse.view.scene import Scene

#: What an array of objects may hold to be read as one of numbers.
_REAL = (int, float, np.integer, np.floating)


class Wrong(Exception):
    """An answer that is not right, and why.

    Parameters
    ----------
    message : str
        What is not right, in a sentence or two that do not tell what is right: it may be handed out.
    told : str, optional
        The same with what is right, for the student's own notebook.
    yours, truth : str, optional
        What was computed and what is true. The truth is not handed out.
    on : str, optional
        The input, in words.
    picture : callable, optional
        Makes the scene that shows it. It is called only when somebody looks.
    handout : callable, optional
        Makes a scene without the expected values, where `picture` shows them.
    """

    def __init__(
        self,
        message: str,
        *,
        told: str = "",
        yours: str = "",
        truth: str = "",
        on: str = "",
        picture: Callable[[], Scene] | None = None,
        handout: Callable[[], Scene] | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.told = told or message
        self.yours = yours
        self.truth = truth
        self.on = on
        self.picture = picture
        self.handout = handout or picture


def brief(value: object, limit: int = 120) -> str:
    """Write a value in one line of at most `limit` characters."""
    try:
        text = repr(value.tolist()) if isinstance(value, np.ndarray) and value.size <= 64 else repr(value)
    except Exception:  # noqa: BLE001  # a student's __repr__ may fail
        text = f"a {type(value).__name__}"
    text = " ".join(text.split())
    return text if len(text) <= limit else text[: limit - 2] + " …"


def that(holds: object, message: str, **details: Any) -> None:
    """Expect that `holds` is true; `message` and `details` are those of `Wrong`."""
    if not holds:
        raise Wrong(message, **details)


def _refuse(what: str, wanted: str, value: object, on: str) -> NoReturn:
    kind = type(value).__name__
    article = "an" if kind[:1].lower() in "aeiou" else "a"
    hint = " Make a list of it with list(…)." if hasattr(value, "__next__") else ""
    raise Wrong(f"{what} should be {wanted}; it is {article} {kind}.{hint}", yours=brief(value), on=on)


def boolean(value: object, what: str = "The result", *, on: str = "") -> bool:
    """Expect True or False; numpy's own are as good, and so are 1 and 0."""
    if isinstance(value, (bool, np.bool_, int, np.integer)) and value in (0, 1):
        return bool(value)
    if value is None:
        raise Wrong(f"{what} is None: is a `return` missing?", on=on)
    _refuse(what, "True or False", value, on)


def number(value: object, what: str = "The result", *, on: str = "") -> float:
    """Expect one finite real number; an array of one element is as good."""
    if value is None:
        raise Wrong(f"{what} is None: is a `return` missing?", on=on)
    numbers = _array(float(value) if isinstance(value, Fraction) else value, what, "one number", on)
    if numbers.size != 1 or numbers.dtype.kind not in "iuf":
        raise Wrong(f"{what} should be one number; it has shape {numbers.shape}.", yours=brief(value), on=on)
    result = float(numbers.reshape(()))
    if not np.isfinite(result):
        raise Wrong(f"{what} is {result}, not a finite number.", on=on)
    return result


def integer(value: object, what: str = "The result", *, on: str = "") -> int:
    """Expect a whole number; 2.0 is as good as 2."""
    result = number(value, what, on=on)
    if result != int(result):
        raise Wrong(f"{what} should be a whole number.", yours=brief(value), on=on)
    return int(result)


def indices(value: object, what: str = "The result", *, on: str = "") -> IntArray:
    """Expect a list of whole numbers: a list, a tuple, an array of shape (k,), (k, 1) or (1, k)."""
    if value is None:
        raise Wrong(f"{what} is None: is a `return` missing?", on=on)
    if isinstance(value, (set, frozenset, dict)):
        raise Wrong(f"{what} is a {type(value).__name__}, which keeps no order; return a list.", on=on)
    array = _array(value, what, "a list of indices", on)
    if array.size == 0:
        return np.empty(0, dtype=np.int64)
    if array.size != max(array.shape, default=0):
        raise Wrong(f"{what} should be a list of indices; it has shape {array.shape}.", on=on)
    flat = array.ravel()
    if flat.dtype.kind not in "iu" and not (flat.dtype.kind == "f" and bool((flat == np.floor(flat)).all())):
        raise Wrong(f"{what} should hold indices, which are whole numbers.", yours=brief(value), on=on)
    if not bool((np.abs(flat.astype(float)) < 2**62).all()):  # NaN and what does not fit an index
        raise Wrong(f"{what} holds numbers that are no indices.", yours=brief(value), on=on)
    return flat.astype(np.int64)


def array(
    value: object, shape: tuple[int | None, ...], what: str = "The result", *, on: str = ""
) -> FloatArray:
    """Expect finite real numbers in an array of `shape`; None in the shape stands for any length.

    A list is as good as an array, and (k,) as good as (k, 1) or (1, k).
    """
    if value is None:
        raise Wrong(f"{what} is None: is a `return` missing?", on=on)
    numbers = _array(value, what, f"an array of shape {_shape(shape)}", on)
    if len(shape) == 1 and numbers.ndim == 2 and 1 in numbers.shape:
        numbers = numbers.ravel()
    fits = numbers.ndim == len(shape) and all(
        want is None or want == have for want, have in zip(shape, numbers.shape, strict=True)
    )
    if not fits:
        raise Wrong(f"{what} has shape {numbers.shape}; it should have shape {_shape(shape)}.", on=on)
    if numbers.dtype.kind not in "biuf":
        raise Wrong(f"{what} holds {numbers.dtype} values, not real numbers.", yours=brief(value), on=on)
    result = numbers.astype(np.float64)
    if not np.isfinite(result).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(result))[0])
        raise Wrong(f"{what} holds {result[where]} at index {where}.", on=on)
    return result


def close(
    value: FloatArray | float,
    truth: FloatArray | float,
    tolerance: float,
    what: str,
    *,
    on: str = "",
    shown: Shown | None = None,
    **details: Any,
) -> None:
    """Expect numbers within an absolute `tolerance` of the truth; names the worst one. NaN fails.

    `shown` says what the numbers are of. It draws them, and where it has an `item` for each row, rows are
    counted and not numbers.
    """
    have, want = np.asarray(value, dtype=float), np.asarray(truth, dtype=float)
    if bool((np.abs(have - want) <= tolerance).all()):
        return
    if have.ndim == want.ndim == 0:
        mine, true = _told_apart(float(have), float(want))
        raise Wrong(f"{what} is not right.", yours=mine, truth=true, on=on, **details)
    have, want = (np.array(x) for x in np.broadcast_arrays(have, want))
    by_row = shown is not None and bool(shown.item)
    worst, wrong = _worst(have, want, tolerance, by_row)
    at = f"{shown.item} {worst[0]}" if shown and by_row else f"index [{', '.join(map(str, worst))}]"
    mine, true = _both(have[worst], want[worst])
    begin = f"{what.rstrip(',')}, worst at {at}: yours {mine}"
    many = int(np.count_nonzero(wrong))
    end = f"{many:,} of {wrong.size:,} differ{'s' if many == 1 else ''}."
    details = _drawn(shown, have, want, worst) | details
    raise Wrong(f"{begin}; {end}", told=f"{begin}, expected {true}; {end}", on=on, **details)


def flags(
    value: BoolArray,
    truth: BoolArray,
    names: tuple[str, str],
    *,
    on: str = "",
    shown: Shown | None = None,
    item: str = "entry",
) -> None:
    """Expect booleans that equal the truth; `names` say what True and False mean."""
    wrong = np.flatnonzero(value != truth)
    if not len(wrong):
        return
    i = int(wrong[0])
    mine, true = (names[0], names[1]) if value[i] else (names[1], names[0])
    begin = f"{len(wrong):,} of {len(truth):,} are wrong, the first at {shown.item if shown else item} {i}"
    details = _drawn(shown, value.astype(float), truth.astype(float), (i,))
    raise Wrong(f"{begin}: yours {mine}.", told=f"{begin}: yours {mine}, expected {true}.", on=on, **details)


def _drawn(shown: Shown | None, have: FloatArray, want: FloatArray, worst: tuple[int, ...]) -> dict[str, Any]:
    """Return the pictures of a failure, by the names under which `Wrong` takes them."""
    if shown is None:
        return {}
    scene = partial(shown.scene, have, want, worst)
    return {"picture": partial(scene, True), "handout": partial(scene, False)}


def _worst(
    have: FloatArray, want: FloatArray, tolerance: float, by_row: bool
) -> tuple[tuple[int, ...], BoolArray]:
    """Return the index of the worst number, or row, and which of them are wrong."""
    error = np.abs(have - want)
    wrong = ~(error <= tolerance)
    if by_row and error.ndim > 1:
        error, wrong = np.asarray(np.linalg.norm(error, axis=1)), np.asarray(wrong.any(axis=1))
    flat = int(np.argmax(np.where(np.isnan(error), np.inf, error)))
    return tuple(int(i) for i in np.unravel_index(flat, error.shape)), wrong


def _both(mine: FloatArray, true: FloatArray) -> tuple[str, str]:
    """Write two numbers, or two rows of numbers, with as many digits as tell them apart."""
    pairs = [_told_apart(float(a), float(b)) for a, b in zip(np.ravel(mine), np.ravel(true), strict=True)]
    texts = [", ".join(pair[k] for pair in pairs).replace("-", "−") for k in (0, 1)]
    return (f"({texts[0]})", f"({texts[1]})") if np.ndim(mine) else (texts[0], texts[1])


def _told_apart(a: float, b: float) -> tuple[str, str]:
    """Write two numbers with four digits, or with as many as show that they differ.

    What rounding leaves beside the other is zero.
    """
    a, b = (0.0 if abs(x) < 1e-13 * abs(y) else x for x, y in ((a, b), (b, a)))
    digits = 4 if a == b else next((d for d in range(4, 17) if f"{a:.{d}g}" != f"{b:.{d}g}"), 17)
    return f"{a:.{digits}g}", f"{b:.{digits}g}"


def polygons(value: object, n_vertices: int, what: str = "The faces", *, on: str = "") -> list[list[int]]:
    """Expect faces: an (m, k) array or a list of index lists, each with at least three different vertices."""
    if value is None:
        raise Wrong(f"{what} are None: is a `return` missing?", on=on)
    try:
        corners, sizes = flatten_polygons(_integral(value), n_vertices)
    except GeometryError as error:
        raise Wrong(f"{what} are not polygons: {error}.", yours=brief(value), on=on) from None
    except Exception:  # noqa: BLE001  # a student's value may be of any kind
        _refuse(what, "lists of indices", value, on)
    return [part.tolist() for part in np.split(corners, np.cumsum(sizes)[:-1])] if len(sizes) else []


def mesh(
    value: object,
    what: str = "The result",
    *,
    on: str = "",
    picture: Callable[[int | None], Callable[[], Scene] | None] = lambda h: None,
) -> HalfedgeMesh:
    """Expect a HalfedgeMesh whose records agree with each other.

    ``picture(h)`` makes the picture for half-edge h, whose records do not agree.
    """
    if value is None:
        raise Wrong(f"{what} is None: is a `return` missing?", on=on)
    if not isinstance(value, HalfedgeMesh):
        _refuse(what, "a HalfedgeMesh", value, on)
    try:
        value.validate()
    except HalfedgeError as error:
        message = f"The records contradict each other. {_sentence(str(error))}"
        raise Wrong(message, on=on, picture=picture(error.halfedge)) from None
    return value


def same_cycle(value: IntArray, truth: Sequence[int], what: str, *, on: str = "", **details: Any) -> None:
    """Expect the same items in the same cyclic order, from any start."""
    if not cyclic_equal(value.tolist(), list(truth)):
        raise Wrong(what, yours=brief(value), on=on, **details)


def cyclic_equal(a: list[int], b: list[int]) -> bool:
    """Tell whether two lists of different items are equal but for where they start."""
    if len(a) != len(b) or not a:
        return len(a) == len(b)
    return b[0] in a and a[a.index(b[0]) :] + a[: a.index(b[0])] == b


def refusal(
    asked: Asked,
    *arguments: Any,
    because: str,
    naming: Sequence[Sequence[int]] = (),
    on: str = "",
    **options: Any,
) -> None:
    """Expect a ValueError that tells its reader where the fault is.

    `because` says in words what is wrong with the input. `naming` lists alternatives: the text must have
    all numbers of one of them.
    """
    answer = asked.answer(*arguments, **options)
    because = because[:1].upper() + because[1:]
    if answer.status == "returned":
        raise Wrong(f"{because}, but nothing was raised. Raise a ValueError that says where.", on=on)
    trouble = answer.trouble
    if trouble is None or "ValueError" not in trouble.types:
        seen = trouble.types[0] if trouble else "an exception"
        raise Wrong(
            f"{because}, and the function died with {seen}. Raise a ValueError that says where.", on=on
        )
    if naming and not any(all(_mentions(trouble.message, n) for n in numbers) for numbers in naming):
        numbers = " or ".join(" and ".join(map(str, numbers)) for numbers in naming)
        raise Wrong(
            f"{because}. The ValueError does not say where: its text should name {numbers}.",
            yours=brief(trouble.message),
            on=on,
        )


def _mentions(text: str, n: int) -> bool:
    import re

    return re.search(rf"(?<!\d){n}(?!\d)", text) is not None


def _array(value: object, what: str, wanted: str, on: str) -> np.ndarray[Any, Any]:
    try:
        dense = value.toarray() if hasattr(value, "toarray") else value
        result = np.asarray(dense)
        if result.dtype.kind == "O" and all(isinstance(item, _REAL) for item in result.flat):
            result = result.astype(np.float64)
    except Exception:  # noqa: BLE001  # a student's value may be of any kind
        _refuse(what, wanted, value, on)
    if result.dtype.kind not in "biufc":
        _refuse(what, wanted, value, on)
    return result


def _integral(value: object) -> object:
    """Turn faces of whole floats, or an iterator of faces, into what `flatten_polygons` reads."""
    if isinstance(value, np.ndarray) and value.dtype.kind == "f" and bool((value == np.floor(value)).all()):
        return value.astype(np.int64)
    return value


def _shape(shape: tuple[int | None, ...]) -> str:
    names = iter("kmn")
    inside = ", ".join(next(names, "k") if n is None else str(n) for n in shape)
    return f"({inside},)" if len(shape) == 1 else f"({inside})"


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "?", "!")) else ".")
