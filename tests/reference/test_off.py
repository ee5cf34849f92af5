"""The OFF reader and writer: what is written comes back, what is damaged is refused by line."""

import itertools
import random
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gpcourse.errors import ArrayError, DegenerateFaceError, MeshError, OffFormatError
from gpcourse.geometry import shapes, triangles
from gpcourse.reference.halfedge import build_halfedges
from gpcourse.reference.off import read_off, write_off

VERTICES = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]]
FACES = [[0, 1, 2], [0, 2, 3]]
BODY = "0 0 0\n1 0 0\n1 1 0\n0 1 .5\n3 0 1 2\n3 0 2 3\n"

many = settings(
    max_examples=300, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)


def reads_the_two_triangles(text: str) -> None:
    vertices, faces = read_off(text)
    assert vertices.tolist() == VERTICES
    assert np.asarray(faces).tolist() == FACES


# Right files -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "header",
    [
        "OFF\n4 2 5\n",
        "OFF 4 2 5\n",
        "OFF4 2 5\n",
        "OFF\n4 2\n",  # without the edges
        "OFF\n4 2 -1\n",  # the number of edges is not used, so it cannot be wrong
        "# first\n\n  OFF # header\n#\n4 2 5 # counts\n\n# vertices\n",
        "OFF\r\n4 2 5\r\n",
    ],
)
def test_the_header_may_be_written_in_many_ways(header: str) -> None:
    reads_the_two_triangles(header + BODY)


@pytest.mark.parametrize(
    ("header", "extra"),
    [
        ("COFF", "255 128 0 255"),
        ("COFF", "0.5 0.5 0.5"),
        ("NOFF", "0 0 1"),
        ("STOFF", "0.25 0.75"),
        ("CNOFF", "0 0 1 255 128 0 255"),
        ("STCNOFF", "0 0 1 255 128 0 255 0.25 0.75"),
    ],
)
def test_extra_columns_of_vertices_are_left_out(header: str, extra: str) -> None:
    lines = BODY.splitlines()
    rows = [f"{line} {extra}" for line in lines[:4]]
    reads_the_two_triangles("\n".join([header, "4 2 0", *rows, *lines[4:]]))


@pytest.mark.parametrize("colour", ["7", "255 0 0", "0.1 0.2 0.3", "255 0 0 128", "0.1 0.2 0.3 1 # red"])
def test_colours_of_faces_are_left_out(colour: str) -> None:
    reads_the_two_triangles(
        "OFF\n4 2 0\n" + BODY.replace("0 1 2\n", f"0 1 2 {colour}\n").replace("2 3\n", f"2 3 {colour}\n")
    )


def test_what_follows_the_last_face_is_left_out() -> None:
    reads_the_two_triangles("OFF\n4 2 0\n" + BODY + "anything\n3 0 1 99\n")


def test_comments_may_be_in_any_script() -> None:
    reads_the_two_triangles("OFF # Würfel 立方体\n4 2 0\n" + BODY)


def test_faces_of_one_size_are_an_array_and_of_mixed_sizes_lists() -> None:
    cube, prism = shapes.cube(), shapes.prism(5)
    _, quads = read_off(write_off(*cube))
    assert isinstance(quads, np.ndarray)
    assert quads.shape == (6, 4)
    _, mixed = read_off(write_off(*prism))
    assert mixed == prism.faces
    vertices, none = read_off("OFF\n0 0 0\n")
    assert vertices.shape == (0, 3)
    assert np.shape(none) == (0, 3)


# Round trip --------------------------------------------------------------------------------------

finite = st.floats(allow_nan=False, allow_infinity=False)


@st.composite
def meshes(draw: st.DrawFn) -> tuple[list[list[float]], list[list[int]]]:
    vertices = draw(st.lists(st.lists(finite, min_size=3, max_size=3), min_size=3, max_size=8))
    index = st.integers(0, len(vertices) - 1)
    face = st.lists(index, min_size=3, max_size=len(vertices), unique=True)
    return vertices, draw(st.lists(face, max_size=6))


@many
@given(meshes())
def test_round_trip_keeps_every_bit_and_every_polygon(
    mesh: tuple[list[list[float]], list[list[int]]],
) -> None:
    vertices, faces = read_off(write_off(np.array(mesh[0]), mesh[1]))
    # Bytes tell -0.0 from 0.0.
    assert vertices.tobytes() == np.array(mesh[0]).tobytes()
    assert [list(map(int, face)) for face in faces] == mesh[1]


