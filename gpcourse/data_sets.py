"""Range scans: those that come with the course, and those of Stanford, fetched on demand and verified."""

from __future__ import annotations

import hashlib
import os
import tarfile
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from platformdirs import user_cache_dir

from gpcourse.errors import DataError
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.geometry.obj import read_obj
from gpcourse.geometry.ply import Lists, ply_vertices, read_ply_elements
from gpcourse.geometry.scans import Scan, grid_triangles

#: The variable of the environment that names another folder for the data.
FOLDER_VARIABLE = "GPCOURSE_DATA"

BUNNY_URL = "https://graphics.stanford.edu/pub/3Dscanrep/bunny.tar.gz"
BUNNY_CREDIT = (
    "The Stanford bunny: range scans of the Stanford Computer Graphics Laboratory (Cyberware 3030MS, 1996),\n"
    "from the Stanford 3D Scanning Repository, https://graphics.stanford.edu/data/3Dscanrep/.\n"
    "Licence: free for research, with acknowledgement of the source."
)
BUNNY_SHA256 = {
    "bun000.ply": "7d48f9fdf917311de680d074edce8aff25a4b9bfd87be9301822dace811209fb",
    "bun045.ply": "150f17a7c1043312a611bfff156c5933723bea903df4b4b3c2194854d1e9f155",
    "bun090.ply": "4f6dc1c1cab3dc67b99c9ab36d6413598ea5a9b3ac7355a00f87e8ccdc500757",
    "bun180.ply": "097d5fa16b9abf1c6c9bed7969d456e973d43adca428122e3aefb318d004fe4c",
    "bun270.ply": "51cec23127a26bce6e96ac4ca17b12c8e57e365d63d98e919501199f7d4d78c8",
    "bun_zipper_res2.ply": "8faa052bb08cf1625eec97b6508baceee11eec9cf28f83f6a9d4547ab15d7761",
}
_LARGEST = 64 * 2**20  # bytes; no file of the archive is near it


@dataclass(frozen=True)
class ScanSet:
    """Scans of one object in a folder.

    Attributes
    ----------
    scans : tuple of str
        The PLY files, in the order in which the object was turned.
    poses : str
        The file of the poses.
    grid : (int, int)
        Rows and columns of the scanner.
    longest : float
        No longer edge joins two points of a scan, in its unit of length.
    """

    scans: tuple[str, ...]
    poses: str
    grid: tuple[int, int]
    longest: float

    def is_in(self, folder: Path) -> bool:
        """Whether the folder holds all the files."""
        return all((folder / name).is_file() for name in (*self.scans, self.poses))


BUNNY = ScanSet(
    ("bun000.ply", "bun045.ply", "bun090.ply", "bun180.ply", "bun270.ply"),
    "bun.conf",
    (400, 512),
    0.004,  # metres, eight pixels
)
PEBBLE = ScanSet(
    ("pebble000.ply", "pebble045.ply", "pebble090.ply", "pebble180.ply", "pebble270.ply"),
    "pebble.conf",
    (90, 90),
    0.2,  # four pixels; the pebble is about 3 long
)

_PACKAGE = Path(__file__).resolve().parent
#: Where the scans of the course lie: in an installed package, or in a checkout.
_COURSE = (_PACKAGE / "_course" / "scans", _PACKAGE.parent / "data" / "scans")


def data_folder() -> Path:
    """Return the folder of the data sets, which need not exist: $GPCOURSE_DATA, or the user's cache."""
    if os.environ.get(FOLDER_VARIABLE):
        return Path(os.environ[FOLDER_VARIABLE]).expanduser()
    return Path(user_cache_dir("gpcourse"))


def bunny_folder() -> Path | None:
    """Return the folder of the Stanford bunny, or None if not all of its scans are here."""
    folder = data_folder() / "bunny"
    return folder if BUNNY.is_in(folder) else None


def pebble_folder() -> Path:
    """Return the folder of the scans that come with the course.

    Raises
    ------
    DataError
        If this installation lacks them.
    """
    for folder in _COURSE:
        if PEBBLE.is_in(folder):
            return folder
    raise DataError("this installation holds no scans; install it anew, or run it in a checkout")


def range_scans() -> list[Scan]:
    """Return five scans of one object, with true poses: the Stanford bunny where it is here, else a pebble.

    The bunny's lengths are metres, about 0.15 for the whole; the pebble, a made object, is about 3 long.
    """
    folder = bunny_folder()
    return load_scans(pebble_folder(), PEBBLE) if folder is None else load_scans(folder, BUNNY)


def coursework_mesh(name: str) -> tuple[FloatArray, IntArray] | None:
    """Return vertices and faces of a mesh of the coursework, or None if it is not here.

    The course does not hold these meshes, as others made them. Whoever has them puts the files, such as
    ``lilium_s.obj``, into the folder ``meshes`` of `data_folder`.

    Raises
    ------
    ObjFormatError
        If the file is damaged.
    """
    file = data_folder() / "meshes" / name
    return read_obj(file.read_text(encoding="utf-8", errors="replace")) if file.is_file() else None


def load_scans(folder: Path, scans: ScanSet) -> list[Scan]:
    """Read scans and their poses.

    Raises
    ------
    PlyFormatError, DataError
        If a file is damaged.
    """
    poses = _read_poses((folder / scans.poses).read_text(encoding="ascii", errors="replace"), scans.poses)
    read = []
    for name in scans.scans:
        stem = name.removesuffix(".ply")
        if stem not in poses:
            raise DataError(f"{scans.poses} has no pose of {name}; restore the files of {folder}")
        elements = read_ply_elements((folder / name).read_bytes())
        points = ply_vertices(elements)
        faces = grid_triangles(_grid(elements, name, scans.grid, len(points)), points, scans.longest)
        R, t = poses[stem]
        read.append(Scan(stem, points, R, t, faces, None, np.zeros(len(points), dtype=bool)))
    return read


