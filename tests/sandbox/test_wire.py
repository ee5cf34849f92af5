"""What crosses between processes arrives as it was; what is not ours is refused, and nothing else happens."""

import collections
import contextlib
import json
import struct
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from gpcourse.errors import WireError
from gpcourse.geometry import functions
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh
from gpcourse.sandbox import wire
from gpcourse.sandbox.encoding import DTYPES
from gpcourse.sandbox.values import same

text = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
keys = text | st.integers(-(2**59), 2**59)
numbers = st.integers(-(2**200), 2**200) | st.floats() | st.booleans() | st.none() | st.complex_numbers()


@st.composite
def arrays(draw):
    dtype = np.dtype(draw(st.sampled_from(DTYPES)))
    shape = tuple(draw(st.lists(st.integers(0, 4), max_size=3)))
    count = int(np.prod(shape))
    raw = draw(st.binary(min_size=count * dtype.itemsize, max_size=count * dtype.itemsize))
    array = np.frombuffer(raw, np.uint8)
    return (array % 2 == 0).reshape(shape) if dtype.kind == "b" else np.ndarray(shape, dtype, array.tobytes())


values = st.recursive(
    numbers | text | arrays() | st.binary(max_size=20) | st.sets(keys, max_size=4),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.lists(inner, max_size=4).map(tuple)
        | st.dictionaries(keys, inner, max_size=4)
    ),
    max_leaves=12,
)


def identical(a, b):
    """Equal in type, structure and bits."""
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(map(identical, a, b))
    if isinstance(a, dict):
        return list(a) == list(b) and all(identical(a[k], b[k]) for k in a)
    return repr(a) == repr(b) if isinstance(a, (float, complex)) else a == b


def there_and_back(value, **options):
    return wire.unpack(wire.pack(value, **options))


@given(values)
@settings(max_examples=200, deadline=None)
def test_a_value_arrives_as_it_was(value):
    assert identical(there_and_back(value), value)


@given(st.binary(max_size=200))
@settings(max_examples=200, deadline=None)
def test_random_bytes_are_refused(noise):
    with pytest.raises(WireError):
        wire.unpack(noise)


@given(values, st.data())
@settings(max_examples=300, deadline=None)
def test_a_damaged_frame_gives_a_value_or_a_wire_error(value, data):
    frame = bytearray(wire.pack([value, np.arange(3)]))
    for _ in range(data.draw(st.integers(1, 4))):
        frame[data.draw(st.integers(0, len(frame) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(frame)))
    for damaged in (bytes(frame), bytes(frame[:cut])):
        with contextlib.suppress(WireError):
            wire.unpack(damaged)


trees = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | text | st.sampled_from(DTYPES),
    lambda inner: st.lists(inner, max_size=5)
    | st.tuples(
        st.sampled_from(
            ["list", "tuple", "set", "dict", "function", "array", "scalar", "objects", "sparse", "mesh",
             "int", "complex", "bytes", "opaque"]
        ),
        st.lists(inner, max_size=4),
    ).map(lambda pair: [pair[0], *pair[1]]),
    max_leaves=20,
)  # fmt: skip


def frame_of(tree, sizes=(), buffers=b""):
    header = json.dumps([tree, list(sizes)]).encode()
    return struct.pack("<4sIQ", b"gpc1", len(header), len(buffers)) + header + buffers


@given(trees)
@settings(max_examples=400, deadline=None)
def test_a_well_formed_header_of_nonsense_gives_a_value_or_a_wire_error(tree):
    with contextlib.suppress(WireError):
        wire.unpack(frame_of(tree))


@pytest.mark.parametrize(
    ("frame", "word"),
    [
        (frame_of(["array", "<f8", [10**9, 10**9], 0], [8], bytes(8)), "shape"),
        (frame_of(["array", "|O", [1], 0], [8], bytes(8)), "type"),
        (frame_of(["list", *[["array", "<f8", [1], 0]] * 2], [8], bytes(8)), "used already"),
        (frame_of(["array", "|b1", [1], 0], [1], b"\x07"), "booleans"),
        (frame_of(1, [8], bytes(8)), "no array uses"),
        (frame_of(["dict", ["a", 1], ["a", 2]]), "occurs twice"),
        (frame_of(["dict", [2**61 - 1, 1]]), "key"),
        (frame_of(["opaque", "os.system"]), "name"),
        (frame_of(["pickle", "x"]), "unknown kind"),
        (struct.pack("<4sIQ", b"gpc1", 2**32 - 1, 0), "more than is allowed"),
        (struct.pack("<4sIQ", b"gpc1", 2, 2**60) + b"{}", "more than is allowed"),
        (struct.pack("<4sIQ", b"gpc1", 200_000, 0) + b"[" * 200_000, "not JSON"),
    ],
)
def test_forged_frames_are_refused_by_name(frame, word):
    with pytest.raises(WireError, match=word):
        wire.unpack(frame)


