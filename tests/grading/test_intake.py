"""Work as it comes: from Moodle, Canvas, nbgrader and students, in folders and in zip files of any kind."""

import io
import json
import os
import random
import stat
import struct
import sys
import tracemalloc
import zipfile
from pathlib import Path

import pytest

from gpcourse.errors import UsageError
from gpcourse.grading import archives, submission
from gpcourse.grading.submission import read_class


def nb(source="def genus(mesh):\n    return 0\n"):
    return json.dumps({"cells": [{"cell_type": "code", "source": source}], "nbformat": 4})


def zipped(files, compression=zipfile.ZIP_DEFLATED):
    """A zip file in memory; a name may come twice, a content may be a zip file again."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as archive:
        for name, content in files:
            archive.writestr(name, content)
    return buffer.getvalue()


def class_of(tmp_path, files, how):
    """A class as the platform gives it out: the zip file itself, or unpacked."""
    if how == "zip":
        path = tmp_path / "CS1-homework-77.zip"
        path.write_bytes(zipped(files))
        return read_class(path)
    for name, content in files:
        path = tmp_path / "class" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_class(tmp_path / "class")


def uploads(tmp_path, **contents):
    """A folder with one file a student."""
    for name, content in contents.items():
        (tmp_path / f"{name}.zip").write_bytes(content)
    return {s.student: s for s in read_class(tmp_path)}


MOODLE = [
    ("Lovelace Ada_1815_assignsubmission_file_/1_halfedge.ipynb", nb("a = 1")),
    ("Lovelace Ada_1815_assignsubmission_file_/more/0_welcome.ipynb", nb("b = 1")),
    ("Lovelace Ada_1815_assignsubmission_onlinetext/onlinetext.html", "<p>thanks</p>"),
    ("李 明_1816_assignsubmission_file_/work.zip", zipped([("x/1_halfedge.ipynb", nb("c = 1"))])),
    ("Group 3_12_assignsubmission_file/1_halfedge.ipynb", nb("d = 1")),
    ("Boole George_1817_assignsubmission_file_/essay.pdf", b"%PDF"),
    ("Default group_assignsubmission_file_/1.ipynb", nb("e = 1")),
]
MOODLE_FLAT = [
    ("Lovelace Ada_1815_assignsubmission_file_1_halfedge.ipynb", nb("a = 1")),
    ("Lovelace Ada_1815_assignsubmission_file_0_welcome.ipynb", nb("b = 1")),
    ("李 明_1816_assignsubmission_file_work.zip", zipped([("1_halfedge.ipynb", nb("c = 1"))])),
    ("Group 3_12_assignsubmission_file_1_halfedge.ipynb", nb("d = 1")),
    ("Boole George_1817_assignsubmission_file_essay.pdf", b"%PDF"),
    ("Default group_assignsubmission_file_1.ipynb", nb("e = 1")),
]


@pytest.mark.parametrize("files", [MOODLE, MOODLE_FLAT], ids=["folders", "flat"])
@pytest.mark.parametrize("how", ["zip", "folder"])
def test_what_moodle_gives_out(tmp_path, files, how):
    seen = {s.student: s for s in class_of(tmp_path, files, how)}
    ids = {name: s.owner.id for name, s in seen.items()}
    assert ids == {
        "Lovelace Ada": "1815", "李 明": "1816", "Group 3": "12", "Boole George": "1817", "Default group": "",
    }  # fmt: skip
    assert {s.owner.platform for s in seen.values()} == {"moodle"}
    assert {n.cells[0][1] for n in seen["Lovelace Ada"].notebooks} == {"a = 1", "b = 1"}
    assert seen["李 明"].notebooks[0].cells == ((1, "c = 1"),)
    assert not seen["Boole George"].readable
    assert seen["Boole George"].notes == ("there is no notebook, but essay.pdf",)
    assert seen["Lovelace Ada"].notes == ()


CANVAS = [
    ("lovelaceada_101_9001_1_halfedge.ipynb", nb("old = 1")),
    ("lovelaceada_101_9007_1_halfedge-2.ipynb", nb("newest = 1")),
    ("lovelaceada_101_9005_1_halfedge-1.ipynb", nb("newer = 1")),
    ("boolegeorge_LATE_102_9002_0_welcome.ipynb", nb("late = 1")),
    ("李明_103_9003_work.zip", zipped([("hw/1_halfedge.ipynb", nb("c = 1"))])),
    ("gausscarl_104_9004_essay.pdf", b"%PDF"),
    ("gausscarl_105_9006_1.ipynb", nb("namesake = 1")),
    ("LATE_anon_x1Y2z_9008_1.ipynb", nb("anonymous = 1")),
    ("noethemmy_106_text.html", "<p>I wrote here</p>"),
]


@pytest.mark.parametrize("how", ["zip", "folder"])
def test_what_canvas_gives_out(tmp_path, how):
    seen = {s.student: s for s in class_of(tmp_path, CANVAS, how)}
    assert {name: s.owner.id for name, s in seen.items()} == {
        "lovelaceada": "101", "boolegeorge": "102", "李明": "103", "gausscarl (104)": "104",
        "gausscarl (105)": "105", "anon_x1Y2z": "anon_x1Y2z", "noethemmy": "106",
    }  # fmt: skip
    ada = seen["lovelaceada"]
    assert [n.cells[0][1] for n in ada.notebooks] == ["old = 1", "newer = 1", "newest = 1"]
    assert [n.name for n in ada.notebooks][-1] == "1_halfedge-2.ipynb"
    assert seen["boolegeorge"].notes == ("handed in late, says the platform",)
    assert seen["anon_x1Y2z"].notes == ("handed in late, says the platform",)
    assert seen["李明"].notebooks[0].cells == ((1, "c = 1"),)
    assert seen["gausscarl (104)"].notes == ("there is no notebook, but essay.pdf",)
    assert not seen["noethemmy"].readable


def test_numbers_in_names_alone_make_no_one_a_student_of_canvas(tmp_path):
    for name in ("hw_1_2_ada", "hw_1_2_bo", "cy"):
        (tmp_path / f"{name}.ipynb").write_text(nb())
    assert [s.student for s in read_class(tmp_path)] == ["cy", "hw_1_2_ada", "hw_1_2_bo"]


@pytest.mark.parametrize("given", ["", "submitted"])
def test_the_folder_of_nbgrader(tmp_path, given):
    stamp = "2026-02-02 15:58:23.948203 America/Los_Angeles"
    for student, name in (("ada", "ps1"), ("ada", "ps2"), ("bo", "ps1")):
        folder = tmp_path / "submitted" / student / name
        folder.mkdir(parents=True)
        (folder / "1_halfedge.ipynb").write_text(nb(f"{name} = 1"))
        (folder / "timestamp.txt").write_text(stamp)
    (tmp_path / "source" / "ps1").mkdir(parents=True)
    (tmp_path / "source" / "ps1" / "1_halfedge.ipynb").write_text(nb())
    ada, bo = read_class(tmp_path / given)
    assert (ada.student, bo.student) == ("ada", "bo")
    assert [n.name for n in ada.notebooks] == ["ps1/1_halfedge.ipynb", "ps2/1_halfedge.ipynb"]
    assert [n.name for n in bo.notebooks] == ["1_halfedge.ipynb"]
    assert bo.timestamp == stamp


def test_zip_files_of_students_and_a_class_packed_with_its_folder(tmp_path):
    seen = uploads(tmp_path, ada=zipped([("my work/1.ipynb", nb("a = 1")), ("my work/data.bin", b"x")]))
    assert seen["ada"].notebooks[0].cells == ((1, "a = 1"),)
    packed = tmp_path / "handed in.zip"
    packed.write_bytes(zipped([("handed in/ada.ipynb", nb()), ("handed in/bo/1.ipynb", nb())]))
    assert [s.student for s in read_class(packed)] == ["ada", "bo"]
    packed.write_bytes(zipped([("ada/1.ipynb", nb())]))
    assert [s.student for s in read_class(packed)] == ["ada"]


def test_a_class_packed_into_a_students_place_is_pointed_out(tmp_path):
    (note, *_) = uploads(tmp_path, CS1=zipped(MOODLE))["CS1"].notes
    assert "zip file of a whole class" in note


def test_two_that_may_be_one_are_said(tmp_path):
    (tmp_path / "ada").mkdir()
    (tmp_path / "ada" / "1.ipynb").write_text(nb("a = 1"))
    (tmp_path / "ada.ipynb").write_text(nb("b = 1"))
    (tmp_path / "ada.zip").write_bytes(zipped([("2.ipynb", nb("c = 1"))]))
    (ada,) = read_class(tmp_path)
    assert ada.notes == ("taken for one student's, and graded together: ada.ipynb, ada.zip, the folder ada",)
    assert len(ada.notebooks) == 3


def test_of_files_that_differ_in_a_number_the_highest_comes_last(tmp_path):
    for name in ("hw.ipynb", "hw-2.ipynb", "hw-10.ipynb", "hw (11).ipynb"):
        (tmp_path / "ada").mkdir(exist_ok=True)
        (tmp_path / "ada" / name).write_text(nb())
    names = [n.name for n in read_class(tmp_path)[0].notebooks]
    assert names == ["hw.ipynb", "hw-2.ipynb", "hw-10.ipynb", "hw (11).ipynb"]


def flagged(raw, *, flag=0, method=None):
    """Set a flag, or another kind of compression, in every header of a zip file."""
    out = bytearray(raw)
    for signature, at in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        start = out.find(signature)
        while start >= 0:
            (old,) = struct.unpack_from("<H", out, start + at)
            struct.pack_into("<H", out, start + at, old | flag)
            if method is not None:
                struct.pack_into("<H", out, start + at + 2, method)
            start = out.find(signature, start + 4)
    return bytes(out)


def linked(name, target):
    info = zipfile.ZipInfo(name)
    info.create_system = 3
    info.external_attr = (stat.S_IFLNK | 0o777) << 16
    return info, target


def nested(depth):
    raw = zipped([("1.ipynb", nb())])
    for _ in range(depth):
        raw = zipped([("inner.zip", raw)])
    return raw


ZEROS = bytes(50 * 2**20)


@pytest.mark.parametrize(
    ("raw", "why"),
    [
        (lambda: b"", "not a zip file"),
        (lambda: b"PK\x03\x04" + bytes(100), "not a zip file"),
        (lambda: zipped([("1.ipynb", nb())])[:-30], "not a zip file"),
        (lambda: zipped([]), "holds no notebook"),
        (lambda: zipped([("essay.pdf", "x")]), "holds no notebook"),
        (lambda: zipped([("1.ipynb", ZEROS)]), "unpacks to more than 10 MB"),
        (lambda: zipped([("a.zip", zipped([("1.ipynb", ZEROS)]))]), "unpacks to more than 10 MB"),
        (lambda: nested(4), "too many other zip files"),
        (lambda: zipped([(f"{i}.txt", "") for i in range(archives.MAX_FILES + 1)]), "more than 2000 files"),
        (lambda: flagged(zipped([("1.ipynb", nb())]), flag=1), "encrypted"),
        (lambda: zipped([("1.ipynb", nb())], zipfile.ZIP_BZIP2), "unusual way"),
        (lambda: flagged(zipped([("1.ipynb", nb())]), method=9), "unusual way"),
        (lambda: zipped([linked("1.ipynb", "/etc/passwd")]), "a link"),
        (lambda: zipped([("1.ipynb", nb())], zipfile.ZIP_STORED).replace(b"genus", b"gonus"), "damaged in"),
    ],
    ids=["empty", "header only", "cut off", "nothing in it", "a PDF", "a bomb", "a bomb in a zip", "deep",
         "many", "encrypted", "bzip2", "deflate64", "link", "wrong checksum"],
)  # fmt: skip
def test_what_cannot_be_unpacked_has_a_row_and_its_reason(tmp_path, raw, why):
    seen = uploads(tmp_path, eve=raw(), ada=zipped([("1.ipynb", nb())]))
    assert not seen["eve"].readable
    assert any(why in note for note in seen["eve"].notes)
    assert seen["ada"].readable


@pytest.mark.parametrize("said", [10, 200 * 2**20, 2**32 - 2])
def test_a_bomb_takes_no_more_memory_than_its_bound(tmp_path, said):
    """The headers may lie about the size."""
    raw = bytearray(zipped([("1.ipynb", bytes(200 * 2**20))]))
    for signature, at in ((b"PK\x03\x04", 22), (b"PK\x01\x02", 24)):
        struct.pack_into("<I", raw, raw.find(signature) + at, said)
    (tmp_path / "eve.zip").write_bytes(bytes(raw))
    tracemalloc.start()
    (eve,) = read_class(tmp_path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert not eve.readable
    assert peak < 2 * archives.MAX_RATIO * len(raw) < archives.MAX_BYTES


def test_many_files_of_a_fair_ratio_stop_at_the_sum(tmp_path, monkeypatch):
    monkeypatch.setattr(submission, "Budget", lambda: archives.Budget(40_000))
    noise = random.Random(0)
    content = [(f"{i}.ipynb", nb("x = '" + noise.randbytes(4_000).hex() + "'")) for i in range(9)]
    read = uploads(tmp_path, eve=zipped(content))["eve"].notebooks
    assert sum(n.readable for n in read) == 4
    assert "unpacks to more than" in read[-1].notes[0]


@pytest.mark.parametrize(
    "name", ["../../eve.ipynb", "/etc/eve.ipynb", "..\\..\\eve.ipynb", "C:\\eve.ipynb", "a/../../eve.ipynb"]
)
def test_a_path_out_of_the_folder_leads_nowhere(tmp_path, name):
    inside = tmp_path / "a" / "b"
    inside.mkdir(parents=True)
    before = sorted(tmp_path.rglob("*"))
    (inside / "eve.zip").write_bytes(zipped([(name, nb("a = 1"))]))
    (eve,) = read_class(inside)
    assert eve.notebooks[0].cells == ((1, "a = 1"),)
    assert [n.name for n in eve.notebooks] == ["eve.ipynb"]
    assert sorted(tmp_path.rglob("*")) == sorted([*before, inside / "eve.zip"])


def test_a_name_that_comes_twice(tmp_path):
    with pytest.warns(UserWarning, match="Duplicate"):
        raw = zipped([("1.ipynb", nb("first = 1")), ("1.ipynb", nb("second = 1"))])
    (one,) = uploads(tmp_path, ada=raw)["ada"].notebooks
    assert one.cells == ((1, "second = 1"),)
    assert one.notes == ("there are 2 files of this name; the last one counts",)


def test_names_that_are_not_marked_as_utf_8(tmp_path):
    raw = zipped([("Übung.ipynb", nb())])
    unmarked = bytearray(raw)
    for signature, at in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        struct.pack_into("<H", unmarked, raw.find(signature) + at, 0)
    names = [n.name for n in uploads(tmp_path, ada=bytes(unmarked))["ada"].notebooks]
    assert names == ["Übung.ipynb"]


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
def test_a_name_that_is_not_text(tmp_path):
    Path(os.fsdecode(bytes(tmp_path) + b"/\xff\xfe.ipynb")).write_text(nb())
    assert [s.student for s in read_class(tmp_path)] == ["��"]


def test_names_that_look_the_same_are_one_name(tmp_path):
    (tmp_path / "zoe\u0308.ipynb").write_text(nb())
    assert [s.student for s in read_class(tmp_path)] == ["zo\u00eb"]


def test_no_damage_raises_and_no_other_student_loses_by_it(tmp_path):
    """Bytes are changed, cut out and put in at random, in a zip file of a student and in that of a class."""
    noise = random.Random(7)
    inner = zipped([("a/1.ipynb", nb()), ("2.ipynb", nb()), ("deep.zip", zipped([("3.ipynb", nb())]))])
    whole = zipped([*MOODLE, ("Eve_5_assignsubmission_file_/work.zip", inner)])
    (tmp_path / "class").mkdir()
    (tmp_path / "class" / "ada.ipynb").write_text(nb())
    readable = 0
    for i in range(300):
        raw = bytearray((inner, whole)[i % 2])
        for _ in range(noise.choice([1, 3, 20])):
            at = noise.randrange(len(raw))
            raw[at : at + noise.choice([0, 1, 1, 4])] = noise.randbytes(noise.choice([1, 1, 2]))
        if i % 2:
            (tmp_path / "class.zip").write_bytes(raw)
            try:
                readable += sum(s.readable for s in read_class(tmp_path / "class.zip"))
            except UsageError as error:
                assert "submissions" in str(error)  # noqa: PT017
        else:
            (tmp_path / "class" / "eve.zip").write_bytes(raw)
            ada, eve = read_class(tmp_path / "class")
            assert ada.readable
            assert eve.readable or eve.notes
    assert readable > 100


def test_what_is_no_class_is_refused(tmp_path):
    (tmp_path / "notes.txt").write_text("x")
    with pytest.raises(UsageError, match=r"no zip file.*give the folder or the zip file"):
        read_class(tmp_path / "notes.txt")
    (tmp_path / "empty.zip").write_bytes(zipped([]))
    with pytest.raises(UsageError, match="holds no submissions"):
        read_class(tmp_path / "empty.zip")
    with pytest.raises(UsageError, match="does not exist"):
        read_class(tmp_path / "nowhere")