def _grid(elements: dict[str, Any], name: str, shape: tuple[int, int], count: int) -> Any:
    """Return which of `count` points is at each pixel, -1 where the scanner saw nothing."""
    pixels = elements.get("range_grid", {}).get("vertex_indices")
    index = np.full(shape[0] * shape[1], -1)
    if not isinstance(pixels, Lists) or len(pixels.sizes) != len(index) or pixels.sizes.max() > 1:
        raise DataError(f"{name} has no grid of {shape[1]} × {shape[0]} pixels; restore the file")
    if not np.isin(pixels.flat, np.arange(count)).all():
        raise DataError(f"a pixel of {name} shows a point that is not there; restore the file")
    index[pixels.sizes == 1] = pixels.flat.astype(np.int64)
    return index.reshape(shape)


def _read_poses(text: str, name: str) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Read lines ``bmesh FILE tx ty tz qx qy qz qw``: x goes to R(q)⁻¹ x + t."""
    poses = {}
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        if words[:1] != ["bmesh"]:
            continue
        try:
            tx, ty, tz, *q = (float(word) for word in words[2:])
            x, y, z, w = np.array(q) / np.linalg.norm(q)
        except ValueError:
            raise DataError(f"line {number} of {name} is damaged; restore the file") from None
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        R = np.eye(3) + 2 * w * cross + 2 * cross @ cross
        poses[words[1].removesuffix(".ply")] = R.T, np.array([tx, ty, tz])
    return poses


def fetch_bunny(url: str = BUNNY_URL) -> Path:
    """Download the Stanford bunny, unless it is here, and verify every file.

    What has arrived of a download that breaks off is kept, and the next call goes on from there.

    Returns
    -------
    Path
        The folder with the scans.

    Raises
    ------
    DataError
        If the server cannot be reached, or a file is not the one that is expected.
    """
    folder = data_folder() / "bunny"
    if bunny_folder() and all(_holds(folder / name, sha) for name, sha in BUNNY_SHA256.items()):
        return folder
    archive = _download(url, data_folder() / "bunny.tar.gz")
    try:
        files = _verified(archive)
    except (tarfile.TarError, EOFError, OSError, DataError) as error:
        archive.unlink()
        raise DataError(f"what came from {url} is not the bunny: {error}; fetch it anew") from None
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (folder / name).write_bytes(content)
    archive.unlink()
    return folder


def _verified(archive: Path) -> dict[str, bytes]:
    """Read the files that are wanted out of the archive, whatever else is in it, and compare their sums."""
    files: dict[str, bytes] = {}
    with tarfile.open(archive, "r:gz") as tar:
        for member in tar:
            name = Path(member.name).name
            if name in (*BUNNY_SHA256, BUNNY.poses) and member.isfile() and member.size <= _LARGEST:
                opened = tar.extractfile(member)
                files[name] = opened.read() if opened else b""
    for name, expected in BUNNY_SHA256.items():
        seen = _sha256(files[name]) if name in files else "missing"
        if seen != expected:
            raise DataError(f"the SHA-256 of {name} should be {expected[:12]}… and is {seen[:12]}…")
    _read_poses(files.get(BUNNY.poses, b"bmesh").decode("ascii", errors="replace"), BUNNY.poses)
    return files


def _holds(file: Path, sha256: str) -> bool:
    return file.is_file() and _sha256(file.read_bytes()) == sha256


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _download(url: str, target: Path) -> Path:
    """Bring `url` to `target` with pooch, going on where an earlier download broke off."""
    import pooch
    import requests

    part = target.with_name(target.name + ".part")
    target.parent.mkdir(parents=True, exist_ok=True)
    pooch.get_logger().setLevel("WARNING")

    def go_on(url: str, output_file: str, _: object) -> None:
        have = part.stat().st_size if part.exists() else 0
        headers = {"Range": f"bytes={have}-"} if have else {}
        with requests.get(url, stream=True, timeout=30, headers=headers) as response:
            complete = response.status_code == 416  # there is nothing after the last byte
            if not complete:
                response.raise_for_status()
                # A server that cannot go on from a byte sends all of it, with 200 and not 206.
                going_on = response.status_code == 206
                with part.open("ab" if going_on else "wb") as file:
                    _receive(response, file)
        part.replace(output_file)

    try:
        # The sums of the files inside are known, not that of the archive.
        return Path(pooch.retrieve(url, None, fname=target.name, path=target.parent, downloader=go_on))
    except (requests.RequestException, OSError) as error:
        cause = type(error).__name__
        raise DataError(
            f"{url} cannot be downloaded ({cause}). What has arrived is kept: run this again to go on. "
            f"Without a network, bring the file by other means and save it as {target}, then run it again. "
            "The notebooks work without it, on scans that come with the course."
        ) from None


def _receive(response: Any, file: IO[bytes]) -> None:
    """Write what arrives, and notice when it ends too early."""
    expected = response.headers.get("Content-Length")
    arrived = 0
    for chunk in response.iter_content(2**16):
        arrived += file.write(chunk)
    if expected is not None and arrived < int(expected):
        raise OSError(f"{arrived} of {expected} bytes arrived")