def test_reading_a_forged_frame_takes_little_memory():
    hungry = frame_of(["list", *[["array", "<f8", [2**30], i] for i in range(100)]], [0] * 100)
    tracemalloc.start()
    with pytest.raises(WireError):
        wire.unpack(hungry)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1_000_000


def peak_of(frame):
    """Return the bytes of memory that reading a frame takes at most, and whether it is a value."""
    tracemalloc.start()
    try:
        np.asarray(wire.unpack(frame), dtype=object)
        return tracemalloc.get_traced_memory()[1], True
    except WireError:
        return tracemalloc.get_traced_memory()[1], False
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "tree", [["list"], ["set"], ["dict"], ["opaque", "a"], ["int", "1"], 1.5, "ab"], ids=str
)
def test_a_frame_takes_no_more_memory_than_its_weight(tree):
    frame = frame_of(["list", *[tree] * 20_000])
    assert peak_of(frame)[0] < wire.weight(frame[: wire.HEAD.size]) + 100_000


def test_a_long_text_among_short_ones_would_fill_the_memory_and_is_refused():
    """numpy gives each text of an array the length of the longest: here 4 GB."""
    for long in ("x" * 2**20, b"x" * 2**20):
        with pytest.raises(WireError, match="characters"):
            there_and_back(["y", [long, *["y"] * 1000]])
    assert len(there_and_back(["x" * 1000] * 1000)) == 1000


@pytest.mark.parametrize("send", [lambda: [object() for _ in range(1100)], lambda: [Foo()] * 1100])
def test_each_value_of_another_kind_is_a_class_and_they_are_few(send):
    with pytest.raises(WireError, match="too many"):
        wire.pack(send(), lenient=True)
    with pytest.raises(WireError, match="other kinds"):
        wire.unpack(frame_of(["list", *[["opaque", f"a{i}"] for i in range(1100)]]))


def test_a_sparse_matrix_that_would_be_large_if_written_out_does_not_cross():
    with pytest.raises(WireError, match="too large"):
        wire.pack(sparse.csr_array((10**4, 10**6)))


def test_a_stream_holds_frame_after_frame_and_says_when_it_ends():
    import io

    stream = io.BytesIO(wire.pack("one") + wire.pack(np.arange(5)) + wire.pack("cut off")[:-2])
    assert wire.receive(stream.read) == "one"
    assert wire.receive(stream.read).tolist() == [0, 1, 2, 3, 4]
    with pytest.raises(WireError, match="ends after"):
        wire.receive(stream.read)
    with pytest.raises(EOFError):
        wire.receive(stream.read)


def test_a_mesh_is_rebuilt_with_all_its_records():
    loop = HalfedgeMesh(
        [1, 0], [0, 1], [0, 1], [0, 1], [0, -1], [0, 1], [0], vertices=[[0, 0, 0], [1, 0, 0.1]]
    )
    back = there_and_back(loop)
    assert isinstance(back, HalfedgeMesh)
    assert same(loop, back)


def test_a_mesh_with_something_planted_in_it_does_not_cross():
    mesh = HalfedgeMesh([1, 0], [0, 1], [0, 1], [0, 1], [0, -1], [0, 1], [0])
    object.__setattr__(mesh, "next", [[0, 1], [2, 3]])
    with pytest.raises(WireError, match="broken: next"):
        wire.pack(mesh, lenient=True)


@pytest.mark.parametrize("format", ["csr", "csc", "coo", "lil", "dok", "dia", "bsr"])
def test_sparse_matrices_of_every_format_keep_their_numbers(format):
    i, j = np.random.default_rng(1).integers(0, (5, 7), size=(20, 2)).T  # entries that occur twice are summed
    matrix = sparse.coo_array((np.arange(20) + 0.5, (i, j)), shape=(5, 7)).asformat(format)
    assert np.array_equal(there_and_back(matrix).toarray(), matrix.toarray())


