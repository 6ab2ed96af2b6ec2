"""A map as the daemon handed it over: the points of a PLY file in shared memory, seen where they lie."""

import mmap
import os
from types import TracebackType
from typing import Any, Dict, Optional, Type

from ._errors import SlamdError

FIELDS = ("x", "y", "z", "intensity")
_POINT_BYTES = 4 * len(FIELDS)
_HEADER_END = b"end_header\n"
_LONGEST_HEADER = 4096
_PROPERTIES = b"".join(b"property float %s\n" % field.encode() for field in FIELDS)


class MapView:
    """Points in map, metres, intensity 0..255; read-only, no copy. `told` is what the daemon says of the map.

    Views of it stay good as long as one of them is held; close() fails with BufferError as long as there is any.
    """

    def __init__(self, told: Dict[str, Any], fd: int) -> None:
        """Takes over the descriptor of a get_map with format ply, and closes it."""
        self.told = told
        try:
            self._map = mmap.mmap(fd, 0, mmap.MAP_SHARED, mmap.PROT_READ)
        except (OSError, ValueError) as error:
            raise SlamdError(f"not a map: {error}") from error
        finally:
            os.close(fd)
        end = self._map.find(_HEADER_END, 0, _LONGEST_HEADER)
        header = self._map[:max(end, 0)]
        self._begin = end + len(_HEADER_END)
        self._size = int(told["points"])
        if not header.endswith(b"element vertex %d\n%s" % (self._size, _PROPERTIES)):
            raise SlamdError("the map is of a form that this client does not know")
        if len(self._map) != self._begin + self._size * _POINT_BYTES:
            raise SlamdError("the map is not as long as it says")

    def __len__(self) -> int:
        return self._size

    def memory(self) -> memoryview:
        """All points as bytes: four little-endian floats each."""
        return memoryview(self._map)[self._begin:]

    def rows(self) -> Any:
        """An array of N x 4 floats: x, y, z, intensity. Needs numpy."""
        import numpy

        return numpy.frombuffer(self._map, "<f4", 4 * self._size, self._begin).reshape(-1, 4)

    def close(self) -> None:
        self._map.close()

    def __enter__(self) -> "MapView":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()