@pytest.mark.parametrize("make", [shapes.random_closed, shapes.random_bounded, shapes.random_polygons])
def test_round_trip_of_shapes(make: Callable[[int], shapes.Shape]) -> None:
    shape = make(5)
    vertices, faces = read_off(write_off(*shape))
    assert vertices.tobytes() == shape.vertices.tobytes()
    assert [list(face) for face in faces] == [list(face) for face in shape.faces]


def test_writing_refuses_what_reading_would_refuse() -> None:
    with pytest.raises(ArrayError, match=r"vertices\[1\].*finite"):
        write_off([[0, 0, 0], [0, np.nan, 0]], [])
    with pytest.raises(MeshError, match="face 0 names vertex 4"):
        write_off(VERTICES, [[0, 1, 4]])
    with pytest.raises(DegenerateFaceError, match="face 1"):
        write_off(VERTICES, [[0, 1, 2], [0, 0, 1]])


# Damaged files -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "text", "says"),
    [
        (1, "", "empty"),
        (2, "# nothing\n", "empty"),
        (1, "PLY\n4 2 0\n", "'PLY' is not OFF"),
        (1, "off\n4 2 0\n", "'off' is not OFF"),
        (1, "4 2 0\n" + BODY, "'4' is not OFF"),
        (1, "OFF BINARY\n\0\0\0\4", "plain OFF"),
        (1, "COFF BINARY\n", "plain OFF"),
        (1, "4OFF\n", "plain OFF"),
        (1, "nOFF\n3\n", "plain OFF"),
        (1, "C4nOFF\n", "plain OFF"),
        (1, "OFF", "before the counts"),
        (3, "OFF\n# 4 2 0\n", "before the counts"),
        (2, "OFF\n4\n", "number of vertices and the number of faces"),
        (2, "OFF\nfour 2 0\n", "'four' is not a whole number"),
        (2, "OFF\n4.0 2 0\n", "'4.0' is not a whole number"),
        (2, "OFF\n-4 2 0\n", "-4"),
        (2, "OFF\n" + "9" * 5000 + " 2 0\n", "whole number"),
        (9, "OFF\n1000000000000 2 0\n" + BODY, "ends after 6 of 1000000000000"),
        (9, "OFF\n4 1000000000000 0\n" + BODY, "ends after 6"),
        (8, "OFF\n4 3 0\n" + BODY.rstrip(), "ends after 6"),
        (4, "OFF\n4 2 0\n" + BODY.replace("1 0 0", "1 x 0"), "'x' is not a finite number"),
        (4, "OFF\n4 2 0\n" + BODY.replace("1 0 0", "1 nan 0"), "'nan'"),
        (4, "OFF\n4 2 0\n" + BODY.replace("1 0 0", "1 -inf 0"), "'-inf'"),
        (4, "OFF\n4 2 0\n" + BODY.replace("1 0 0", "1 1e999 0"), "'1e999'"),
        (4, "OFF\n4 2 0\n" + BODY.replace("1 0 0", "1 1_0 0"), "'1_0'"),
        (4, "OFF\n4 2 0\n" + BODY.replace("1 0 0", "1 \u0663 0"), "not a finite number"),
        (4, "OFF\n4 2 0\n" + BODY.replace("1 0 0", "1 0"), "three coordinates; this line has 2"),
        (7, "OFF\n4 2 0\n" + BODY.replace("3 0 1 2", "3 0 1"), "3 corners and lists 2"),
        (7, "OFF\n4 2 0\n" + BODY.replace("3 0 1 2", "2 0 1"), "2 corners"),
        (7, "OFF\n4 2 0\n" + BODY.replace("3 0 1 2", "-3 0 1 2"), "-3 corners"),
        (7, "OFF\n4 2 0\n" + BODY.replace("3 0 1 2", "1000000000000 0 1 2"), "lists 3"),
        (7, "OFF\n4 2 0\n" + BODY.replace("3 0 1 2", "3 0 1 2.0"), "'2.0' is not a whole number"),
        (8, "OFF\n4 2 0\n" + BODY.replace("3 0 2 3", "3 0 2 4"), "no vertex 4; the indices run from 0 to 3"),
        (8, "OFF\n4 2 0\n" + BODY.replace("3 0 2 3", "3 0 2 -1"), "no vertex -1"),
        (8, "OFF\n4 2 0\n" + BODY.replace("3 0 2 3", "3 0 2 " + "1" * 400), "no vertex 111"),
        (9, "OFF\n# one\n4 2 0\n" + BODY.replace("3 0 2 3", "3 0 2 4"), "no vertex 4"),
    ],
)
def test_damage_is_named_with_its_line(line: int, text: str, says: str) -> None:
    with pytest.raises(OffFormatError) as caught:
        read_off(text)
    assert str(caught.value).startswith(f"line {line}: ")
    assert says in str(caught.value)
    assert caught.value.line == line
    assert isinstance(caught.value, ValueError)


