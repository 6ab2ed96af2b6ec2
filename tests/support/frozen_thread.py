"""Stops one thread of a running process, as a hang would, and lets it go when it is dead or the block is left."""

import contextlib
import ctypes
import os
import signal

PTRACE_DETACH, PTRACE_SEIZE, PTRACE_INTERRUPT = 17, 0x4206, 0x4207
WAIT_ALL = 0x40000000  # __WALL: threads too

libc = ctypes.CDLL(None, use_errno=True)
libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]


def ptrace(request, thread):
    if libc.ptrace(request, thread, None, None) != 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


class FrozenThread:
    """Only the caller's thread may use it; the kernel ties the two together."""

    def __init__(self, thread):
        self.thread = thread
        self.dead = False

    def __enter__(self):
        ptrace(PTRACE_SEIZE, self.thread)
        ptrace(PTRACE_INTERRUPT, self.thread)
        os.waitpid(self.thread, WAIT_ALL)
        return self

    def look(self):
        """Lets a thread go that was killed meanwhile; without that its process stays. True when it has gone."""
        if self.dead:
            return True
        with contextlib.suppress(ChildProcessError):
            thread, status = os.waitpid(self.thread, WAIT_ALL | os.WNOHANG)
            if thread == 0:
                return False
            if os.WIFSTOPPED(status):
                with contextlib.suppress(OSError):
                    libc.ptrace(PTRACE_DETACH, self.thread, None, signal.Signals(os.WSTOPSIG(status)).value)
                return False
        self.dead = True
        return True

    def __exit__(self, *_):
        if not self.look():
            with contextlib.suppress(OSError):
                ptrace(PTRACE_DETACH, self.thread)
