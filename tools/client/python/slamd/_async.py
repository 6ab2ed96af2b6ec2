"""The asyncio client: the same calls as coroutines, and poses as an asynchronous iterator."""

import asyncio
import socket
from types import TracebackType
from typing import Any, AsyncIterator, Dict, Optional, Tuple, Type

from ._errors import ConnectionLost, SlamdError
from ._grid import Grid
from ._map_view import MapView
from ._pose_page import PosePage
from ._wire import DEFAULT_SOCKET, MAX_FDS, PROTOCOL_VERSION, Wire, close_fd, read_fd, result_of

_MOST_NOTIFICATIONS = 1000


class AsyncClient:
    """Make one with `await AsyncClient.connect()`. Calls may overlap; each gets its own answer."""

    def __init__(self, connected: socket.socket) -> None:
        self._loop = asyncio.get_running_loop()
        self._socket = connected
        self._wire = Wire()
        self._calls: Dict[int, "asyncio.Future[Tuple[Any, Optional[int]]]"] = {}
        self._notifications: "asyncio.Queue[Optional[Dict[str, Any]]]" = asyncio.Queue()
        self._lost: Optional[SlamdError] = None
        self.version: Dict[str, Any] = {}
        self._loop.add_reader(connected.fileno(), self._readable)

    @classmethod
    async def connect(cls, path: str = DEFAULT_SOCKET) -> "AsyncClient":
        connected = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        connected.setblocking(False)
        try:
            await asyncio.get_running_loop().sock_connect(connected, path)
        except OSError as error:
            connected.close()
            raise ConnectionLost(f"{path}: {error}") from error
        client = cls(connected)
        try:
            client.version = await client.call("version", protocol=PROTOCOL_VERSION)
        except SlamdError:
            client.close()
            raise
        return client

    async def call(self, method: str, **params: Any) -> Any:
        """The result of one request. For results with a descriptor use call_with_fd."""
        result, fd = await self.call_with_fd(method, **params)
        close_fd(fd)
        return result

    async def call_with_fd(self, method: str, **params: Any) -> Tuple[Any, Optional[int]]:
        if self._lost:
            raise self._lost
        request_id, line = self._wire.request(method, params)
        answer: "asyncio.Future[Tuple[Any, Optional[int]]]" = self._loop.create_future()
        self._calls[request_id] = answer
        try:
            await self._loop.sock_sendall(self._socket, line)
            return await answer
        except OSError as error:
            raise ConnectionLost(str(error)) from error
        finally:
            self._calls.pop(request_id, None)

    async def poses(self, rate_hz: float = 10.0) -> AsyncIterator[Dict[str, Any]]:
        """Subscribes and yields each pose as it comes; the oldest are let go when nobody takes them."""
        await self.call("subscribe", topic="pose", rate_hz=rate_hz)
        while True:
            message = await self._notifications.get()
            if message is None:
                raise self._lost or ConnectionLost("closed")
            if message["method"] == "pose":
                yield message["params"]

    async def pose_page(self) -> PosePage:
        _, fd = await self.call_with_fd("get_pose_page")
        if fd is None:
            raise SlamdError("the pose page came without its file descriptor")
        return PosePage(fd)

    async def map_bytes(self, **params: Any) -> Tuple[Dict[str, Any], bytes]:
        result, fd = await self.call_with_fd("get_map", **params)
        return result, read_fd(fd) if fd is not None else b""

    async def map_view(self, **params: Any) -> MapView:
        """The map's points where the daemon put them, without a copy; params as of get_map, but the format."""
        result, fd = await self.call_with_fd("get_map", format="ply", **params)
        if fd is None:
            raise SlamdError("the map came without its file descriptor")
        return MapView(result, fd)

    async def grid(self) -> Grid:
        """The newest occupancy grid; an RpcError when the daemon is not in planar mode, or has none yet."""
        result, fd = await self.call_with_fd("get_grid")
        if fd is None:
            raise SlamdError("the grid came without its file descriptor")
        return Grid(result, fd)

    def close(self) -> None:
        self._fail(ConnectionLost("closed"))

    async def __aenter__(self) -> "AsyncClient":
        return self

    async def __aexit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException],
                        trace: Optional[TracebackType]) -> None:
        self.close()

    def _readable(self) -> None:
        try:
            data, fds, _, _ = socket.recv_fds(self._socket, 65536, MAX_FDS)
            if not data:
                return self._fail(ConnectionLost("the daemon has hung up"))
            for message in self._wire.feed(data, fds):
                self._dispatch(message)
        except BlockingIOError:
            return
        except OSError as error:
            self._fail(ConnectionLost(str(error)))
        except (ValueError, SlamdError) as error:
            self._fail(SlamdError(f"the daemon sent what is not the protocol: {error}"))

    def _dispatch(self, message: Dict[str, Any]) -> None:
        if "method" in message:
            if self._notifications.qsize() >= _MOST_NOTIFICATIONS:
                self._notifications.get_nowait()
            self._notifications.put_nowait(message)
            return
        answer = self._calls.get(message.get("id") or 0)
        try:
            result = result_of(message)
            fd = self._wire.take_fd(result)
            if answer and not answer.done():
                answer.set_result((result, fd))
            else:
                close_fd(fd)
        except SlamdError as error:
            if answer and not answer.done():
                answer.set_exception(error)

    def _fail(self, error: SlamdError) -> None:
        if self._lost:
            return
        self._lost = error
        self._loop.remove_reader(self._socket.fileno())
        self._socket.close()
        self._wire.close()
        for answer in self._calls.values():
            if not answer.done():
                answer.set_exception(error)
        self._notifications.put_nowait(None)
