"""The Debian packages from their making to their removal, on a bare Debian 12 under a real systemd.

    packages.py BUILD

Needs root, and the packages of deploy/install_packages.sh --with-packages. The last line is one JSON
object: `exposure` is the worst of the units', by `systemd-analyze security`; `package_steps` says of
each step whether its test passed.
"""

import json
import os
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
TOOLS = ["systemd-nspawn", "debootstrap", "dpkg-deb", "lintian", "nsenter"]
OLDER = "0.0.9"  # a number below every release; no release with packages is older than this one
# Also where no systemd runs that it could ask for a unit of its own.
NSPAWN = ["systemd-nspawn", "--quiet", "--register=no", "--keep-unit", "--console=pipe"]
DEADLINE_S, IDLE_S = 90, 600  # longer than the watchdog


def run(*words, check=True, **options):
    done = subprocess.run([*map(str, words)], capture_output=True, text=True, check=False, **options)
    if check and done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, words))}:\n{done.stdout}{done.stderr}")
    return done


def wait_until(condition, what, deadline_s=DEADLINE_S):
    """The seconds that it took."""
    begin = time.monotonic()
    while not condition():
        if time.monotonic() - begin > deadline_s:
            raise AssertionError(f"after {deadline_s} s still not: {what}")
        time.sleep(0.02)  # poll
    return time.monotonic() - begin


def make_packages():
    environment = {**os.environ, "CMAKE_BUILD_PARALLEL_LEVEL": str(len(os.sched_getaffinity(0)))}
    run("cmake", "--preset", "packages", cwd=ROOT)
    run("cmake", "--build", "--preset", "packages", cwd=ROOT, env=environment)
    build = ROOT / "build/packages"
    shutil.rmtree(build / "packages", ignore_errors=True)
    run("cpack", "--config", build / "CPackConfig.cmake", cwd=build)
    return sorted((build / "packages").glob("*.deb"))


def as_older(package, folder):
    """The same package with a lower number, as one that was installed before."""
    unpacked = folder / package.name
    run("dpkg-deb", "-R", package, unpacked)
    version = run("dpkg-deb", "-f", package, "Version").stdout.strip()
    for name in "control", "preinst":
        file = unpacked / "DEBIAN" / name
        if file.exists():
            file.write_text(file.read_text().replace(version, OLDER))
    older = folder / package.name.replace(version, OLDER)
    run("dpkg-deb", "--root-owner-group", "-b", unpacked, older)
    shutil.rmtree(unpacked)
    return older


def exposure(packages, folder):
    """By unit."""
    found = {}
    for package in packages:
        run("dpkg-deb", "-x", package, folder)
    for unit in sorted(folder.glob("usr/lib/systemd/system/*.service")):
        text = run("systemd-analyze", "security", "--offline=yes", "--no-pager", unit).stdout
        found[unit.name] = float(re.search(r"exposure level for \S+: ([\d.]+)", text)[1])
    return found


def inside(nspawn, *options):
    """The command that runs a command within; nspawn's child is the first process there, at last."""
    children = Path(f"/proc/{nspawn.pid}/task/{nspawn.pid}/children").read_text().split()
    return ["nsenter", "-t", *(children[:1] or ["0"]), "-m", "-u", "-i", "-n", "-p", *options, "--"]