def test_what_is_no_text_is_refused() -> None:
    for value in (b"OFF\n0 0 0\n", None, 7):
        with pytest.raises(OffFormatError, match="give the text"):
            read_off(value)  # type: ignore[arg-type]


def never_raises_anything_else(text: str) -> bool:
    """Read the text, check what comes out, and return whether it was refused."""
    line = 0
    try:
        vertices, faces = read_off(text)
    except OffFormatError as error:
        line = error.line
    else:
        assert np.isfinite(vertices).all()
        assert vertices.ndim == 2
        assert vertices.shape[1] == 3
        assert all(0 <= v < len(vertices) and len(face) >= 3 for face in faces for v in face)
    assert 0 <= line <= text.count("\n") + 1
    return line > 0


@many
@given(st.text())
def test_any_text_is_read_or_refused(text: str) -> None:
    never_raises_anything_else(text)
    never_raises_anything_else("OFF\n" + text)


tokens = st.one_of(
    st.sampled_from(
        ["OFF", "COFF", "4OFF", "BINARY", "#", "\n", "\r", "1e999", "nan", "-1", "3", "1_0", "٣", "9" * 400]
    ),
    st.integers(-2, 12).map(str),
    finite.map(repr),
    st.text(max_size=3),
)


@many
@given(st.lists(tokens, max_size=40), st.sampled_from([" ", "\n", "\t"]))
def test_any_sequence_of_tokens_is_read_or_refused(words: list[str], gap: str) -> None:
    never_raises_anything_else("OFF 2 1 0\n" + gap.join(words))


PIECES = [
    "OFF",
    "NOFF",
    "4OFF",
    "#",
    "\n",
    "\n\n",
    "\r",
    "\0",
    " ",
    "-",
    ".",
    "e",
    "1e999",
    "nan",
    "0",
    "9",
    "1_0",
    "٣",
]


def test_ten_thousand_damaged_files_are_read_or_refused() -> None:
    rng = random.Random(8)
    good = [write_off(*shapes.prism(5)), write_off(*shapes.tetrahedron()), "OFF\n4 2 0\n" + BODY]
    refused = 0
    for _ in range(10_000):
        text = rng.choice(good)
        for _ in range(rng.randint(1, 3)):
            start = rng.randrange(len(text) + 1)
            length = rng.choice([0, 0, 1, 3, 12, 1000])
            text = text[:start] + rng.choice(["", *PIECES]) + text[start + length :]
        refused += never_raises_anything_else(text)
    # Both outcomes are common, or the damage proves little.
    assert 1000 < refused < 9900


# Real files and large ones -----------------------------------------------------------------------


def test_the_sphere_of_the_coursework(real: Path) -> None:
    vertices, faces = read_off((real / "meshes" / "sphere1.off").read_text())
    assert (vertices.shape, np.shape(faces)) == ((42, 3), (80, 3))
    # Seven digits are in the file.
    assert np.linalg.norm(vertices, axis=1) == pytest.approx(1.0, abs=1e-6)
    assert 0.8 * 4 * np.pi / 3 < triangles.enclosed_volume(vertices, faces) < 4 * np.pi / 3
    mesh = build_halfedges(np.asarray(faces), len(vertices))
    mesh.validate()
    assert mesh.n_halfedges == 2 * 120


def test_the_real_meshes_survive_a_round_trip(real: Path) -> None:
    paths = sorted((real / "meshes").glob("*.obj"))
    assert paths
    for path in paths:
        rows = [line.split() for line in path.read_text().splitlines()]
        vertices = np.array([row[1:4] for row in rows if row[:1] == ["v"]], dtype=float)
        corners = [[token.partition("/")[0] for token in row[1:]] for row in rows if row[:1] == ["f"]]
        faces = np.array(corners, dtype=int) - 1
        again, faces_again = read_off(write_off(vertices, faces))
        assert np.array_equal(again, vertices)
        assert np.array_equal(faces_again, faces)


def test_time_grows_with_the_size_of_the_file() -> None:
    texts = [write_off(*shapes.torus(n, n)) for n in (40, 160)]  # 16 times as many faces
    seconds = []
    for text in texts:
        start = time.process_time()
        read_off(text)
        seconds.append(time.process_time() - start)
    # Quadratic growth would be 256 times; linear is 16, and a busy machine gets a factor of 4.
    assert seconds[1] < 64 * max(seconds[0], 1e-3)


def test_headers_with_every_set_of_columns() -> None:
    for letters in itertools.product(("", "ST"), ("", "C"), ("", "N")):
        reads_the_two_triangles("".join(letters) + "OFF\n4 2 0\n" + BODY)
