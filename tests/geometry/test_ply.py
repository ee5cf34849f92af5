"""Reading PLY: three encodings, what nobody asked for, and damaged files."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gpcourse.errors import PlyFormatError
from gpcourse.geometry import shapes
from gpcourse.geometry.ply import Lists, read_ply, read_ply_elements

HEADER = """ply
format {encoding} 1.0
comment made by a test
obj_info num_cols 2
element vertex {n}
property float x
property float y
property uchar quality
property double z
element face {m}
property list uchar int vertex_indices
element range_grid 3
property list uchar int vertex_indices
property short temperature
end_header
"""
ENCODINGS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
GRID = [([], -5), ([1], 7), ([0, 2], 300)]


def file_of(encoding, vertices, faces, newline="\n"):
    """Write a mesh with properties and an element that no mesh has."""
    order = ENCODINGS[encoding]
    head = HEADER.format(encoding=encoding, n=len(vertices), m=len(faces)).replace("\n", newline).encode()
    if not order:
        rows = [f"{x!r} {y!r} 9 {z!r}" for x, y, z in np.asarray(vertices).tolist()]
        rows += [" ".join(map(str, [len(f), *f])) for f in faces]
        rows += [" ".join(map(str, [len(items), *items, heat])) for items, heat in GRID]
        return head + "".join(row + newline for row in rows).encode()
    body = b"".join(struct.pack(order + "ffBd", x, y, 9, z) for x, y, z in vertices)
    body += b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in faces)
    body += b"".join(struct.pack(f"{order}B{len(i)}ih", len(i), *i, heat) for i, heat in GRID)
    return head + body


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("make", [shapes.icosahedron, shapes.cube, lambda: shapes.prism(5)])
def test_every_encoding_gives_the_same_mesh(encoding, newline, make, tmp_path):
    shape = make()
    vertices = shape.vertices.astype(np.float32).astype(float)  # x and y are stored in 32 bits
    path = tmp_path / "mesh.ply"
    path.write_bytes(file_of(encoding, vertices, [list(map(int, f)) for f in shape.faces], newline))
    points, faces = read_ply(path)
    assert np.array_equal(points, vertices)
    assert [list(f) for f in faces] == [list(f) for f in shape.faces]
    assert isinstance(faces, np.ndarray) == isinstance(shape.faces, np.ndarray)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_elements_that_nobody_asked_for_are_there_for_who_does(encoding):
    elements = read_ply_elements(file_of(encoding, np.eye(3), [[0, 1, 2]]))
    grid = elements["range_grid"]
    assert isinstance(grid["vertex_indices"], Lists)
    assert grid["vertex_indices"].sizes.tolist() == [0, 1, 2]
    assert grid["vertex_indices"].flat.tolist() == [1, 0, 2]
    assert grid["temperature"].tolist() == [-5, 7, 300]
    assert elements["vertex"]["quality"].tolist() == [9, 9, 9]


def test_points_alone_have_no_faces(tmp_path):
    path = tmp_path / "points.ply"
    path.write_text(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n1 2 3\n"
    )
    points, faces = read_ply(path)
    assert points.tolist() == [[1, 2, 3]]
    assert faces.shape == (0, 3)


GOOD = file_of("ascii", np.eye(3), [[0, 1, 2]]).decode()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "first line is not ply"),
        ("OFF\n3 1 0\n", "first line is not ply"),
        (GOOD.replace("end_header", "end"), "no line end_header"),
        (GOOD.replace("format ascii 1.0\n", ""), "no line such as: format"),
        (GOOD.replace("ascii 1.0", "ascii 2.0"), "line 2"),
        (GOOD.replace("vertex 3", "vertex three"), "line 5"),
        (GOOD.replace("vertex 3", "vertex -3"), "line 5"),
        (GOOD.replace("vertex 3", "vertex 4"), "follow|announces|list of|whole"),
        (GOOD.replace("vertex 3", "vertex 999999999999"), "announces 999999999999 rows of vertex"),
        (GOOD.replace("property float y", "property quad y"), "line 7"),
        (GOOD.replace("property float y", "property float x"), "two properties called x"),
        (GOOD.replace("property float y", "property float why"), "no element vertex with"),
        (GOOD.replace("element face", "element vertex"), "two elements called vertex"),
        (GOOD.replace("list uchar", "list float"), "not a type and a name"),
        (GOOD.replace("0.0 1.0 9", "0.0 one 9"), "only numbers"),
        (GOOD.replace("0.0 1.0 9", "0.0 1_0 9"), "only numbers"),
        (GOOD.replace("0.0 1.0 9", "0.0 nan 9"), "vertex 1 is at"),
        (GOOD.replace("3 0 1 2", "3 0 1 7"), "face 0 names vertex 7"),
        (GOOD.replace("3 0 1 2", "3 0 1 1"), "occurs twice"),
        (GOOD.replace("3 0 1 2", "-3 0 1 2"), "list of -3 items"),
        (GOOD.replace("3 0 1 2", "3 0 1 0.5"), "not lists of whole numbers"),
        (GOOD.replace("3 0 1 2", "9999999 0 1 2"), "the file ends in row 0 of 1 of face"),
        (GOOD + "1 2 3\n", "3 numbers follow the last element"),
        (GOOD[:-6], "file ends in row|announces"),
    ],
)
def test_damaged_text_is_refused_with_its_place(text, message, tmp_path):
    path = tmp_path / "damaged.ply"
    path.write_bytes(text.encode())
    with pytest.raises(PlyFormatError, match=message) as raised:
        read_ply(path)
    assert str(raised.value).startswith("damaged.ply: ")


@pytest.mark.parametrize("encoding", ["binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("faces", [[[0, 1, 2]], [[0, 1, 2], [0, 1, 2, 3]]])
def test_a_binary_file_that_is_cut_off_anywhere_is_refused(encoding, faces):
    whole = file_of(encoding, np.eye(4)[:, :3], faces)
    read_ply_elements(whole)
    for length in range(len(whole)):
        with pytest.raises(PlyFormatError):
            read_ply_elements(whole[:length])
    with pytest.raises(PlyFormatError, match="2 bytes follow"):
        read_ply_elements(whole + b"xx")


@settings(max_examples=300, deadline=None)
@given(
    encoding=st.sampled_from(sorted(ENCODINGS)),
    place=st.integers(0, 600),
    cut=st.integers(0, 40),
    junk=st.binary(max_size=12),
)
def test_whatever_is_damaged_only_the_error_of_the_format_is_raised(
    encoding, place, cut, junk, tmp_path_factory
):
    whole = file_of(encoding, np.eye(3), [[0, 1, 2]])
    path = tmp_path_factory.mktemp("ply") / "damaged.ply"
    path.write_bytes(whole[:place] + junk + whole[place + cut :])
    try:
        points, _ = read_ply(path)
    except PlyFormatError:
        return
    assert points.shape[1] == 3
    assert np.isfinite(points).all()


def test_the_real_files_are_read(real):
    points, faces = read_ply(real / "bunny" / "bun_zipper_res2.ply")
    assert (points.shape, faces.shape) == ((8171, 3), (16301, 3))
    points, faces = read_ply(real / "bunny" / "bun090.ply")
    assert (points.shape, faces.shape) == ((30379, 3), (0, 3))
