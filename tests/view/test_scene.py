"""A scene is plain data: it survives JSON, and refuses what cannot be drawn."""

import json
import subprocess
import sys
from inspect import signature

import numpy as np
import pytest
from scipy import sparse

from gpcourse import view
from gpcourse.errors import ArrayError, GeometryError, PictureError
from gpcourse.reference.halfedge import halfedge_mesh
from gpcourse.view import checks, scene

TETRAHEDRON = (
    np.array([[1.0, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]]),
    [[0, 1, 3], [0, 2, 1], [0, 3, 2], [1, 2, 3]],
)

MAKERS = (
    view.mesh_scene, view.halfedge_scene, view.neighbours_scene, view.points_scene, view.curves_scene,
    view.vectors_scene, view.labels_scene,
)  # fmt: skip


def every_layer():
    vertices, faces = TETRAHEDRON
    panels = (
        scene.Panel(
            (
                scene.Mesh(vertices, faces, values=[0.5, np.nan, -1.0, np.inf], value_name="K"),
                scene.Mesh(vertices, faces, face_colours=("red",) * 4, limits=(0, 1)),
                scene.Arrows(vertices[:2], vertices[2:], ("blue", "#123456"), ("a", "b"), vertices[:2]),
                scene.Curves((vertices, vertices[:2]), closed=True),
                scene.Points(vertices, values=np.arange(4), colour_map="cividis"),
                scene.Labels(vertices, ("0", "1", "$", "½"), place="badge", size=7),
            ),
            "all kinds",
            scene.Camera((1, 2, 3), (0, 1, 0), (0, 0, 0), 2.5),
        ),
        scene.Panel((scene.Mesh(vertices, np.array(faces)),)),
    )
    return scene.Scene(panels, alt="everything", shared_scale=True)


def test_every_layer_survives_json():
    before = every_layer()
    text = json.dumps(before.to_json(), allow_nan=False)
    after = scene.Scene.from_json(json.loads(text))
    assert after.to_json() == before.to_json()
    assert view.Picture(after).png() == view.Picture(before).png()
    mesh = after.panels[0].layers[0]
    np.testing.assert_array_equal(mesh.vertices, TETRAHEDRON[0])
    assert not np.isfinite(mesh.values[[1, 3]]).any()


@pytest.mark.parametrize(
    "data",
    [
        None,
        [],
        {},
        {"kind": "cube"},
        {"kind": ["scene"]},
        {"kind": "scene", "panels": []},
        {"kind": "scene", "panels": 3},
        {"kind": "scene", "panels": [{"kind": "mesh"}]},
        {"kind": "scene", "panels": [{"kind": "panel", "layers": [], "camera": 3}]},
        {"kind": "panel", "layers": []},
        {"kind": "scene", "panels": [{"kind": "camera"}]},
        {"kind": "scene", "colour": "red", "panels": [{"kind": "panel", "layers": []}]},
    ],
)
def test_data_that_is_no_scene_is_refused(data):
    with pytest.raises(ArrayError):
        scene.Scene.from_json(data)


def test_values_of_both_signs_get_a_scale_centred_on_zero():
    (scale,) = view.mesh(TETRAHEDRON, [-1.0, 0.5, 0.2, 3.0]).scene.scales()
    assert (scale.colour_map, scale.low, scale.high) == ("RdBu_r", -3.0, 3.0)


def test_values_of_one_sign_fill_a_sequential_scale():
    (scale,) = view.mesh(TETRAHEDRON, [1.0, 0.5, 0.2, 3.0]).scene.scales()
    assert (scale.colour_map, scale.low, scale.high) == ("viridis", 0.2, 3.0)


def test_rounding_is_not_stretched_over_the_whole_scale():
    (scale,) = view.mesh(TETRAHEDRON, 1 + 1e-15 * np.arange(4)).scene.scales()
    assert scale.high - scale.low > 0.5


