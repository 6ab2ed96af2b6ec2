"""A booted Debian in a container of its own: systemd-nspawn on an overlay of the running root, which it cannot change. Holds no
test."""

import os
import subprocess
import sys

from overlay_root import OverlayRoot, require_root_and, run

sys.path.append(os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "support"))

from waiting import first_value  # noqa: E402

ADDRESS = "192.168.1.77"         # of the machine
SENSOR_ADDRESS = "192.168.1.201"  # on the other end of its cable


def await_value(what, attempt, timeout_s):
    value = first_value(attempt, timeout_s)
    if not value:
        raise AssertionError(f"waited {timeout_s} s for {what}")
    return value


class Cable:
    """Two network namespaces with a wire between them: the machine's and the sensors'."""

    def __init__(self):
        self.machine, self.sensors = (f"slamd-{end}-{os.getpid()}" for end in ("machine", "sensors"))
        for namespace in (self.machine, self.sensors):
            run("ip", "netns", "add", namespace)
            run("ip", "-n", namespace, "link", "set", "lo", "up")
        run("ip", "link", "add", "lidar0", "netns", self.machine, "type", "veth", "peer", "name", "vlp16", "netns", self.sensors)
        self.address(self.machine, "lidar0", ADDRESS)
        self.address(self.sensors, "vlp16", SENSOR_ADDRESS)

    @staticmethod
    def address(namespace, device, address):
        run("ip", "-n", namespace, "address", "add", f"{address}/24", "dev", device)
        run("ip", "-n", namespace, "link", "set", device, "up")

    def close(self):
        for namespace in (self.machine, self.sensors):
            run("ip", "netns", "delete", namespace, check=False)


class Machine(OverlayRoot):
    """prepare(), boot(), close(); close() alone when one of the two has failed."""

    def __init__(self):
        super().__init__()
        self.container = None
        self.leader = None
        self.cable = None

    def prepare(self):
        """Its root and its network cable. SkipTest where the system does not permit a machine."""
        require_root_and("systemd-nspawn", "nsenter", "ip")
        self.mount()
        self.cable = Cable()

    def boot(self, devices=()):
        """devices: files of this machine and what they are called in the other one."""
        binds = [f"--bind={here}:{there}" for here, there in devices]
        with open(os.path.join(self.folder, "console"), "wb") as console:
            self.container = subprocess.Popen(
                ["systemd-nspawn", "--boot", "--directory", self.root, "--register=no", "--keep-unit", "--console=pipe",
                 "--capability=all", "--system-call-filter=@memlock bpf", f"--machine=slamd-{os.getpid()}",
                 f"--network-namespace-path=/run/netns/{self.cable.machine}", *binds, "--", "--unit=basic.target"],
                stdin=subprocess.DEVNULL, stdout=console, stderr=console, start_new_session=True,
                env={**os.environ, "SYSTEMD_NSPAWN_UNIFIED_HIERARCHY": "1"})
        self.leader = await_value("the machine's init", self.find_leader, 30.0)
        try:
            await_value("the boot", lambda: self.call("systemctl", "is-system-running", check=False).stdout.strip()
                        in ("running", "degraded"), 400.0)
        except AssertionError as failure:
            raise AssertionError(f"{failure}\n{self.call('systemctl', 'list-jobs', check=False).stdout}") from failure

    def find_leader(self):
        with open(f"/proc/{self.container.pid}/task/{self.container.pid}/children", encoding="ascii") as children:
            pids = children.read().split()
        return int(pids[0]) if pids else None

    def call(self, *command, check=True, timeout_s=120.0):
        """Runs a command in the machine, as its root."""
        return run("nsenter", "-t", str(self.leader), "-a", "--", "env", "-i", "PATH=/usr/sbin:/usr/bin:/sbin:/bin",
                   "DEBIAN_FRONTEND=noninteractive", *command, check=check, timeout_s=timeout_s)

    def show(self, unit, name):
        return self.call("systemctl", "show", "--value", "-p", name, unit).stdout.strip()

    def install(self, folder, *packages):
        """With what the packages need already there: it has no network."""
        files = self.bring(folder, *packages)
        return self.call("apt-get", "install", "-y", "--no-install-recommends", "-o", "Dpkg::Use-Pty=0", *files).stdout

    def close(self):
        if self.leader:
            run("kill", "-s", "RTMIN+4", str(self.leader), check=False)  # poweroff
        if self.container:
            try:
                self.container.wait(20.0)
            except subprocess.TimeoutExpired:
                self.container.kill()
                self.container.wait()
        if self.cable:
            self.cable.close()
        super().close()
