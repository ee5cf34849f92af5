"""Files as they were handed in, in folders and in zip files.

A zip file is read in memory, member by member. Nothing of it is ever written to disk, so that no name in it
can lead anywhere. What it unpacks to is measured while it unpacks; its headers are not believed.
"""

from __future__ import annotations

import io
import re
import stat
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO

#: Larger files are not read. Stored pictures make notebooks of tens of megabytes.
MAX_BYTES = 100 * 2**20
#: What all zip files of one student may unpack to, how many files they may hold, and how deep they may lie
#: in each other.
MAX_UPLOAD = 3 * MAX_BYTES
MAX_FILES = 2_000
MAX_DEPTH = 2
#: A notebook of one repeated picture is packed about 50 to 1, zeros 1,000 to 1. Below the floor any ratio
#: will do.
MAX_RATIO = 200
RATIO_FLOOR = 10 * 2**20

#: The endings of archives. Of these only zip files are opened.
ARCHIVES = (".zip", ".7z", ".rar", ".tar", ".gz", ".tgz", ".bz2", ".xz")

_PIECE = 2**20
_CENTRAL = b"PK\x01\x02"  # begins the entry of each member in a zip file's table of contents
_DAMAGE = (
    zipfile.BadZipFile, zlib.error, struct.error, EOFError, OSError, ValueError, OverflowError,
    NotImplementedError, RuntimeError,
)  # fmt: skip


class Unreadable(Exception):
    """Why a file cannot be read."""


@dataclass(frozen=True)
class Entry:
    """A file or a folder, with its place below the class.

    `read` returns the content of a file, or raises `Unreadable`.
    """

    parts: tuple[str, ...]
    read: Callable[[], bytes]
    folder: bool = False

    @property
    def name(self) -> str:
        """The last part of its place."""
        return self.parts[-1]

    @property
    def suffix(self) -> str:
        """The ending of its name, in small letters, with the dot; of ada.ipynb.txt too that is .ipynb."""
        return Path(plain(self.name)).suffix.lower()


@dataclass
class Budget:
    """The bytes and the files that may still come out of zip files."""

    size: int = MAX_UPLOAD
    files: int = MAX_FILES


def plain(name: str) -> str:
    """Leave out what browsers and mail programs put behind the name of a notebook."""
    return re.sub(r"(\.ipynb)(\.txt|\.json)+$", r"\1", name, flags=re.IGNORECASE)


def hidden(name: str) -> bool:
    """Whether a file is an editor's or a system's: .ipynb_checkpoints, __MACOSX and their like."""
    return name.startswith((".", "__"))


def read_file(path: Path) -> bytes:
    """Read a file, unless it is a link or too large.

    Raises
    ------
    Unreadable
        With the reason.
    """
    try:
        if path.is_symlink():
            raise Unreadable("it is a link to another place")
        if not path.is_file():
            raise Unreadable("it is not a file")
        if path.stat().st_size > MAX_BYTES:
            raise Unreadable(f"it is larger than {MAX_BYTES // 2**20} MB")
        return path.read_bytes()
    except OSError as error:
        raise Unreadable(error.strerror or "it cannot be opened") from None


def folder_entries(folder: Path, above: tuple[str, ...] = ()) -> Iterator[Entry]:
    """Yield what lies in a folder, at any depth, sorted; a link is an entry that cannot be read."""
    try:
        paths = sorted(folder.iterdir())
    except OSError as error:
        if not above:
            raise
        yield Entry((*above, "folder.ipynb"), _cannot_open(error.strerror or "it cannot be opened"))
        return
    for path in paths:
        if hidden(path.name):
            continue
        parts = (*above, _text(path.name))
        link = path.is_symlink()
        yield Entry(parts, lambda path=path: read_file(path), folder=path.is_dir())  # type: ignore[misc]
        if path.is_dir() and not link:
            yield from folder_entries(path, parts)