def test_a_shared_scale_covers_the_values_of_all_panels():
    pictures = [
        view.mesh(TETRAHEDRON, [1.0, 2, 3, 4]),
        view.mesh(TETRAHEDRON),
        view.mesh(TETRAHEDRON, [-8.0, 0, 1, 2]),
    ]
    first, none, last = view.side_by_side(*pictures).scene.scales()
    assert first == last
    assert (first.low, first.high) == (-8.0, 8.0)
    assert none is None
    apart = view.side_by_side(*pictures, shared_scale=False).scene.scales()
    assert (apart[0].low, apart[0].high) == (1.0, 4.0)


def test_values_go_to_faces_when_there_is_one_for_each():
    pyramid = (
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]],
        [[3, 2, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4]],
    )
    assert view.mesh(pyramid, range(4)).scene.panels[0].layers[0].values_on == "faces"
    assert view.mesh(pyramid, range(5)).scene.panels[0].layers[0].values_on == "vertices"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: view.mesh(3), "a int cannot be drawn"),
        (lambda: view.mesh((TETRAHEDRON[0], [[0, 1, 9]])), "face 0 names vertex 9"),
        (lambda: view.mesh(([[0, 0, np.nan]], [])), r"vertices\[0\]"),
        (lambda: view.mesh(TETRAHEDRON, [1, 2, 3]), r"values has shape \(3,\)"),
        (lambda: view.mesh(TETRAHEDRON, ["a"] * 4), "values cannot be read"),
        (lambda: view.mesh(TETRAHEDRON, [[1], [2, 3]]), "values cannot be read"),
        (lambda: view.mesh(TETRAHEDRON, labels="edges"), "labels is 'edges'"),
        (lambda: view.mesh(TETRAHEDRON, labels="halfedges"), "labels is 'halfedges'"),
        (lambda: view.mesh(TETRAHEDRON, direction=(0, 0, 0)), "direction is zero"),
        (lambda: view.mesh(TETRAHEDRON, direction="up"), "direction is 'up'; give three finite numbers"),
        (lambda: view.mesh(TETRAHEDRON, colour="mauve"), "colour is 'mauve'"),
        (lambda: view.mesh(TETRAHEDRON, face_colours=["red"] * 3), "face_colours has 3 entries"),
        (lambda: view.mesh(TETRAHEDRON, range(4), colour_map="jet"), "colour_map is 'jet'"),
        (lambda: view.mesh(TETRAHEDRON, range(4), limits=(1, 1)), "limits is"),
        (lambda: view.halfedges(TETRAHEDRON), "a tuple has no half-edges"),
        (lambda: view.halfedges(tetrahedron(), highlight=[12]), "highlight is 12"),
        (lambda: view.halfedges(tetrahedron(), highlight=["a"]), "highlight is 'a'"),
        (lambda: view.halfedges(tetrahedron(), highlight=3), "highlight is 3"),
        (lambda: view.halfedges(tetrahedron(), highlight={0: "mauve"}), r"highlight\[0\] is 'mauve'"),
        (lambda: view.neighbours(TETRAHEDRON, 4, []), "vertex is 4"),
        (lambda: view.neighbours(TETRAHEDRON, 0, [1, -1]), r"order\[1\] is -1"),
        (lambda: view.points([[1, 2, 3, 4]]), "points has shape"),
        (lambda: view.points([[1, 2, 3]], size=0), "size is 0"),
        (lambda: view.curves([[[0, 0], [1, 1]], [[0, 0]]]), r"lines\[1\] has 1 points"),
        (view.side_by_side, "at least one panel"),
        (lambda: view.side_by_side(TETRAHEDRON), "picture 0 is a tuple; give the pictures one by one"),
        (lambda: view.side_by_side(view.mesh(TETRAHEDRON), 3), "picture 1 is a int; make one of it"),
        (lambda: view.animation(view.mesh(TETRAHEDRON)), "one picture is given where several"),
        (lambda: view.animation([3]), "picture 0 is a int"),
        (lambda: view.mesh(TETRAHEDRON, 1j * np.arange(4)), "values holds complex numbers"),
        (
            lambda: view.mesh(TETRAHEDRON, np.zeros((4, 1))),
            r"shape \(4, 1\); give 4 numbers, as values.ravel",
        ),
        (lambda: view.mesh(TETRAHEDRON, sparse.eye_array(4)), "values is a sparse matrix"),
        (lambda: view.mesh(TETRAHEDRON, {"H": range(4), "K": range(3)}), "field 'K': values has shape"),
        (lambda: view.Picture(TETRAHEDRON), "a tuple is not a scene"),
        (lambda: view.mesh((TETRAHEDRON[0], np.zeros((2, 2, 3), int))), "faces is nested 3 deep"),
        (lambda: view.mesh(([], TETRAHEDRON[1])), "vertices has shape"),
        (lambda: view.mesh((TETRAHEDRON[0][:0], TETRAHEDRON[1])), "with 0 vertices no index is valid"),
        (lambda: view.mesh(TETRAHEDRON, [10**400] * 4), "values cannot be read"),
        (lambda: view.mesh(TETRAHEDRON, range(4), limits=(-1e308, 1e308)), "limits is"),
        (lambda: view.mesh(TETRAHEDRON, direction=(1, 2)), r"direction is \(1, 2\); give three"),
        (
            lambda: view.mesh(TETRAHEDRON, face_colours=[["red"]]),
            r"face_colours is an array of shape \(1, 1\)",
        ),
        (lambda: view.mesh(TETRAHEDRON, vertex_colours=1j * TETRAHEDRON[0]), "type complex128; give names"),
        (lambda: view.mesh(TETRAHEDRON, vertex_colours=np.full((4, 3), 255)), r"vertex_colours\[0\] is"),
        (
            lambda: view.mesh(TETRAHEDRON, vertex_colours=np.full((3, 3), 0.5)),
            "has 3 entries; give one, or 4",
        ),
        (lambda: view.mesh(TETRAHEDRON, vertex_colours="red", face_colours="red"), "give one of them"),
        (lambda: view.points(np.array([["2026-01-01"] * 3], dtype="datetime64")), "points cannot be read"),
        (lambda: view.curves([[[0, 0], [1, 1, 1]]]), r"lines\[0\] cannot be read"),
        (lambda: view.curves([[0, 0], [1, 1]], colours=3), r"colours\[0\] is 3"),
        (lambda: view.neighbours(TETRAHEDRON, 0, None), "order is None"),
        (lambda: view.vectors(TETRAHEDRON[0], [[1, 0, 0]]), "there are 1 vectors for 4 points"),
        (lambda: view.vectors(TETRAHEDRON[0], [[np.inf] * 3] * 4), r"vectors\[0\] is"),
        (lambda: view.vectors(TETRAHEDRON[0], TETRAHEDRON[0], scale=-1), "scale is -1"),
        (lambda: view.vectors(TETRAHEDRON[0], TETRAHEDRON[0], scale=1e308), "give a smaller one"),
        (lambda: view.vectors(TETRAHEDRON[0], TETRAHEDRON[0], on=3), "a int cannot be drawn as a mesh"),
        (
            lambda: view.labels(TETRAHEDRON[0], ["a", "b"]),
            "there are 2 texts for 4 places; give one for each",
        ),
        (lambda: view.labels(TETRAHEDRON[0], []), "there are 0 texts for 4 places"),
        (lambda: view.labels(TETRAHEDRON[0], "abcd"), "there are 4 texts"),
        (view.together, "give at least one"),
        (lambda: view.together(view.side_by_side(*2 * [view.mesh(TETRAHEDRON)])), "picture 0 has 2 panels"),
        (lambda: view.animation(None), "pictures is a NoneType"),
        (lambda: view.animation([view.mesh(TETRAHEDRON)], names=3), "names is 3"),
        (lambda: view.mesh(TETRAHEDRON, smooth="no"), "smooth is 'no'; it must be True or False"),
        (lambda: view.mesh(TETRAHEDRON, edges="no"), "edges is 'no'; it must be"),
        (lambda: view.mesh(TETRAHEDRON, static="no"), "static is 'no'; it must be"),
        (lambda: view.curves(TETRAHEDRON[0], closed=1), "closed is 1; it must be"),
        (lambda: view.halfedges(tetrahedron(), labels="all"), "labels is 'all'; it must be"),
        (lambda: view.side_by_side(view.mesh(TETRAHEDRON), shared_scale=2), "shared_scale is 2; it must be"),
        (lambda: view.points(TETRAHEDRON[0], colour="mauve"), "colour is 'mauve'"),
        (lambda: view.vectors(TETRAHEDRON[0], TETRAHEDRON[0], colour=["red"]), r"colour is \['red'\]"),
    ],
)
def test_what_cannot_be_drawn_is_named(make, message):
    with pytest.raises(GeometryError, match=message):
        make()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: view.mesh(TETRAHEDRON, range(4), cmap="jet"),
            "view.mesh has no .*'cmap'; did you mean colour_map",
        ),
        (lambda: view.mesh(TETRAHEDRON, titel="a"), "did you mean title"),
        (lambda: view.mesh(TETRAHEDRON, cheese=1), "'cheese'; it has labels, title"),
        (
            lambda: view.mesh(tetrahedron(), labels="halfedges", smooth=True),
            "labels='halfedges' has no setting",
        ),
        (lambda: view.points(TETRAHEDRON[0], s=3), "view.points has no setting 's'; did you mean size"),
        (lambda: view.curves(TETRAHEDRON[0], color="red"), "view.curves has no .* did you mean colours"),
        (
            lambda: view.vectors(TETRAHEDRON[0], TETRAHEDRON[0], length=2),
            "view.vectors has no setting 'length'",
        ),
        (lambda: view.halfedges(tetrahedron(), vertex_number=True), "did you mean vertex_numbers"),
        (lambda: view.neighbours(TETRAHEDRON, 0, [], labels=True), "view.neighbours has no setting 'labels'"),
        (
            lambda: view.Picture(view.mesh(TETRAHEDRON).scene, dpi=0),
            "dpi is 0; give a number from 10 to 1200",
        ),
        (lambda: view.Picture(view.mesh(TETRAHEDRON).scene, dpi="high"), "dpi is 'high'"),
        (lambda: view.mesh(TETRAHEDRON).save(3), "path is 3; give a file name"),
        (lambda: view.mesh(TETRAHEDRON).save("no such/x.png"), "no folder no such; make it first"),
    ],
)
def test_a_setting_that_there_is_not_is_named_with_those_that_there_are(make, message):
    with pytest.raises(PictureError, match=message):
        make()


