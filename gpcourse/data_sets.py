"""Data made by others: fetched on demand, verified, kept outside of the course.

The course does without: where the Stanford scans are not here, `range_scans` makes scans of its own.
"""

from __future__ import annotations

import hashlib
import os
import tarfile
from pathlib import Path
from typing import IO, Any

import numpy as np

from gpcourse.errors import DataError
from gpcourse.geometry.arrays import FloatArray
from gpcourse.geometry.ply import Lists, ply_vertices, read_ply_elements
from gpcourse.geometry.scans import Scan, grid_triangles, pebble, turntable

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
_POSES = "bun.conf"
_GRID = (400, 512)  # rows and columns of the scanner
_LONGEST = 0.004  # metres, eight pixels: no longer edge joins two points of a scan
_LARGEST = 64 * 2**20  # bytes; no file of the archive is near it


def data_folder() -> Path:
    """Return the folder of the data sets, which need not exist: $GPCOURSE_DATA, or the user's cache."""
    if os.environ.get(FOLDER_VARIABLE):
        return Path(os.environ[FOLDER_VARIABLE]).expanduser()
    import pooch

    return Path(pooch.os_cache("gpcourse"))


def bunny_folder() -> Path | None:
    """Return the folder of the Stanford bunny, or None if it is not here as a whole."""
    folder = data_folder() / "bunny"
    return folder if all((folder / name).is_file() for name in (*BUNNY_SHA256, _POSES)) else None


def range_scans() -> list[Scan]:
    """Return five scans of one object, with true poses: the Stanford bunny where it is here, else made ones.

    The bunny's lengths are metres, about 0.15 for the whole; the made object is about 3 long.
    """
    folder = bunny_folder()
    if folder is not None:
        return load_bunny(folder)
    return turntable(pebble(6), pixels=150, noise=0.0005, rng=1)


def load_bunny(folder: Path) -> list[Scan]:
    """Read the five scans of the Stanford bunny, with the poses of its `bun.conf`.

    Raises
    ------
    PlyFormatError, DataError
        If a file is damaged.
    """
    poses = _read_poses((folder / _POSES).read_text(encoding="ascii", errors="replace"))
    made = []
    for name in BUNNY_SHA256:
        stem = name.removesuffix(".ply")
        if stem not in poses:
            continue  # the reconstruction is no scan
        elements = read_ply_elements((folder / name).read_bytes())
        points = ply_vertices(elements)
        faces = grid_triangles(_grid(elements, name), points, _LONGEST)
        R, t = poses[stem]
        made.append(Scan(stem, points, R, t, faces, None, np.zeros(len(points), dtype=bool)))
    return made


def _grid(elements: dict[str, Any], name: str) -> Any:
    """Return the index of the point at each pixel, -1 where the scanner saw nothing."""
    pixels = elements.get("range_grid", {}).get("vertex_indices")
    index = np.full(_GRID[0] * _GRID[1], -1)
    if not isinstance(pixels, Lists) or len(pixels.sizes) != len(index) or pixels.sizes.max() > 1:
        raise DataError(f"{name} has no grid of {_GRID[1]} × {_GRID[0]} pixels; fetch it anew")
    index[pixels.sizes == 1] = pixels.flat.astype(np.int64)
    return index.reshape(_GRID)


def _read_poses(text: str) -> dict[str, tuple[FloatArray, FloatArray]]:
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
            raise DataError(f"line {number} of {_POSES} is damaged; fetch it anew") from None
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
    if bunny_folder() and all(_sha256((folder / f).read_bytes()) == sha for f, sha in BUNNY_SHA256.items()):
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
            if name in (*BUNNY_SHA256, _POSES) and member.isfile() and member.size <= _LARGEST:
                opened = tar.extractfile(member)
                files[name] = opened.read() if opened else b""
    for name, expected in BUNNY_SHA256.items():
        seen = _sha256(files[name]) if name in files else "missing"
        if seen != expected:
            raise DataError(f"the SHA-256 of {name} should be {expected[:12]}… and is {seen[:12]}…")
    _read_poses(files.get(_POSES, b"bmesh").decode("ascii", errors="replace"))
    return files


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
            "The notebooks work without it, on scans that the course makes itself."
        ) from None


def _receive(response: Any, file: IO[bytes]) -> None:
    """Write what arrives, and notice when it ends too early."""
    expected = response.headers.get("Content-Length")
    arrived = 0
    for chunk in response.iter_content(2**16):
        arrived += file.write(chunk)
    if expected is not None and arrived < int(expected):
        raise OSError(f"{arrived} of {expected} bytes arrived")
