"""What can go wrong between a client and the daemon."""


class SlamdError(Exception):
    """Any failure of this package."""


class ConnectionLost(SlamdError):
    """Nobody listens at the socket, or the daemon has hung up."""


class RpcError(SlamdError):
    """The daemon answered with an error; `code` is one of the protocol's numbers."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(f"{message} ({code})")
        self.code = code
        self.message = message
