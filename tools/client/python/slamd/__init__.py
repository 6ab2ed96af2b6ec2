"""Python client of slamd's socket: blocking (Client) and asyncio (AsyncClient). Standard library only; numpy, where it is
there, sees the pose page and maps without a copy.

    from slamd import Client
    with Client() as daemon:
        print(daemon.call("get_status")["pose"])
        for pose in daemon.poses(rate_hz=50):
            print(pose["T_map_base"]["translation_m"])
"""

from ._async import AsyncClient
from ._client import Client
from ._errors import ConnectionLost, RpcError, SlamdError
from ._grid import Grid
from ._map_view import MapView
from ._pose_page import PosePage, PoseSample

__all__ = ["AsyncClient", "Client", "ConnectionLost", "Grid", "MapView", "PosePage", "PoseSample", "RpcError", "SlamdError"]
