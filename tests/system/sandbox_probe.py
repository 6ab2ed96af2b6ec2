"""Tries what the unit forbids slamd, and what it needs. Judges nothing: writes what was possible as JSON to the file that it is
given. Run by the service itself, before slamd, and once more outside it, where a user may do all of it."""

import ctypes
import json
import mmap
import os
import socket
import sys

LIBC = ctypes.CDLL(None, use_errno=True)
PER_LINUX32 = 8


def opens(path):
    os.close(os.open(path, os.O_RDONLY))


def opens_socket(family, kind):
    socket.socket(family, kind).close()


def takes_personality(number):
    if LIBC.personality(number) < 0:
        raise OSError(ctypes.get_errno(), "personality")
    LIBC.personality(0)


def makes_set_user_id(path):
    with open(path, "wb"):
        try:
            os.chmod(path, 0o4755)
        finally:
            os.unlink(path)


def makes(path):
    with open(path, "wb"):
        os.unlink(path)


def attempts(folder):
    """Name: a function that fails where it is refused. folder: one that is the user's own."""
    return {
        "code made at run time": lambda: mmap.mmap(-1, 4096, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC).close(),
        "netlink": lambda: opens_socket(socket.AF_NETLINK, socket.SOCK_RAW),
        "IPv6": lambda: opens_socket(socket.AF_INET6, socket.SOCK_DGRAM),
        "a set-user-id program": lambda: makes_set_user_id(f"{folder}/suid"),
        "another personality": lambda: takes_personality(PER_LINUX32),
        "other processes": lambda: opens("/proc/1/status"),
        "the kernel's settings": lambda: opens("/proc/sys/kernel/ostype"),
        "a lock file": lambda: makes("/run/lock/slamd-probe"),
        "shared memory": lambda: makes("/dev/shm/slamd-probe"),
        "UDP": lambda: opens_socket(socket.AF_INET, socket.SOCK_DGRAM),
        "a local socket": lambda: opens_socket(socket.AF_UNIX, socket.SOCK_STREAM),
        "a file of its state": lambda: makes(f"{folder}/state"),
        "a temporary file": lambda: makes("/tmp/slamd-probe"),
    }


def is_possible(attempt):
    try:
        attempt()
    except OSError:
        return False
    return True


def main():
    path = sys.argv[1]
    told = {name: is_possible(attempt) for name, attempt in attempts(os.path.dirname(path)).items()}
    with open(path, "w", encoding="ascii") as report:
        json.dump(told, report)


if __name__ == "__main__":
    main()
