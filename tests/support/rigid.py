"""Rigid transforms (translation, quaternion x y z w) and truth files, just enough to measure an error. No test here."""

import bisect
import math


def multiply(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def conjugate(q):
    return (-q[0], -q[1], -q[2], q[3])


def rotate(q, v):
    return multiply(multiply(q, (*v, 0.0)), conjugate(q))[:3]


def relative(a, b):
    """T_a_b of two poses T_w_a and T_w_b."""
    difference = [to - of for of, to in zip(a[0], b[0])]
    return rotate(conjugate(a[1]), difference), multiply(conjugate(a[1]), b[1])


def errors(a, b):
    """Distance (m) and angle (rad) between two poses."""
    _, rotation = relative(a, b)
    return math.dist(a[0], b[0]), 2.0 * math.atan2(math.hypot(*rotation[:3]), abs(rotation[3]))


class Truth:
    """A TUM file, read once. A last line that is still being written is left out."""

    def __init__(self, path):
        self.stamps, self.poses = [], []
        with open(path, encoding="ascii") as file:
            for line in file:
                words = line.split()
                if len(words) == 8 and line.endswith("\n"):
                    values = [float(word) for word in words]
                    self.stamps.append(values[0])
                    self.poses.append((tuple(values[1:4]), tuple(values[4:8])))

    def at(self, time_s):
        """Linear in position; the nearest attitude (stamps are 10 ms apart)."""
        i = min(max(bisect.bisect_left(self.stamps, time_s), 1), len(self.stamps) - 1)
        share = (time_s - self.stamps[i - 1]) / (self.stamps[i] - self.stamps[i - 1])
        begin, end = self.poses[i - 1], self.poses[i]
        position = tuple(b + share * (e - b) for b, e in zip(begin[0], end[0]))
        return position, end[1] if share > 0.5 else begin[1]
