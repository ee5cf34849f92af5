"""Chapter 1's exercises ask for what the course map asks."""

from gpcourse.exercises.course import CHAPTERS


def test_the_exercises_of_the_chapter_in_the_order_of_the_notebook():
    (chapter,) = [c for c in CHAPTERS if c.stem == "halfedge"]
    assert [exercise.name for exercise in chapter.exercises] == [
        "read_off",
        "write_off",
        "build_halfedges",
        "cube",
        "face_vertices",
        "vertex_neighbours_ccw",
        "vertex_neighbours_cw",
        "boundary_loops",
        "face_centroid",
        "is_flippable",
        "flip_edge",
        "dual_mesh",
        "euler_characteristic",
        "genus",
        "element_statistics",
    ]
