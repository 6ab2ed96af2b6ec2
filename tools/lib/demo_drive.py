"""tools/demo without the building: a live drive through slamd, or a recorded one through slam-replay."""
import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

import demo_report as report
import programs

START_DELAY_S = 3.0


def parse_arguments():
    parser = argparse.ArgumentParser(prog="tools/demo")
    parser.add_argument("--seconds", type=float, help="end the simulated drive after so many seconds")
    parser.add_argument("--scenario", default="campus")
    parser.add_argument("--drive", help="a recorded drive folder instead of the simulator")
    parser.add_argument("--out", default=os.path.join(programs.ROOT, "out/demo"))
    parser.add_argument("--build-dir", default=programs.BUILD, help="where the programs are (default: build/release)")
    parser.add_argument("--config", default=os.path.join(programs.ROOT, "config/slamd.yaml"))
    options = parser.parse_args()
    if options.seconds is not None and options.seconds <= 0:
        parser.error("--seconds must be positive")
    if options.drive and not os.path.isdir(options.drive):
        parser.error(f"--drive {options.drive}: is no folder")
    return options


def start_sensors(children, options, files, ports):
    arguments = ["--live", "--scenario", options.scenario, "--imu-pty", files["imu"], "--gps-pty", files["gps"],
                 "--truth", files["truth"], "--lidar-port", str(ports[0]), "--position-port", str(ports[1]),
                 "--start-delay", str(START_DELAY_S)]
    if options.seconds:
        arguments += ["--duration", str(options.seconds)]
    children.start("slam-sim", *arguments)
    children.wait_for("slam-sim", lambda: os.path.exists(files["imu"]) and os.path.exists(files["gps"]),
                      "the sensors' serial ports")


def start_daemon(children, options, files, ports):
    settings = {"imu.device": files["imu"], "gnss.device": files["gps"], "server.socket": files["socket"],
                "lidar.port": ports[0], "lidar.position_port": ports[1]}
    arguments = ["--config", options.config]
    for key, value in settings.items():
        arguments += ["--set", f"{key}={value}"]
    children.start("slamd", *arguments)
    daemon = programs.Daemon(files["socket"])
    children.wait_for("slamd", lambda: daemon.call("get_status") is not None, "slamd's socket")
    return daemon


def describe(status, pose, progress):
    """The live line."""
    done, total = progress or (0.0, 0.0)
    sources = status["health"]["sources"]
    rates = "  ".join(f"{name} {source['rate_hz']:.0f}/s" for name, source in sources.items())
    text = f"{done:5.1f}/{total:.1f} s  {status['pose']['status']}"
    if status["pose"]["reasons"]:
        text += "(" + ",".join(status["pose"]["reasons"]) + ")"
    if pose:
        x, y, z = pose["T_map_base"]["translation_m"]
        speed = sum(v * v for v in pose["velocity_mps"]) ** 0.5
        text += f"  x {x:.2f} y {y:.2f} z {z:.2f} m  {speed:.1f} m/s"
    return text + f"  {rates}  keyframes {status['map']['keyframes']}"


def watch(children, daemon):
    """Shows the status until the drive ends; the last status of the drive, whose rates are those of driving."""
    line = programs.StatusLine()
    seen = None
    simulator = next(child for name, child in children.running if name == "slam-sim")
    while simulator.poll() is None:
        children.check("slamd")
        status = daemon.call("get_status")
        if status:
            seen = status
            line.show(describe(status, daemon.call("get_pose"), programs.progress_of(children.log("slam-sim"))))
        time.sleep(0.25)
    line.end()
    if simulator.returncode != 0:
        raise programs.Failure(f"slam-sim ended with code {simulator.returncode}:\n"
                               + programs.log_end(children.log("slam-sim")))
    if seen is None:
        raise programs.Failure("slamd never answered while the vehicle drove")
    return seen


def run_live(options):
    ports = (programs.free_udp_port(2368), programs.free_udp_port(8308))
    # A folder with a short name of its own: the path of a Unix socket has at most 107 bytes.
    with tempfile.TemporaryDirectory(prefix="slamd-demo-") as links, programs.Programs(options.out) as children:
        files = {"imu": f"{links}/imu", "gps": f"{links}/gps", "socket": f"{links}/slamd.sock"}
        files.update({name: os.path.join(options.out, name + ending)
                      for name, ending in (("truth", ".tum"), ("trajectory", ".tum"), ("map", ".pcd"))})
        start_sensors(children, options, files, ports)
        daemon = start_daemon(children, options, files, ports)
        print(f"slamd runs; its socket is {files['socket']}")
        status = watch(children, daemon)
        time.sleep(1.0)  # the last packets are still on their way through slamd
        final = daemon.call("get_status") or status
        programs.run("slamctl", "--socket", files["socket"], "map", "save", files["map"])
        programs.run("slamctl", "--socket", files["socket"], "trajectory", "save", files["trajectory"])
        code = children.stop("slamd")
        if code != 0:
            raise programs.Failure(f"slamd ended with code {code}:\n{programs.log_end(children.log('slamd'))}")
    rates = "   ".join(f"{name} {source['rate_hz']:.1f}/s" for name, source in status["health"]["sources"].items())
    rows = [("rates", rates), *report.status_rows(final)]
    show_outcome(options.out, files["truth"], files["trajectory"], files["map"], rows)


def run_recorded(options):
    code = subprocess.call([programs.find_program("slam-replay"), options.drive, "--config", options.config,
                            "--out", options.out])
    if code != 0:
        raise programs.Failure(f"slam-replay ended with code {code}")
    with open(os.path.join(options.out, "report.json"), encoding="utf-8") as file:
        rows = report.report_rows(json.load(file))
    truth = os.path.join(options.drive, "truth.tum")
    show_outcome(options.out, truth if os.path.exists(truth) else None, os.path.join(options.out, "odom.tum"),
                 os.path.join(options.out, "map.pcd"), rows)


def show_outcome(out, truth, trajectory, map_path, rows):
    if truth:
        report.print_table("Errors against the truth", report.evaluate(truth, trajectory, out))
    report.print_table("Run", rows)
    picture = report.draw(map_path, trajectory, truth, out)
    files = [("map", map_path), ("trajectory", trajectory), ("picture", picture)]
    if truth:
        files.append(("error plots", os.path.join(out, "ape.png") + ", " + os.path.join(out, "rpe.png")))
    report.print_table("Files", files)


def interrupt(*_):
    raise KeyboardInterrupt


def main():
    options = parse_arguments()
    programs.BUILD = options.build_dir
    options.out = os.path.abspath(options.out)
    os.makedirs(options.out, exist_ok=True)
    signal.signal(signal.SIGTERM, interrupt)
    try:
        run_recorded(options) if options.drive else run_live(options)
    except programs.Failure as failure:
        print(f"\ndemo: {failure}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\ndemo: interrupted, all programs ended", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
