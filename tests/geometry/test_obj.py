"""Reading OBJ files."""

import pytest

from gpcourse.errors import ObjFormatError
from gpcourse.geometry.obj import read_obj

SQUARE = "# a square\nv 0 0 0\nv 1 0 0 # right\nv 1 1 0\nv 0 1 0 1.0\nvn 0 0 1\nusemtl red\n"


@pytest.mark.parametrize("face", ["f 1 2 3 4", "f 1/7 2/7 3/8 4/9", "f 1//1 2//1 3//1 4//1", "f -4 -3 -2 -1"])
def test_polygons_are_cut_into_triangles_however_their_corners_are_written(face):
    vertices, faces = read_obj(SQUARE + face)
    assert vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert faces.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_an_empty_file_is_an_empty_mesh():
    vertices, faces = read_obj("")
    assert (vertices.shape, faces.shape) == ((0, 3), (0, 3))


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("v 1 2", "line 8: a vertex is `v x y z`"),
        ("v 1 2 x", "line 8: a vertex"),
        ("v 1 2 nan", "line 8: a vertex"),
        ("f 1 2", "line 8: a face is `f` and three"),
        ("f 1 2 c", "line 8: a face is"),
        ("f 1 2 5", "line 8: a face names vertex 5; 4 vertices come before"),
        ("f 1 2 0", "vertex 0"),
        ("f 1 2 -5", "vertex -5"),
        ("f 1 2 1", "a vertex occurs twice"),
    ],
)
def test_what_cannot_be_read_is_named_with_its_line(lines, words):
    with pytest.raises(ObjFormatError, match=words):
        read_obj(SQUARE + lines)


def test_the_meshes_of_the_coursework(real):
    for name, counts in {"lilium_s": (786, 1500), "plane": (100, 162), "fandisk_ns": (7229, 14454)}.items():
        vertices, faces = read_obj((real / "meshes" / f"{name}.obj").read_text())
        assert (len(vertices), len(faces)) == counts
