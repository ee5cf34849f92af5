"""Fetching data from a server of our own, and reading the real scans where they are."""

import hashlib
import http.server
import io
import re
import tarfile
import threading

import numpy as np
import pytest
from click.testing import CliRunner

from gpcourse import data_sets
from gpcourse.cli import main
from gpcourse.errors import DataError
from gpcourse.geometry.scans import pebble, turntable

POSES = b"camera 0 0 0\nbmesh bun000.ply 0 0 0 0 0 0 1\nbmesh bun045.ply 1 2 3 0 0 1 1\n"
# Random bytes, so that the archive is long enough to break off in the middle.
FILES = {name: np.random.default_rng(i).bytes(50000) for i, name in enumerate(data_sets.BUNNY_SHA256)}


def archive_of(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w:gz") as tar:
        for name, content in files.items():
            member = tarfile.TarInfo(name)
            member.size = len(content)
            tar.addfile(member, io.BytesIO(content))
    return stream.getvalue()


WHOLE = archive_of(
    {f"bunny/data/{name}": content for name, content in FILES.items()}
    | {"bunny/data/bun.conf": POSES, "../../evil.ply": b"x", "bunny/README": b"read me"}
)


class Server(http.server.ThreadingHTTPServer):
    content = WHOLE
    break_after = None  # bytes of one answer, after which the connection is lost
    knows_ranges = True
    requests: list[str]


class Handler(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        asked = self.headers.get("Range")
        self.server.requests.append(asked or "all")
        content, start = self.server.content, 0
        if asked and self.server.knows_ranges:
            start = int(re.fullmatch(r"bytes=(\d+)-", asked)[1])
            if start >= len(content):
                self.send_error(416)
                return
        self.send_response(206 if start else 200)
        self.send_header("Content-Length", str(len(content) - start))
        self.end_headers()
        end = None if self.server.break_after is None else start + self.server.break_after
        self.wfile.write(content[start:end])

    def log_message(self, *_):
        pass


@pytest.fixture
def server(monkeypatch, tmp_path):
    monkeypatch.setenv(data_sets.FOLDER_VARIABLE, str(tmp_path / "data"))
    for variable in ("http_proxy", "HTTP_PROXY", "all_proxy", "ALL_PROXY"):
        monkeypatch.delenv(variable, raising=False)
    sums = {name: hashlib.sha256(content).hexdigest() for name, content in FILES.items()}
    monkeypatch.setattr(data_sets, "BUNNY_SHA256", sums)
    with Server(("127.0.0.1", 0), Handler) as running:
        running.requests = []
        running.url = f"http://127.0.0.1:{running.server_address[1]}/bunny.tar.gz"
        thread = threading.Thread(target=running.serve_forever, args=(0.02,), daemon=True)
        thread.start()
        yield running
        running.shutdown()
        thread.join()


def test_every_file_arrives_and_nothing_else(server, tmp_path):
    folder = data_sets.fetch_bunny(server.url)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == {**FILES, "bun.conf": POSES}
    assert [path.name for path in (tmp_path / "data").iterdir()] == ["bunny"]
    assert not list(tmp_path.rglob("evil.ply"))
    assert data_sets.bunny_folder() == folder


def test_what_is_here_is_not_fetched_again(server):
    data_sets.fetch_bunny(server.url)
    data_sets.fetch_bunny(server.url)
    assert server.requests == ["all"]


def test_a_file_that_was_changed_is_fetched_again(server):
    folder = data_sets.fetch_bunny(server.url)
    (folder / "bun045.ply").write_bytes(b"changed")
    data_sets.fetch_bunny(server.url)
    assert (folder / "bun045.ply").read_bytes() == FILES["bun045.ply"]


def test_a_download_that_breaks_off_goes_on_from_there(server):
    server.break_after = 100_000
    with pytest.raises(DataError, match="run this again"):
        data_sets.fetch_bunny(server.url)
    server.break_after = None
    assert data_sets.fetch_bunny(server.url).is_dir()
    first, second = server.requests
    assert first == "all"
    assert 0 < int(second.removeprefix("bytes=").removesuffix("-")) <= 100_000


def test_a_server_without_ranges_sends_all_again(server):
    server.break_after, server.knows_ranges = 100_000, False
    with pytest.raises(DataError):
        data_sets.fetch_bunny(server.url)
    server.break_after = None
    assert data_sets.fetch_bunny(server.url).is_dir()


def test_a_part_that_is_whole_already_is_used(server, tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "bunny.tar.gz.part").write_bytes(WHOLE)
    assert data_sets.fetch_bunny(server.url).is_dir()


def test_an_archive_that_was_brought_by_hand_is_used(server, tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "bunny.tar.gz").write_bytes(WHOLE)
    assert data_sets.fetch_bunny("http://127.0.0.1:9/none").is_dir()
    assert server.requests == []


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"<html>not found</html>", "is not the bunny"),
        (WHOLE[: len(WHOLE) // 2], "is not the bunny"),
        (archive_of({**FILES, "bun000.ply": b"other", "bun.conf": POSES}), "SHA-256 of bun000.ply"),
        (archive_of({"bun.conf": POSES}), "is missing"),
        (archive_of({**FILES, "bun.conf": b"bmesh bun000.ply 1 2 three"}), "line 1 of bun.conf"),
        (archive_of(FILES), "bun.conf"),
    ],
)
def test_what_is_not_the_bunny_is_refused_and_not_kept(server, tmp_path, content, message):
    server.content = content
    with pytest.raises(DataError, match=message):
        data_sets.fetch_bunny(server.url)
    assert list((tmp_path / "data").iterdir()) == []
    assert data_sets.bunny_folder() is None


def test_offline_the_command_says_what_to_do(server):
    seen = CliRunner().invoke(main, ["data", "fetch", "bunny", "--url", "http://127.0.0.1:9/bunny.tar.gz"])
    assert seen.exit_code == 2
    assert "cannot be downloaded" in seen.output
    assert "save it as" in seen.output
    assert "scans that come with the course" in seen.output
    assert "Traceback" not in seen.output


def test_the_command_states_credit_and_licence(server):
    seen = CliRunner().invoke(main, ["data", "fetch", "bunny", "--url", server.url])
    assert seen.exit_code == 0, seen.output
    assert "Stanford Computer Graphics Laboratory" in seen.output
    assert "Licence" in seen.output
    assert "6 files, all with the right SHA-256" in seen.output


def test_a_pose_is_the_inverse_of_its_quaternion():
    R, t = data_sets._read_poses(POSES.decode(), "bun.conf")["bun045"]
    # 0 0 1 1 is a turn by 90° about z, and is normalised first.
    assert np.allclose(R @ [0, 1, 0], [1, 0, 0], atol=1e-15)
    assert t.tolist() == [1, 2, 3]


@pytest.fixture
def without_bunny(monkeypatch, tmp_path):
    monkeypatch.setenv(data_sets.FOLDER_VARIABLE, str(tmp_path))
    return tmp_path


def test_without_the_bunny_there_are_the_five_scans_of_the_course(without_bunny):
    found = data_sets.range_scans()
    assert [scan.name for scan in found] == ["pebble000", "pebble045", "pebble090", "pebble180", "pebble270"]


def test_the_scans_of_the_course_are_those_that_the_virtual_scanner_makes(without_bunny):
    made = turntable(pebble(6), pixels=90, noise=0.0005, rng=1)
    for read, scan in zip(data_sets.range_scans(), made, strict=True):
        assert np.abs(read.points - scan.points).max() < 0.6e-4  # four decimals
        assert np.abs(read.R - scan.R).max() < 1e-8
        assert np.abs(read.t - scan.t).max() < 1e-8
        # The faces of the file may differ at a jump: its depths are rounded, and have noise.
        assert len(read.faces) == pytest.approx(len(scan.faces), rel=0.01)
        corners = read.points[read.faces]
        facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
        assert (facing > 0).all()


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        ("pebble.conf", "bmesh pebble090", "bmesh other", "no pose of pebble090.ply"),
        ("pebble.conf", "bmesh pebble045.ply ", "bmesh pebble045.ply x", "line 2 of pebble.conf"),
        ("pebble180.ply", "\n1 7\n", "\n1 70000\n", "a pixel of pebble180.ply shows a"),
        ("pebble180.ply", "\n1 7\n", "\n1 7.5\n", "a pixel of pebble180.ply shows a"),
        ("pebble180.ply", "\n1 7\n", "\n2 7 8\n", "pebble180.ply has no grid of 90 × 90 pixels"),
    ],
)
def test_damaged_scans_are_refused_by_the_name_of_the_file(tmp_path, name, old, new, message):
    for file in data_sets.pebble_folder().iterdir():
        text = file.read_text()
        assert file.name != name or old in text
        (tmp_path / file.name).write_text(text.replace(old, new) if file.name == name else text)
    with pytest.raises(DataError, match=message):
        data_sets.load_scans(tmp_path, data_sets.PEBBLE)