@pytest.mark.parametrize("end", ["png", "html", "pdf"])
def test_a_picture_that_cannot_be_written_says_why(tmp_path, end):
    folder = tmp_path / f"taken.{end}"
    folder.mkdir()
    with pytest.raises(PictureError, match=rf"taken\.{end} cannot be written: Is a directory"):
        view.mesh(TETRAHEDRON).save(folder)


def test_every_setting_that_another_library_calls_otherwise_is_one_of_ours():
    ours = {name for make in MAKERS for name in signature(make).parameters}
    assert set(checks._ELSEWHERE.values()) <= ours
    assert not ours & set(checks._ELSEWHERE)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: view.mesh((TETRAHEDRON[0], [])), "A mesh of 4 vertices and 0"),
        (lambda: view.points(np.zeros((0, 3))), "A cloud of 0 points"),
        (lambda: view.curves([]), "0 curves"),
    ],
)
def test_a_picture_of_nothing_says_so(make, words):
    picture = make()
    assert picture.scene.panels[0].title.startswith(f"nothing to see: {words}")
    assert "<iframe" in picture.html()


def test_masked_values_are_missing():
    picture = view.mesh(TETRAHEDRON, np.ma.masked_less([1.0, 2, 3, 4], 2.5))
    assert "from 3 to 4; 2 values are not finite" in repr(picture)


