"""What can be expected of an answer, and that no answer makes `expect` raise anything but `Wrong`."""

import contextlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import sparse

from gpcourse.exercises import expect, pictures
from gpcourse.exercises.expect import Wrong
from gpcourse.geometry import shapes
from gpcourse.reference.halfedge import halfedge_mesh


class Odd:
    """A value whose every property raises."""

    def __array__(self, *arguments, **options):
        raise RuntimeError("no")

    def __repr__(self):
        raise RuntimeError("no")


JUNK = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text()
    | st.binary()
    | st.builds(Odd)
    | st.complex_numbers(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner) | st.tuples(inner, inner),
    max_leaves=6,
)
EXPECTATIONS = [
    expect.boolean,
    expect.number,
    expect.integer,
    expect.indices,
    expect.mesh,
    lambda value: expect.array(value, (None, 3)),
    lambda value: expect.array(value, (3,)),
    lambda value: expect.polygons(value, 4),
]


@pytest.mark.parametrize("expectation", EXPECTATIONS)
@given(value=JUNK)
def test_any_value_is_accepted_or_wrong(expectation, value):
    with contextlib.suppress(Wrong):
        expectation(value)


@pytest.mark.parametrize(
    "value", [[0, 2], (0, 2), np.array([0, 2]), np.array([[0], [2]]), np.array([0.0, 2.0], np.float32)]
)
def test_indices_come_in_many_forms(value):
    assert expect.indices(value).tolist() == [0, 2]


@pytest.mark.parametrize("value", [None, {0, 2}, [0.5], [[0, 1], [2, 3]], "02", [np.nan], [1e300], 3.5])
def test_what_is_no_list_of_indices_is_wrong(value):
    with pytest.raises(Wrong):
        expect.indices(value)


@pytest.mark.parametrize("value", [2, 2.0, np.int8(2), np.array([2]), np.array([[2.0]])])
def test_whole_numbers_come_in_many_forms(value):
    assert expect.integer(value) == 2


def test_an_array_may_be_sparse_or_a_list():
    assert expect.array(sparse.eye_array(3), (3, 3)).tolist() == np.eye(3).tolist()
    assert expect.array([[1, 2, 3]], (3,)).tolist() == [1.0, 2.0, 3.0]


def test_a_wrong_shape_is_named_before_anything_else():
    with pytest.raises(Wrong, match=r"has shape \(2, 2\); it should have shape \(k, 3\)"):
        expect.array(np.full((2, 2), np.nan), (None, 3))


def test_the_first_number_that_is_not_finite_is_named():
    with pytest.raises(Wrong, match=r"holds nan at index \(1, 0\)"):
        expect.array([[0, 1], [np.nan, np.inf]], (2, 2))


def test_close_names_the_worst_number():
    with pytest.raises(Wrong) as raised:
        expect.close(np.array([1.0, 2.5, 3.1]), np.array([1.0, 2.0, 3.0]), 0.01, "The lengths")
    assert raised.value.told == "The lengths, worst at index [1]: yours 2.5, expected 2; 2 of 3 differ."
    assert raised.value.message == "The lengths, worst at index [1]: yours 2.5; 2 of 3 differ."


def test_close_counts_rows_where_a_row_belongs_to_a_vertex():
    have, want = np.zeros((2450, 3)), np.zeros((2450, 3))
    have[70] = [0, -3, 4]
    have[:231, 0] += 1
    shown = pictures.Field(np.zeros((2450, 3)), None, "x")
    with pytest.raises(Wrong) as raised:
        expect.close(have, want, 0.01, "x", shown=shown)
    start = "x, worst at vertex 70: yours (1, −3, 4), expected (0, 0, 0)"
    assert raised.value.told == f"{start}; 231 of 2,450 differ."


def test_numbers_that_differ_late_are_shown_with_more_digits():
    with pytest.raises(Wrong) as raised:
        expect.close(1.0 + 1e-9, 1.0, 0.0, "The length")
    assert (raised.value.yours, raised.value.truth) == ("1.000000001", "1")


def test_nan_is_never_close():
    with pytest.raises(Wrong):
        expect.close(np.array([np.nan]), np.array([1.0]), np.inf, "The length")


def test_a_mesh_with_contradicting_records_names_the_halfedge():
    mesh = halfedge_mesh(*shapes.tetrahedron())
    mesh.twin[4] = 4
    with pytest.raises(Wrong, match="Half-edge 4 is its own twin"):
        expect.mesh(mesh)


def test_cycles_are_equal_from_any_start():
    assert expect.cyclic_equal([1, 2, 3], [3, 1, 2])
    assert not expect.cyclic_equal([1, 2, 3], [3, 2, 1])
    assert not expect.cyclic_equal([1, 2], [1, 2, 3])
    assert expect.cyclic_equal([], [])


def test_an_array_of_objects_is_one_of_numbers_if_all_of_them_are():
    assert expect.array(np.array([[1, 2.5]], dtype=object), (1, 2)).dtype == float
    for value in (["1", 2.5], [object(), 1], [2**2000, 1.0], [None, 1.0]):
        with pytest.raises(expect.Wrong):
            expect.array(np.array(value, dtype=object), (2,))