class Machine:
    """A bare Debian with its own systemd as the first process."""

    def __init__(self, folder):
        self.root = folder / "root"
        run("debootstrap", "--variant=minbase", "--include=systemd,systemd-sysv,dbus", "bookworm",
            self.root)
        self.booted = None

    def install(self, packages):
        """With their dependencies, before it is booted: it has no network then."""
        (self.root / "packages").mkdir(exist_ok=True)
        for package in packages:
            shutil.copy(package, self.root / "packages")
        names = [f"/packages/{package.name}" for package in packages]
        run(*NSPAWN, f"--directory={self.root}", "--setenv=DEBIAN_FRONTEND=noninteractive",
            "apt-get", "install", "-y", "--no-install-recommends", *names)

    def boot(self):
        self.booted = subprocess.Popen(
            [*NSPAWN, "--boot", "--private-network", f"--directory={self.root}"],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_until(lambda: self("systemctl", "is-system-running", check=False).stdout.strip() in
                   ("running", "degraded"), "the machine has booted")

    def __call__(self, *words, check=True):
        return run(*inside(self.booted), *words, check=check)

    def end(self):
        if self.booted:
            self.booted.terminate()
            self.booted.wait()

    # -- the service

    def state(self, unit="reidentd"):
        return self("systemctl", "is-active", unit, check=False).stdout.strip()

    def main_process(self):
        return int(self("systemctl", "show", "-P", "MainPID", "reidentd").stdout)

    def log(self, unit):
        return self("journalctl", "-u", unit, "-o", "cat").stdout

    def query(self, sql, folder="."):
        file = self.root / "var/lib/reident" / folder / "reident.db"
        with sqlite3.connect(f"file:{file}?mode=ro", uri=True) as database:
            return database.execute(sql).fetchone()[0]

    def samples(self):
        return self.query("SELECT sum(samples) FROM series")


class Steps:
    """In their order; each leaves the service running."""

    def __init__(self, machine, packages, older):
        self.machine, self.packages, self.older = machine, packages, older
        self.etc = machine.root / "etc/reident"
        self.figures = {}

    def restarted(self, before):
        return wait_until(lambda: self.machine.state() == "active" and
                          self.machine.main_process() not in (0, before), "it is started again")

    def configure_instance(self, name):
        text = (self.etc / "reident.toml").read_text()
        text = text.replace("/var/lib/reident/", f"/var/lib/reident/{name}/")
        (self.etc / f"{name}.toml").write_text(f'[dds]\npartition = "{name}"\n{text}')

    def add_instance(self, name, edit):
        """With a database, which `edit` makes."""
        self.configure_instance(name)
        folder = self.machine.root / "var/lib/reident" / name
        folder.mkdir()
        with sqlite3.connect(folder / "reident.db") as database:
            edit(database)
        self.machine("chown", "-R", "reident:reident", f"/var/lib/reident/{name}")
        return folder / "reident.db"

    def dpkg(self, *words, packages=(), check=True):
        for package in packages:
            shutil.copy(package, self.machine.root / "packages")
        names = [f"/packages/{package.name}" for package in packages]
        return self.machine("dpkg", *words, *names, check=check)

    def installed(self):
        owner = self.machine("stat", "-c", "%U %G %a", "/var/lib/reident").stdout.split()
        assert owner == ["reident", "reident", "750"], owner
        assert "reident" in self.machine("id", "-nG", "reident-web").stdout.split()
        assert self.machine.state() == "inactive", "an installation starts nothing"
        self.machine("reident", "check-config", "/etc/reident/reident.toml")
        self.machine("python3", "-c", "import reident; reident.library_version()")

    def started(self):
        text = (ROOT / "deploy/reference.toml").read_text()
        text = re.sub(r'(?m)^database = "\S+"', 'database = "/var/lib/reident/reident.db"', text)
        (self.etc / "reident.toml").write_text(text)
        self.machine("systemctl", "enable", "--now", "reidentd", "reident-web")
        assert self.machine.state() == "active"
        self.machine("satcs-reference", "--duration", "12h", "--speed", "max")
        self.machine("reident", "status", "--config", "/etc/reident/reident.toml", "--wait", "idle",
                     "--timeout", IDLE_S)
        self.stored = self.machine.samples()
        assert self.stored > 100_000, self.stored

    def page_answers(self):
        def ready():
            return self.machine(
                "bash", "-c", "exec 3<>/dev/tcp/127.0.0.1/8480 && printf 'GET /readyz HTTP/1.1\\r\\n"
                "Host: 127.0.0.1:8480\\r\\nConnection: close\\r\\n\\r\\n' >&3 && cat <&3",
                check=False).stdout.startswith("HTTP/1.1 200")
        wait_until(ready, "the page is ready")

    def journal_has_fields(self):
        lines = self.machine("journalctl", "-o", "json", "EQUIPMENT=REFERENCE/BDR").stdout
        entry = json.loads(lines.splitlines()[0])
        assert entry["SPACECRAFT"] == "REFERENCE" and entry["_SYSTEMD_UNIT"] == "reidentd.service"

    def killed(self):
        before = self.machine.main_process()
        self.machine("systemctl", "kill", "--signal=KILL", "reidentd")
        self.figures["restart_after_kill_s"] = round(self.restarted(before), 2)
        assert self.machine.samples() == self.stored

    def hung(self):
        before = self.machine.main_process()
        self.machine("systemctl", "kill", "--signal=STOP", "reidentd")
        self.figures["restart_after_hang_s"] = round(self.restarted(before), 2)
        assert self.machine.samples() == self.stored

    def mistake_is_named(self):
        text = (self.etc / "reident.toml").read_text()
        (self.etc / "reident.toml").write_text(text + "\nnonsense = 1\n")
        assert self.machine("systemctl", "restart", "reidentd", check=False).returncode != 0
        assert re.search(r"reident.toml:\d+: .*nonsense", self.machine.log("reidentd"))
        (self.etc / "reident.toml").write_text(text)
        self.machine("systemctl", "reset-failed", "reidentd")
        self.machine("systemctl", "start", "reidentd")

    def reloaded(self):
        self.machine("systemctl", "reload", "reidentd")
        wait_until(lambda: "log level read again" in self.machine.log("reidentd"), "it was read")

    def instance_has_a_folder(self):
        self.configure_instance("second")
        self.machine("systemctl", "start", "reidentd@second")
        owner = self.machine("stat", "-c", "%U %a", "/var/lib/reident/second").stdout.split()
        assert owner == ["reident", "750"], owner
        assert self.machine.query("PRAGMA user_version", "second") > 0
        self.machine("systemctl", "stop", "reidentd@second")

    def fleet_starts(self):
        (self.etc / "fleet.toml").write_text(
            '[fleet]\nconfiguration = "reident.toml"\nmemory_max = "1G"\n'
            '[[spacecraft]]\nname = "SAT-1"\n[[spacecraft]]\nname = "SAT-2"\n')
        self.machine("reident", "fleet", "init", "/etc/reident/fleet.toml")
        self.machine("systemctl", "daemon-reload")
        units = ["reidentd@SAT-1", "reidentd@SAT-2"]
        self.machine("systemctl", "start", *units)
        for unit in units:
            assert self.machine.state(unit) == "active"
            limit = self.machine("systemctl", "show", "-P", "MemoryMax", unit).stdout.strip()
            assert limit == str(1 << 30), limit
        status = self.machine("reident", "fleet", "status", check=False).stdout
        assert "SAT-1" in status and "SAT-2" in status, status
        configuration = self.etc / "SAT-1.toml"
        text = configuration.read_text()
        configuration.write_text(text + "\nnonsense = 1\n")
        assert self.machine("systemctl", "restart", units[0], check=False).returncode != 0
        assert re.search(r"SAT-1.toml:\d+: .*nonsense", self.machine.log(units[0]))
        assert self.machine.state(units[1]) == "active", "what one does touches no other"
        configuration.write_text(text)
        self.machine("systemctl", "stop", *units)

    def upgraded(self):
        statements = (ROOT / "tests/storage/database/schema_3.hpp").read_text()
        self.add_instance("old", lambda database: database.executescript(
            re.search(r'R"sql\((.*)\)sql"', statements, re.DOTALL)[1]))
        before = self.machine.main_process()
        configuration = (self.etc / "reident.toml").read_bytes()
        self.dpkg("-i", packages=self.packages)
        self.figures["restart_after_upgrade_s"] = round(self.restarted(before), 2)
        assert self.machine.samples() == self.stored
        assert (self.etc / "reident.toml").read_bytes() == configuration

    def old_database_is_migrated(self):
        assert self.machine.query("PRAGMA user_version", "old") == 3
        self.machine("systemctl", "start", "reidentd@old")
        assert self.machine.query("PRAGMA user_version", "old") == self.machine.query(
            "PRAGMA user_version")
        self.machine("systemctl", "stop", "reidentd@old")

    def newer_database_is_refused(self):
        file = self.add_instance("newer", lambda database: database.executescript(
            "PRAGMA application_id = 0x72656964; PRAGMA user_version = 99; CREATE TABLE a (b);"))
        content = file.read_bytes()
        assert self.machine("systemctl", "start", "reidentd@newer", check=False).returncode != 0
        assert "schema version 99" in self.machine.log("reidentd@newer")
        assert file.read_bytes() == content
        self.machine("systemctl", "stop", "reidentd@newer")

    def downgrade_is_refused(self):
        before = self.machine.main_process()
        done = self.dpkg("-i", packages=self.older, check=False)
        assert done.returncode != 0 and "REIDENT_DOWNGRADE" in done.stderr, done.stderr
        assert self.machine.main_process() == before and self.machine.state() == "active"
        self.dpkg("-i", packages=self.packages)  # what has no database had gone back

    def purged(self):
        names = [run("dpkg-deb", "-f", package, "Package").stdout.strip()
                 for package in self.packages]
        self.dpkg("--purge", *names)
        root = self.machine.root
        assert self.machine.state() == "inactive"
        assert not (root / "usr/bin/reidentd").exists()
        assert not (self.etc / "reident.toml").exists()
        assert self.machine.samples() == self.stored, "telemetry cannot be had again"


STEPS = [Steps.installed, Steps.started, Steps.page_answers, Steps.journal_has_fields, Steps.killed,
         Steps.hung, Steps.mistake_is_named, Steps.reloaded, Steps.instance_has_a_folder,
         Steps.fleet_starts, Steps.upgraded, Steps.old_database_is_migrated,
         Steps.newer_database_is_refused, Steps.downgrade_is_refused, Steps.purged]


def life(packages, folder):
    machine = Machine(folder)
    older_folder = folder / "older"
    older_folder.mkdir()
    older = [as_older(package, older_folder) for package in packages]
    machine.install(older)
    passed = {}
    steps = Steps(machine, packages, older)
    try:
        machine.boot()
        for step in STEPS:
            try:
                step(steps)
                passed[step.__name__] = True
            except (AssertionError, sqlite3.Error, json.JSONDecodeError, IndexError) as error:
                print(f"{step.__name__}: {error}", flush=True)
                passed[step.__name__] = False
                if step in (Steps.installed, Steps.started):
                    break
    finally:
        machine.end()
    return {"package_steps": passed, **steps.figures}


def main():
    if os.geteuid() != 0 or (missing := [tool for tool in TOOLS if not shutil.which(tool)]):
        reason = "needs root" if os.geteuid() != 0 else f"without {', '.join(missing)}"
        print(json.dumps({"left_out": {"packages": reason}}))
        return
    packages = make_packages()
    with tempfile.TemporaryDirectory(prefix="reident-packages-") as name:
        folder = Path(name)
        (folder / "files").mkdir()
        units = exposure(packages, folder / "files")
        said = run("lintian", *packages, check=False).stdout
        print(said, end="", flush=True)
        figures = {"exposure": max(units.values()), "exposure_of_units": units,
                   "lintian_errors": len(re.findall(r"(?m)^E: ", said)),
                   "lintian_warnings": len(re.findall(r"(?m)^W: ", said)),
                   **life(packages, folder),
                   "left_out": {"upgrade from a release": "no release has packages. The older ones "
                                "hold the same programs under a lower number, next to a database "
                                "of schema 3"}}
    print(json.dumps(figures))
    sys.exit(not all(figures["package_steps"].values()))


if __name__ == "__main__":
    main()