def test_values_that_have_blown_up_are_shown_in_grey():
    picture = view.mesh(TETRAHEDRON, [1e308, -1e308, 1.0, 2.0])
    assert "from 1 to 2; 2 values are not finite" in repr(picture)
    assert "<iframe" in picture.html()


def tetrahedron():
    return halfedge_mesh(TETRAHEDRON[0], TETRAHEDRON[1])


def test_arrows_get_a_length_that_suits_the_picture():
    vertices = TETRAHEDRON[0]
    for size in (1e-3, 1.0, 1e6):
        surface, arrows = view.vectors(vertices, size * vertices, on=TETRAHEDRON).scene.panels[0].layers
        np.testing.assert_array_equal(surface.vertices, vertices)
        lengths = np.linalg.norm(arrows.heads - arrows.tails, axis=1)
        np.testing.assert_allclose(lengths, 0.125 * np.ptp(vertices))
    given = view.vectors(vertices, vertices, scale=2).scene.panels[0].layers[0]
    np.testing.assert_allclose(given.heads, 3 * vertices)
    assert "4 arrows; the longest stands for 1.73." in repr(view.vectors(vertices, vertices))
    nothing = view.vectors(vertices, 0 * vertices, on=TETRAHEDRON).scene.panels[0].layers[1]
    assert len(nothing.heads) == 0


