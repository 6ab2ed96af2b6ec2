"""Where a replay with GPS puts a simulated drive on the earth, not aligned, and how well any estimate could know it:

    python3 enu_drives.py DRIVE REPLAY_OUT ... [--lasting 0.9] [--white 0.25]     # error of the drives' receiver, as slam-sim made it

The bound is that of shift and yaw by generalised least squares over all good fixes, the receiver's statistics known exactly.
"""

import argparse
import json
import math
import pathlib

import numpy as np

ORIGIN = (48.2653, 11.6714, 527.8)  # of slam-sim's world
LASTS_S = 60.0         # GpsModel::correlation_s
JUMP_S = (260.0, 280.0)  # --fault gps:jump=30@260+20, as the drives of README.md have it


def ecef(lat_deg, lon_deg, height_m):
    a, e2 = 6378137.0, 0.0066943799901413165
    lat, lon = math.radians(lat_deg), math.radians(lon_deg)
    n = a / math.sqrt(1.0 - e2 * math.sin(lat) ** 2)
    return np.array([(n + height_m) * math.cos(lat) * math.cos(lon), (n + height_m) * math.cos(lat) * math.sin(lon),
                     (n * (1.0 - e2) + height_m) * math.sin(lat)])


def axes(lat_deg, lon_deg):
    """Rows: east, north, up in ECEF."""
    lat, lon = math.radians(lat_deg), math.radians(lon_deg)
    return np.array([[-math.sin(lon), math.cos(lon), 0.0],
                     [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)],
                     [math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)]])


def errors(drive, out):
    """Horizontal and spatial RMS of enu.tum, metres."""
    told = json.loads((out / "report.json").read_text(encoding="utf-8"))["enu_origin"]
    origin = (told["lat_deg"], told["lon_deg"], told["ellipsoid_height_m"])
    world = axes(*ORIGIN[:2])
    truth, enu = np.loadtxt(drive / "truth.tum"), np.loadtxt(out / "enu.tum")
    enu = enu[(enu[:, 0] >= truth[0, 0]) & (enu[:, 0] <= truth[-1, 0])]
    placed = enu[:, 1:4] @ (world @ axes(*origin[:2]).T).T + world @ (ecef(*origin) - ecef(*ORIGIN))
    off = placed - np.stack([np.interp(enu[:, 0], truth[:, 0], truth[:, k]) for k in (1, 2, 3)], axis=1)
    return math.sqrt((off[:, :2] ** 2).sum(1).mean()), math.sqrt((off ** 2).sum(1).mean())


def good_fixes(drive):
    """Times (s) and horizontal places of the vehicle for each fix that no fault has touched."""
    truth = np.loadtxt(drive / "truth.tum", usecols=(0, 1, 2))
    with open(drive / "gps.csv", encoding="ascii") as file:
        stamps = [int(line.split(",")[0]) * 1e-9 for line in file if "GGA" in line]
    at = np.array([t for t in stamps if truth[0, 0] <= t <= truth[-1, 0] and not JUMP_S[0] <= t - truth[0, 0] < JUMP_S[1]])
    return at, np.stack([np.interp(at, truth[:, 0], truth[:, k]) for k in (1, 2)], axis=1), truth[::100, 1:]


def bound(drive, lasting_m, white_m):
    """Least horizontal RMS over the track in the mean square and in the median, metres, and how often it is below 0.5 m."""
    at, places, track = good_fixes(drive)
    noise = lasting_m ** 2 * np.exp(-np.abs(at[:, None] - at) / LASTS_S) + white_m ** 2 * np.eye(len(at))
    middle = places.mean(0)
    arms = places - middle
    zero, one = np.zeros(len(at)), np.ones(len(at))
    design = np.block([[one[:, None], zero[:, None], -arms[:, 1:]], [zero[:, None], one[:, None], arms[:, :1]]])
    weights = np.kron(np.eye(2), np.linalg.inv(noise))
    covariance = np.linalg.inv(design.T @ weights @ design)
    lever = sum(j.T @ j for x, y in track - middle for j in [np.array([[1, 0, -y], [0, 1, x]])]) / len(track)
    drawn = np.random.default_rng(1).multivariate_normal(np.zeros(3), covariance, 20000)
    rms = np.sqrt(np.einsum("ni,ij,nj->n", drawn, lever, drawn))
    return math.sqrt(np.trace(lever @ covariance)), float(np.median(rms)), float(np.mean(rms < 0.5))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pairs", nargs="+", type=pathlib.Path)
    parser.add_argument("--lasting", type=float, default=0.9)
    parser.add_argument("--white", type=float, default=0.25)
    options = parser.parse_args()
    print("| drive | horizontal m | with height m | bound: RMS / median m | below 0.5 m |\n| --- | --- | --- | --- | --- |")
    for drive, out in zip(options.pairs[::2], options.pairs[1::2]):
        horizontal, spatial = errors(drive, out)
        rms, median, share = bound(drive, options.lasting, options.white)
        print(f"| {drive.name} | {horizontal:.2f} | {spatial:.2f} | {rms:.2f} / {median:.2f} | {share:.0%} |", flush=True)


if __name__ == "__main__":
    main()
