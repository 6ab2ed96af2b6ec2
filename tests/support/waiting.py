"""Waiting for what another program does, bounded in time."""

import time


def first_value(attempt, timeout_s):
    """Asks until attempt() gives something true, which is returned; None after timeout_s."""
    deadline = time.monotonic() + timeout_s
    while time.monotonic() < deadline:
        value = attempt()
        if value:
            return value
        time.sleep(0.05)
    return None