def test_the_list_says_which_scans_the_notebook_opens(server):
    seen = CliRunner().invoke(main, ["data", "list"]).output
    assert str(data_sets.pebble_folder()) in seen
    assert "opens the pebble" in seen
    assert "gpcourse data fetch bunny" in seen
    folder = data_sets.fetch_bunny(server.url)
    seen = CliRunner().invoke(main, ["data", "list"]).output
    assert str(folder) in seen
    assert "opens the bunny" in seen
    assert "Licence" in seen


def test_the_real_scans_lie_on_one_another_at_their_poses(real):
    made = data_sets.load_scans(real / "bunny", data_sets.BUNNY)
    assert [scan.name for scan in made] == ["bun000", "bun045", "bun090", "bun180", "bun270"]
    assert [len(scan.points) for scan in made] == [40256, 40097, 30379, 40251, 31701]
    for scan in made:
        sides = scan.points[scan.faces]
        assert (np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])[:, 2] > 0).all()
    from scipy.spatial import cKDTree

    distances, _ = cKDTree(made[0].placed).query(made[1].placed[::10])
    assert np.median(distances) < 0.0004  # metres; 29 mm with the inverse rotations


def test_the_sums_are_those_of_the_published_files(real):
    for name, expected in data_sets.BUNNY_SHA256.items():
        assert hashlib.sha256((real / "bunny" / name).read_bytes()).hexdigest() == expected


def test_a_mesh_of_the_coursework_is_read_where_it_is_and_none_where_it_is_not(tmp_path, monkeypatch):
    monkeypatch.setenv(data_sets.FOLDER_VARIABLE, str(tmp_path))
    assert data_sets.coursework_mesh("lilium_s.obj") is None
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "lilium_s.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    vertices, faces = data_sets.coursework_mesh("lilium_s.obj")
    assert (vertices.shape, faces.tolist()) == ((3, 3), [[0, 1, 2]])
