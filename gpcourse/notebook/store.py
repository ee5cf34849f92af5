"""The student's progress, in a small file beside the notebooks.

The file serves `progress` and `working` and nothing else: whoever deletes it has to run the
checks again. No trouble with it ever stops a notebook.
"""

from __future__ import annotations

import json
import os
import tempfile
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

FILE = ".gpcourse-progress.json"
VARIABLE = "GPCOURSE_PROGRESS"

_FORMAT = "gpcourse progress 1"
_MAX_BYTES = 2**20


@dataclass(frozen=True)
class Record:
    """How the last check of an exercise went. `code` is the fingerprint of the function."""

    outcome: str
    points: int
    of: int
    code: str


class Foreign(Exception):
    """The file is none of ours, or damaged."""


class Store:
    """The records in one file. What cannot be written is kept in memory."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.memory: dict[str, Record] = {}
        self.said: set[str] = set()

    def records(self) -> dict[str, Record]:
        """Read all records, those of other notebooks in the folder included."""
        return {**self._read(), **self.memory}

    def put(self, name: str, record: Record) -> None:
        """Write one record; the file is replaced as a whole, so that it is never half written."""
        records = {**self.records(), name: record}
        try:
            self._replace(
                {"format": _FORMAT, "exercises": {n: asdict(r) for n, r in sorted(records.items())}}
            )
            self.memory.clear()
        except OSError as error:
            self.memory[name] = record
            reason = error.strerror or type(error).__name__
            self._say(
                f"{self.path.name} cannot be written ({reason}); your progress is kept until you restart."
            )

    def _read(self) -> dict[str, Record]:
        try:
            if self.path.stat().st_size > _MAX_BYTES:
                raise Foreign
            return _parsed(self.path.read_bytes())
        except Foreign:
            self._set_aside()
        except OSError:  # not there, or not to be read
            pass
        return {}

    def _set_aside(self) -> None:
        backups = (self.path.with_name(f"{self.path.name}{ending}") for ending in _endings())
        backup = next(path for path in backups if not path.exists())
        with suppress(OSError):
            self.path.rename(backup)
            self._say(
                f"{self.path.name} could not be read; it is now {backup.name}, and your progress starts anew."
            )

    def _replace(self, content: dict[str, Any]) -> None:
        handle, name = tempfile.mkstemp(prefix=f"{self.path.name}.", dir=self.path.parent)
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                json.dump(content, file, indent=1)
            Path(name).replace(self.path)
        except OSError:
            with suppress(OSError):
                Path(name).unlink()
            raise

    def _say(self, text: str) -> None:
        if text not in self.said:
            self.said.add(text)
            print(f"Note: {text}")


def store() -> Store:
    """Return the store of this notebook: that of the variable GPCOURSE_PROGRESS, or of the folder."""
    named = os.environ.get(VARIABLE)
    return _store(Path(named).expanduser().absolute() if named else _folder() / FILE)


@cache
def _store(path: Path) -> Store:
    return Store(path)


@cache
def _folder() -> Path:
    """Return the folder in which the notebook was started, also after an ``os.chdir``."""
    return Path.cwd()


def _endings() -> Any:
    yield ".bak"
    i = 2
    while True:
        yield f".bak{i}"
        i += 1


def _parsed(raw: bytes) -> dict[str, Record]:
    try:
        content = json.loads(raw)
        if content["format"] != _FORMAT:
            raise Foreign
        return {str(name): _record(entry) for name, entry in content["exercises"].items()}
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        raise Foreign from None


def _record(entry: dict[str, Any]) -> Record:
    record = Record(**entry)
    texts = isinstance(record.outcome, str) and isinstance(record.code, str)
    if not texts or type(record.points) is not int or type(record.of) is not int:
        raise Foreign
    return record
