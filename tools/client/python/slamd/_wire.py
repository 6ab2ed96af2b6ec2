"""Request lines out, messages and file descriptors in. No socket: both clients feed it the bytes they received."""

import json
import os
from collections import deque
from typing import Any, Deque, Dict, Iterable, List, Optional

from ._errors import RpcError, SlamdError

DEFAULT_SOCKET = "/run/slamd/slamd.sock"
PROTOCOL_VERSION = 1
MAX_LINE = 16 * 1024 * 1024
MAX_FDS = 4


class Wire:
    def __init__(self) -> None:
        self._bytes = bytearray()
        self._fds: Deque[int] = deque()
        self._last_id = 0

    def request(self, method: str, params: Dict[str, Any]) -> "tuple[int, bytes]":
        self._last_id += 1
        message = {"jsonrpc": "2.0", "id": self._last_id, "method": method, "params": params}
        return self._last_id, json.dumps(message).encode() + b"\n"

    def feed(self, data: bytes, fds: Iterable[int] = ()) -> List[Dict[str, Any]]:
        """Takes what came in one receive; returns the messages that are now whole."""
        self._fds.extend(fds)
        self._bytes += data
        *lines, rest = self._bytes.split(b"\n") if b"\n" in data else (self._bytes,)
        if len(rest) > MAX_LINE:
            raise SlamdError("endless line from the daemon")
        self._bytes = bytearray(rest)
        return [json.loads(line) for line in lines]

    def take_fd(self, result: Any) -> Optional[int]:
        """The descriptor that belongs to this result, if it says that one came with it."""
        if not isinstance(result, dict) or not result.get("fd"):
            return None
        if not self._fds:
            raise SlamdError("the answer came without its file descriptor")
        return self._fds.popleft()

    def close(self) -> None:
        while self._fds:
            os.close(self._fds.popleft())


def result_of(message: Dict[str, Any]) -> Any:
    if "error" in message:
        raise RpcError(int(message["error"]["code"]), str(message["error"]["message"]))
    return message["result"]


def close_fd(fd: Optional[int]) -> None:
    if fd is not None:
        os.close(fd)


def read_fd(fd: int) -> bytes:
    """All of a descriptor's content, which is then closed."""
    with os.fdopen(fd, "rb") as file:
        file.seek(0)
        return file.read()
