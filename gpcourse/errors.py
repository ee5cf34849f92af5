"""Every exception that gpcourse raises on purpose.

The tree::

    GpcourseError
    ├── GeometryError (also a ValueError)     the input is not the geometry that was asked for
    │   ├── ArrayError                        wrong shape, type, or values that are not finite
    │   ├── MeshError                         the faces do not form an oriented manifold
    │   │   ├── NonManifoldEdgeError
    │   │   ├── OrientationError
    │   │   └── HalfedgeError                 half-edge records contradict each other
    │   ├── DegenerateFaceError               a face without area
    │   ├── FlipError                         this edge must not be flipped
    │   ├── SingularSystemError               a linear system without exactly one solution
    │   ├── OffFormatError                    the text is not an OFF file
    │   ├── ObjFormatError                    the text is not an OBJ file
    │   └── PlyFormatError                    the file is not a PLY file, or it is damaged
    ├── PictureError (also a ValueError)      a setting that is none, a file that cannot be written
    ├── DataError                             data made by others is not here, or damaged
    ├── ExerciseError                         no such exercise, or one that is declared badly
    ├── NotebookError                         a notebook that cannot be read or filled in
    ├── WireError                             a message between processes that is not ours
    ├── WorkerError                           the worker process cannot be started or is gone
    └── UsageError                            a command was called with something it cannot use

A message names the offender, says what was seen, and then how to repair it.
"""


class GpcourseError(Exception):
    """The root: whoever catches this catches all that gpcourse raises on purpose."""


class GeometryError(GpcourseError, ValueError):
    """The input is not the geometry that was asked for."""


class ArrayError(GeometryError):
    """An array of the wrong shape or type, or one with values that are not finite."""


class MeshError(GeometryError):
    """The faces do not form an oriented manifold."""


class NonManifoldEdgeError(MeshError):
    """An edge with more than two faces, or a vertex where two sheets touch."""


class OrientationError(MeshError):
    """Two neighbouring faces run along their common edge in the same direction."""


class HalfedgeError(MeshError):
    """Half-edge records that contradict each other. `halfedge` is the first one concerned."""

    def __init__(self, message: str, halfedge: int | None = None) -> None:
        super().__init__(message)
        self.halfedge = halfedge


class DegenerateFaceError(GeometryError):
    """A face without area."""


class FlipError(GeometryError):
    """An edge that must not be flipped."""


class SingularSystemError(GeometryError):
    """A linear system that does not have exactly one solution, mostly because nothing is fixed."""


class OffFormatError(GeometryError):
    """A text that is not an OFF file. `line` is the number of the offending line, from 1."""

    def __init__(self, line: int, message: str) -> None:
        super().__init__(f"line {line}: {message}")
        self.line = line


class ObjFormatError(GeometryError):
    """A text that is not an OBJ file, or is damaged."""


class PlyFormatError(GeometryError):
    """A file that is not a PLY file, or is damaged."""


class PictureError(GpcourseError, ValueError):
    """A picture was asked for with a setting that it does not have, or cannot be written to a file."""


class DataError(GpcourseError):
    """Data made by others cannot be fetched, or is not what it should be."""


class ExerciseError(GpcourseError):
    """No such exercise, or an exercise that is declared badly."""


class NotebookError(GpcourseError):
    """A notebook that cannot be read or filled in."""


class WireError(GpcourseError):
    """A message between processes that does not follow the format, or exceeds its limits."""


class WorkerError(GpcourseError):
    """The worker process cannot be started, or is gone."""


class UsageError(GpcourseError):
    """A command was called with something that it cannot use."""