def test_pictures_are_laid_over_each_other_as_the_first_is_seen():
    first, second = view.mesh(TETRAHEDRON, direction=(1, 2, 3)), view.points(TETRAHEDRON[0])
    both = view.together(first, second)
    panel = both.scene.panels[0]
    assert [layer.kind for layer in panel.layers] == ["mesh", "points"]
    assert panel.camera == first.scene.panels[0].camera
    assert repr(both) == f"{first!r} {second!r}"
    assert "<iframe" in both.html()


def test_texts_stand_beside_their_points():
    picture = view.labels(TETRAHEDRON[0], ["a", "b", 3, "½"], on=TETRAHEDRON, colour="red")
    _, dots, words = picture.scene.panels[0].layers
    np.testing.assert_array_equal(dots.positions, words.positions)
    assert words.texts == ("a", "b", "3", "½")
    assert set(words.colours) == {"#c8450c"}
    assert repr(picture) == "4 labels on a mesh of 4 vertices and 4 triangles: a, b, 3, ½."


def test_colours_are_names_or_numbers():
    named = view.mesh(TETRAHEDRON, vertex_colours=["red", "#00ff00", "blue", "white"])
    assert named.scene.panels[0].layers[0].vertex_colours == ("#c8450c", "#00ff00", "#0b5fa5", "#ffffff")
    rows = [[1, 0, 0], [0, 0.5, 0], [0, 0, 1], [1, 1, 1]]
    for given in (rows, np.array(rows), [tuple(row) for row in rows]):
        mesh = view.mesh(TETRAHEDRON, vertex_colours=given).scene.panels[0].layers[0]
        assert mesh.vertex_colours == ("#ff0000", "#008000", "#0000ff", "#ffffff")


def test_a_mesh_without_positions_is_refused_with_the_repair():
    bare = tetrahedron()
    object.__setattr__(bare, "vertices", None)
    with pytest.raises(ArrayError, match="with_vertices"):
        view.halfedges(bare)


def test_the_words_state_facts():
    assert repr(view.mesh(TETRAHEDRON)) == "A mesh of 4 vertices and 4 triangles."
    assert "colour shows K, from -2 to 1; 1 values are not finite" in repr(
        view.mesh(TETRAHEDRON, [-2, 0, 1, np.nan], value_name="K")
    )
    assert "left out: 3" in repr(view.neighbours(TETRAHEDRON, 0, [2, 1]))
    assert repr(view.mesh(TETRAHEDRON, title="Before", alt="mine")) == "mine"


def test_html_is_an_image_with_its_words_escaped_and_nothing_that_a_sanitizer_strips():
    html = view.mesh(TETRAHEDRON, alt='<b> & "quotes"', static=True)._repr_html_()
    assert html.startswith('<img alt="&lt;b&gt; &amp; &quot;quotes&quot;" src="data:image/png;base64,')
    assert "class=" not in html
    assert "<script" not in html
    assert not hasattr(view.Picture, "_repr_png_")


def test_making_a_scene_does_not_load_matplotlib():
    code = (
        "import sys; from gpcourse import view; view.mesh(([[0,0,0],[1,0,0],[0,1,0]], [[0,1,2]]), [1,2,3]);"
        "print([m for m in sys.modules if m.split('.')[0] in ('matplotlib', 'IPython', 'PIL')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
