"""The pose page: shared memory with the newest pose (layout: daemon/server/protocol/pose_page.hpp)."""

import mmap
import os
import struct
from dataclasses import dataclass
from typing import Any, Optional, Tuple

from ._errors import SlamdError

_HEADER = struct.Struct("<QII48x")  # magic, version, bytes of a sample
_STARTS = struct.Struct("<I")  # the first of the header's spare bytes
_STARTS_OFFSET = 16
_SEQUENCE = struct.Struct("<Q")
_SAMPLE = struct.Struct("<qqQ3d4d3d4d3d3d36d3dIIfI")
_SAMPLE_OFFSET = _HEADER.size + _SEQUENCE.size
_FIELDS = [  # the same sample for numpy
    ("time_ns", "<i8"), ("utc_offset_ns", "<i8"), ("sequence", "<u8"), ("map_position_m", "<f8", (3,)),
    ("map_rotation_xyzw", "<f8", (4,)), ("odom_position_m", "<f8", (3,)), ("odom_rotation_xyzw", "<f8", (4,)),
    ("velocity_mps", "<f8", (3,)), ("angular_velocity_rads", "<f8", (3,)), ("covariance", "<f8", (6, 6)),
    ("degenerate_direction", "<f8", (3,)), ("status", "<u4"), ("reasons", "<u4"), ("lidar_test_ratio", "<f4"),
    ("map_corrections", "<u4")]
_MAGIC = 0x4547415045534F50
_VERSION = 1
_PAGE_BYTES = 4096
_ATTEMPTS = 1000
_UTC_UNKNOWN = -(2**63)

STATUS = ("INITIALISING", "TRACKING", "DEGRADED", "LOST")


@dataclass(frozen=True)
class PoseSample:
    time_ns: int                                   # CLOCK_MONOTONIC, as time.monotonic_ns()
    utc_offset_ns: Optional[int]
    sequence: int
    map_position_m: Tuple[float, ...]
    map_rotation_xyzw: Tuple[float, ...]
    odom_position_m: Tuple[float, ...]
    odom_rotation_xyzw: Tuple[float, ...]
    velocity_mps: Tuple[float, ...]
    angular_velocity_rads: Tuple[float, ...]
    covariance: Tuple[float, ...]                  # 36, row-major
    degenerate_direction: Tuple[float, ...]
    status: str
    reasons: int
    lidar_test_ratio: float
    map_corrections: int


class PosePage:
    """A read-only mapping; read() makes no system call. It outlives the connection that it came from."""

    def __init__(self, fd: int) -> None:
        """Takes the descriptor over and closes it."""
        try:
            self._map = mmap.mmap(fd, _PAGE_BYTES, mmap.MAP_SHARED, mmap.PROT_READ)
        except (OSError, ValueError) as error:
            raise SlamdError(f"not a pose page: {error}") from error
        finally:
            os.close(fd)
        if _HEADER.unpack_from(self._map) != (_MAGIC, _VERSION, _SAMPLE.size):
            self._map.close()
            raise SlamdError("the pose page is of a version that this client does not know")

    def read(self) -> Optional[PoseSample]:
        """The newest sample; None before the first one, or when the daemon died in the middle of a write."""
        for _ in range(_ATTEMPTS):
            before = self.lock()
            if before == 0:
                return None
            if before % 2:
                continue
            content = self._map[_SAMPLE_OFFSET:_SAMPLE_OFFSET + _SAMPLE.size]
            if self.lock() == before:
                return _sample(_SAMPLE.unpack(content))
        return None

    def starts(self) -> int:
        """How many daemons have written this page: after a change odom and map begin anew, and sequence counts from 1."""
        count: int = _STARTS.unpack_from(self._map, _STARTS_OFFSET)[0]
        return count

    def lock(self) -> int:
        """The counter of writes: odd while one is under way, 0 before the first. What was taken from memory() or view()
        between two equal even values is of one instant."""
        count: int = _SEQUENCE.unpack_from(self._map, _HEADER.size)[0]
        return count

    def memory(self) -> memoryview:
        """The 512 bytes of the sample where they lie (docs/protocol.md); they change under the reader, see lock()."""
        return memoryview(self._map)[_SAMPLE_OFFSET:_SAMPLE_OFFSET + _SAMPLE.size]

    def view(self) -> Any:
        """The sample where it lies as a read-only numpy array () of a record with the names of PoseSample, `covariance` as 6 x 6; no copy.
        It changes under the reader, see lock(). Needs numpy."""
        import numpy

        return numpy.frombuffer(self._map, numpy.dtype(_FIELDS), 1, _SAMPLE_OFFSET).reshape(())

    def close(self) -> None:
        self._map.close()


def _sample(v: Tuple[Any, ...]) -> PoseSample:
    status = STATUS[v[62]] if v[62] < len(STATUS) else "?"
    return PoseSample(v[0], None if v[1] == _UTC_UNKNOWN else v[1], v[2], v[3:6], v[6:10], v[10:13], v[13:17],
                      v[17:20], v[20:23], v[23:59], v[59:62], status, v[63], v[64], v[65])
