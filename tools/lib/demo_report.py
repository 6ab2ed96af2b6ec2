"""What the demo prints at its end: errors against the truth, rates, latencies, files. Runs slam-eval, nothing else."""
import json
import os

import programs


def evaluate(truth, trajectory, out):
    """[(label, value)] of APE and RPE. Truth is interpolated to the stamps of the trajectory."""
    rows = []
    for label, arguments in (("APE", ["ape"]), ("RPE over 1 m", ["rpe", "-d", "1", "-u", "m"])):
        name = arguments[0]
        result = os.path.join(out, name + ".json")
        programs.run("slam-eval", *arguments, truth, trajectory, "--interpolate", "--json", result,
                     "--plot", os.path.join(out, name + ".png"))
        with open(result, encoding="utf-8") as file:
            results = json.load(file)["results"]
        position, angle = results["translation_part"], results["rotation_angle_deg"]
        rows.append((f"{label} position", f"rmse {position['rmse']:.4f} m   median {position['median']:.4f}   "
                                          f"max {position['max']:.4f}   ({position['count']} values)"))
        rows.append((f"{label} rotation", f"rmse {angle['rmse']:.4f} deg   max {angle['max']:.4f}"))
    return rows


def draw(map_path, trajectory, truth, out):
    picture = os.path.join(out, "map.png")
    arguments = ["picture", "--map", map_path, "--trajectory", trajectory, "--out", picture]
    if truth:
        arguments += ["--truth", truth]
    programs.run("slam-eval", *arguments)
    return picture


def stage_rows(stages):
    """Latencies in ms from get_status or report.json: {"scan": {"p50": ..}}."""
    rows = []
    for name, values in stages.items():
        if values.get("p50") is not None and values.get("count", 1):
            words = "   ".join(f"{key} {values[key]:.3f}" for key in ("p50", "p99", "max") if key in values)
            rows.append((f"{name} [ms]", words))
    return rows


def status_rows(status):
    health = status["health"]
    rows = []
    for name, source in health["sources"].items():
        rejected = sum(source["rejected"].values())
        rows.append((name, f"{source['received']} received   {source['lost']} lost   {rejected} rejected"))
    dropped = sum(ring["dropped"] for ring in health["rings"].values())
    rows.append(("dropped in rings", str(dropped)))
    rows += stage_rows(health["stages_ms"])
    rows.append(("memory", f"peak {health['memory']['peak_bytes'] / 1e6:.0f} MB"))
    rows.append(("map", f"{status['map']['keyframes']} keyframes   {status['map']['points']} points"))
    return rows


def report_rows(report):
    """From slam-replay's report.json."""
    rows = [("drive", f"{report['scans']} scans   {report['duration_s']:.1f} s   "
                      f"{report['realtime_factor']:.1f} times real time"),
            ("memory", f"peak {report['peak_rss_mb']:.0f} MB")]
    stages = {key[:-3]: value for key, value in report.items() if key.endswith("_ms") and isinstance(value, dict)}
    for name, value in list(stages.items()):
        if "p50" not in value:  # a group of stages
            del stages[name]
            stages.update(value)
    rows += stage_rows({**stages, **report.get("stages_ms", {})})
    for group in ("drops", "rejections"):
        counts = {cause: n for cause, n in flatten(report.get(group, {})) if n}
        rows.append((group, "   ".join(f"{cause} {n}" for cause, n in counts.items()) or "0"))
    return rows


def flatten(tree, prefix=""):
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from flatten(value, f"{prefix}{key}.")
        elif isinstance(value, (int, float)):
            yield prefix + key, value


def print_table(title, rows):
    print(f"\n{title}")
    width = max(len(label) for label, _ in rows)
    for label, value in rows:
        print(f"  {label.ljust(width)}  {value}")
