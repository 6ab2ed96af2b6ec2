"""The blocking client."""

import socket
from collections import deque
from types import TracebackType
from typing import Any, Deque, Dict, Iterator, Optional, Tuple, Type

from ._errors import ConnectionLost, SlamdError
from ._grid import Grid
from ._map_view import MapView
from ._pose_page import PosePage
from ._wire import DEFAULT_SOCKET, MAX_FDS, PROTOCOL_VERSION, Wire, close_fd, read_fd, result_of

_MOST_NOTIFICATIONS = 10_000


class Client:
    """One connection, for one thread. Raises SlamdError and its children."""

    def __init__(self, path: str = DEFAULT_SOCKET, timeout_s: float = 10.0) -> None:
        self._wire = Wire()
        self._messages: Deque[Dict[str, Any]] = deque()
        self._notifications: Deque[Dict[str, Any]] = deque(maxlen=_MOST_NOTIFICATIONS)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.settimeout(timeout_s)
        try:
            self._socket.connect(path)
            self.version: Dict[str, Any] = self.call("version", protocol=PROTOCOL_VERSION)
        except OSError as error:
            self.close()
            raise ConnectionLost(f"{path}: {error}") from error
        except SlamdError:
            self.close()
            raise

    def call(self, method: str, **params: Any) -> Any:
        """The result of one request. For results with a descriptor use call_with_fd."""
        result, fd = self.call_with_fd(method, **params)
        close_fd(fd)
        return result

    def call_with_fd(self, method: str, **params: Any) -> Tuple[Any, Optional[int]]:
        """The result and the descriptor that came with it, which is then the caller's to close."""
        request_id, line = self._wire.request(method, params)
        try:
            self._socket.sendall(line)
        except OSError as error:
            raise ConnectionLost(str(error)) from error
        while True:
            message = self._receive()
            if "method" in message:
                self._notifications.append(message)
            elif message.get("id") == request_id or message.get("id") is None:
                result = result_of(message)
                return result, self._wire.take_fd(result)

    def subscribe(self, topic: str, rate_hz: float) -> None:
        self.call("subscribe", topic=topic, rate_hz=rate_hz)

    def notifications(self) -> Iterator[Tuple[str, Dict[str, Any]]]:
        """Topic and params of each notification, waiting for the next one."""
        while True:
            while not self._notifications:
                message = self._receive()
                if "method" in message:
                    self._notifications.append(message)
            message = self._notifications.popleft()
            yield message["method"], message["params"]

    def poses(self, rate_hz: float = 10.0) -> Iterator[Dict[str, Any]]:
        """Subscribes and yields each pose as it comes."""
        self.subscribe("pose", rate_hz)
        return (params for topic, params in self.notifications() if topic == "pose")

    def pose_page(self) -> PosePage:
        fd = self.call_with_fd("get_pose_page")[1]
        if fd is None:
            raise SlamdError("the pose page came without its file descriptor")
        return PosePage(fd)

    def map_bytes(self, **params: Any) -> Tuple[Dict[str, Any], bytes]:
        """get_map: what the daemon says of the map, and the PCD or PLY file itself."""
        result, fd = self.call_with_fd("get_map", **params)
        return result, read_fd(fd) if fd is not None else b""

    def map_view(self, **params: Any) -> MapView:
        """The map's points where the daemon put them, without a copy; params as of get_map, but the format."""
        result, fd = self.call_with_fd("get_map", format="ply", **params)
        if fd is None:
            raise SlamdError("the map came without its file descriptor")
        return MapView(result, fd)

    def grid(self) -> Grid:
        """The newest occupancy grid; an RpcError when the daemon is not in planar mode, or has none yet."""
        result, fd = self.call_with_fd("get_grid")
        if fd is None:
            raise SlamdError("the grid came without its file descriptor")
        return Grid(result, fd)

    def trajectory_tum(self) -> str:
        """The whole path as TUM text."""
        _, fd = self.call_with_fd("get_trajectory", format="tum")
        return read_fd(fd).decode() if fd is not None else ""

    def close(self) -> None:
        self._socket.close()
        self._wire.close()

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def _receive(self) -> Dict[str, Any]:
        while not self._messages:
            try:
                data, fds, _, _ = socket.recv_fds(self._socket, 65536, MAX_FDS)
            except OSError as error:
                raise ConnectionLost(str(error)) from error
            if not data:
                raise ConnectionLost("the daemon has hung up")
            self._messages.extend(self._wire.feed(data, fds))
        return self._messages.popleft()