def _cannot_open(reason: str) -> Callable[[], bytes]:
    def read() -> bytes:
        raise Unreadable(f"its folder cannot be opened: {reason}")

    return read


@contextmanager
def zip_file(path: Path) -> Iterator[list[Entry]]:
    """Open a zip file that a learning platform made of a class, and give what is in it.

    Raises
    ------
    Unreadable
        If it is no zip file.
    """
    try:
        archive = zipfile.ZipFile(path)
    except _DAMAGE as error:
        raise Unreadable(f"it is not a zip file, or damaged ({str(error)[:80]})") from None
    with archive:
        # Each member is bounded when it is read. The platform made the table, so its length is believed.
        yield _members(archive, path.stat().st_size, Budget(size=2**62, files=2**62))


def unzip(raw: bytes, budget: Budget) -> list[Entry]:
    """Return what is in a zip file that a student made. All of it is read within `budget`.

    Raises
    ------
    Unreadable
        If it is no zip file, or holds too many files.
    """
    if raw.count(_CENTRAL) > MAX_FILES:  # before a table of millions of names is built
        raise Unreadable(f"it holds more than {MAX_FILES} files")
    try:
        archive = zipfile.ZipFile(io.BytesIO(raw))
    except _DAMAGE as error:
        raise Unreadable(f"it is not a zip file, or damaged ({str(error)[:80]})") from None
    return _members(archive, len(raw), budget)


def _members(archive: zipfile.ZipFile, size: int, budget: Budget) -> list[Entry]:
    infos = archive.infolist()
    budget.files -= len(infos)
    if budget.files < 0:
        raise Unreadable(f"there are more than {MAX_FILES} files")
    entries = []
    for info in infos:
        parts = _parts(info)
        if parts and not any(map(hidden, parts)):
            read: Callable[[], bytes] = lambda info=info: _inflated(archive, info, size, budget)  # type: ignore[misc]  # noqa: E731
            entries.append(Entry(parts, read, folder=info.is_dir()))
    return entries


def _parts(info: zipfile.ZipInfo) -> tuple[str, ...]:
    """Return the place of a member. One that leads upwards or to the root stays where it is."""
    name = info.filename
    if not info.flag_bits & 0x800:  # not marked as UTF-8, which it often is all the same
        with suppress(ValueError):
            name = name.encode("cp437").decode("utf-8")
    parts = name.replace("\\", "/").split("/")
    return tuple(_text(part) for part in parts if part not in ("", ".", ".."))


def _text(name: str) -> str:
    """Return a name that can be written as UTF-8."""
    return name.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def _inflated(archive: zipfile.ZipFile, info: zipfile.ZipInfo, size: int, budget: Budget) -> bytes:
    if info.flag_bits & 0x1:
        raise Unreadable("it is encrypted; ask for it without a password")
    if stat.S_ISLNK(info.external_attr >> 16):
        raise Unreadable("it is a link to another place")
    if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        # The others cannot be stopped in the middle of a block, which may unpack to gigabytes.
        raise Unreadable("it is packed in an unusual way; ask for an ordinary zip file")
    most = min(MAX_BYTES, budget.size, max(RATIO_FLOOR, MAX_RATIO * min(info.compress_size, size)))
    try:
        with archive.open(info) as file:
            content = _up_to(most + 1, file)
    except _DAMAGE as error:
        raise Unreadable(f"it is damaged in the zip file ({str(error)[:80]})") from None
    budget.size -= min(len(content), most)
    if len(content) > most:
        raise Unreadable(f"it unpacks to more than {most // 2**20} MB")
    return bytes(content)


def _up_to(most: int, file: IO[bytes]) -> bytearray:
    """Read in pieces: asked for much at once, a file unpacks much before it looks at its own length."""
    content = bytearray()
    while len(content) < most and (piece := file.read(min(_PIECE, most - len(content)))):
        content += piece
    return content