@pytest.mark.parametrize(
    ("indices", "indptr"),
    [
        ([0, 5], [0, 1, 2]),
        ([0, -1], [0, 1, 2]),
        ([0, 1], [0, 2, 1]),
        ([0, 1], [0, 1, 9]),
        ([0, 1], [1, 1, 2]),
    ],
)
def test_a_sparse_matrix_that_would_crash_a_product_is_refused(indices, indptr):
    matrix = sparse.csr_array((np.ones(2), np.array([0, 1]), np.array([0, 1, 2])), shape=(2, 2))
    matrix.indices, matrix.indptr = np.array(indices), np.array(indptr)
    tree = ["sparse", [2, 2], *(["array", a.dtype.str, [len(a)], k] for k, a in enumerate(
        (matrix.data, matrix.indices, matrix.indptr)))]  # fmt: skip
    parts = [matrix.data.tobytes(), matrix.indices.tobytes(), matrix.indptr.tobytes()]
    with pytest.raises(WireError, match="sparse"):
        wire.unpack(frame_of(tree, map(len, parts), b"".join(parts)))


class Foo:
    """A student's own class, of no use to a check."""


class Own:
    """A student's own class that numpy can read."""

    def __array__(self, dtype=None, copy=None):
        return np.arange(3.0)


def test_what_cannot_cross_arrives_as_the_name_of_its_type():
    for value in (Foo(), (i for i in range(3)), {(0, 1): 2}, {2.5}, np.zeros(2, dtype="M8[s]")):
        back = there_and_back(value, lenient=True)
        assert type(back).__name__ == type(value).__name__
        with pytest.raises(WireError, match=type(value).__name__):
            wire.pack(value)


def test_what_numpy_can_read_arrives_as_numbers():
    row = collections.deque([1, 2])
    for value, wanted in [
        (Own(), [0, 1, 2]),
        (row, [1, 2]),
        (range(3), [0, 1, 2]),
        (np.array([[1, 2]]).view(np.matrix), [[1, 2]]),
        (np.ma.masked_array([1, 2]), [1, 2]),
        (np.arange(6).reshape(2, 3).T, [[0, 3], [1, 4], [2, 5]]),
        (np.arange(3, dtype=">i4"), [0, 1, 2]),
        (np.arange(3, dtype=np.longdouble), [0, 1, 2]),
        (np.float32(1.5), 1.5),
        (collections.OrderedDict({np.int64(3): [True]}), {3: [True]}),
    ]:
        back = there_and_back(value, lenient=True)
        assert back == wanted if isinstance(back, dict) else np.array_equal(back, wanted)


def test_faces_of_different_sizes_in_an_array_of_objects():
    faces = np.array([[0, 1, 2], [0, 2, 3, 4]], dtype=object)
    assert [list(face) for face in there_and_back(faces)] == [[0, 1, 2], [0, 2, 3, 4]]


def test_a_set_stays_a_set():
    assert there_and_back({3, "a", np.int64(5)}) == {3, "a", 5}


def cyclic():
    row = []
    row.append(row)
    return row


@pytest.mark.parametrize(
    ("value", "word"),
    [
        (cyclic(), "levels deep"),
        (range(10**12), "return an array"),
        ([0] * 600_000, "return an array"),
        (np.broadcast_to(1.0, (10**6, 10**3)), "too large"),
        ("x" * 2_000_000, "characters"),
        (1 << 100_000, "bits"),
    ],
    ids=["cycle", "range", "list", "array", "text", "integer"],
)
def test_what_is_too_large_is_refused_before_it_is_written(value, word):
    with pytest.raises(WireError, match=word):
        wire.pack(value, lenient=True)


def test_a_lone_surrogate_becomes_a_question_mark():
    assert there_and_back("a\ud800b") == "a?b"


@pytest.mark.parametrize(
    "function",
    [
        functions.sphere([1, 2, 3], 2.0), functions.Waves([1.0, 2.0], np.eye(3)[:2], [0.1, 0.2], 3.0),
        functions.sampled(lambda x: x[..., 0] ** 2, [0, 0, 0], [1, 1, 2], 4), functions.helix(2.0, 0.3),
    ],
)  # fmt: skip
def test_a_function_goes_to_a_student_by_its_parameters_and_never_comes_back(function):
    sent = wire.pack((function, 1))
    back = wire.unpack(sent, functions=True)[0]
    assert same(back, function)
    where = np.linspace(0, 1, 12).reshape(4, 3)
    assert np.array_equal(back(where), function(where))
    with pytest.raises(WireError, match="only values"):
        wire.unpack(sent)
    assert type(there_and_back(function, lenient=True)).__name__ == type(function).__name__
    assert not callable(there_and_back(function, lenient=True))


@pytest.mark.parametrize(
    "tree",
    [["function"], ["function", "system"], ["function", "Quadric"], ["function", "Quadric", 1, 2, 3],
     ["function", "Quadric", *[None] * 9], ["function", ["Quadric"]]],
)  # fmt: skip
def test_a_function_that_is_none_of_ours_is_refused(tree):
    with pytest.raises(WireError, match="function"):
        wire.unpack(frame_of(tree), functions=True)
