"""The occupancy grid of planar mode, as get_grid hands it over."""

from typing import Any, Dict, Tuple

from ._errors import SlamdError
from ._wire import read_fd

UNKNOWN, FREE, OCCUPIED = -1, 0, 100


class Grid:
    """Squares of the map in rows from the lowest y: -1 unknown, 0 free, 100 occupied. `told` is what the daemon says of it."""

    def __init__(self, told: Dict[str, Any], fd: int) -> None:
        """Takes over the descriptor of a get_grid with format cells, and closes it."""
        self.told = told
        self.resolution_m: float = told["resolution_m"]
        self.origin_m: Tuple[float, float] = (told["origin_m"][0], told["origin_m"][1])
        self.width: int = told["width"]
        self.height: int = told["height"]
        self.cells: bytes = read_fd(fd)
        if len(self.cells) != self.width * self.height:
            raise SlamdError("the grid is not as large as it says")

    def at(self, x_m: float, y_m: float) -> int:
        """What the map says at this place, metres in map; unknown outside."""
        column = int((x_m - self.origin_m[0]) // self.resolution_m)
        row = int((y_m - self.origin_m[1]) // self.resolution_m)
        if not (0 <= column < self.width and 0 <= row < self.height):
            return UNKNOWN
        cell = self.cells[row * self.width + column]
        return cell - 256 if cell > 127 else cell

    def array(self) -> Any:
        """height x width numbers of 8 bits, the first row at the lowest y. Needs numpy."""
        import numpy

        return numpy.frombuffer(self.cells, numpy.int8).reshape(self.height, self.width)
