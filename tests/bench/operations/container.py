"""The recipe of the container's image and the manifest for Kubernetes, where no engine runs.

    container.py BUILD

The steps of the image's last stage are carried out on a bare Debian 12. What they made runs as the
image's user, with a read-only root and a volume, and the manifest's probes ask it. The manifest is
checked against the schemas of Kubernetes. The last line is one JSON object.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from packages import NSPAWN, ROOT, TOOLS, inside, make_packages, run, wait_until

FOLDER = Path(__file__).resolve().parent
USER = 10001


def last_stage():
    """RUN, ENTRYPOINT and CMD of the image."""
    text = (ROOT / "deploy/container/Containerfile").read_text().replace("\\\n", "")
    stage = re.sub(r"(?m)^#.*\n", "", text[text.rindex("\nFROM "):])
    found = dict(re.findall(r"(?m)^(RUN|USER|ENTRYPOINT|CMD) (.*)$", stage))
    assert found["USER"] == f"{USER}:{USER}"
    return found["RUN"], [*json.loads(found["ENTRYPOINT"]), *json.loads(found["CMD"])]


def manifest():
    shutil.copy(FOLDER / "package.json", ".")
    shutil.copy(FOLDER / "package-lock.json", ".")
    shutil.copy(FOLDER / "manifest.mjs", ".")
    run("npm", "ci", "--no-audit", "--no-fund")
    said = run("node", "manifest.mjs", ROOT / "deploy/container/reident.yaml").stdout
    return json.loads(said)[0]["spec"]["template"]["spec"]


class Container:
    """What the image holds, with the root that the manifest gives it."""

    def __init__(self, folder, packages, steps):
        self.root, self.volume = folder / "root", folder / "volume"
        run("debootstrap", "--variant=minbase", "bookworm", self.root)
        (self.root / "packages").mkdir()
        for package in packages:
            shutil.copy(package, self.root / "packages")
        run(*NSPAWN, f"--directory={self.root}", "--setenv=DEBIAN_FRONTEND=noninteractive",
            "sh", "-c", steps)
        self.volume.mkdir()
        os.chown(self.volume, USER, USER)
        self.configuration = folder / "reident.toml"
        text = (ROOT / "deploy/reference.toml").read_text()
        self.configuration.write_text(re.sub(
            r'(?m)^database = "\S+"', 'database = "/var/lib/reident/reident.db"', text))

    def start(self, log, *command):
        with open(log, "ab") as out:
            self.process = subprocess.Popen(
                [*NSPAWN, "--read-only", "--as-pid2", "--private-network",
                 f"--directory={self.root}", "--user=reident", "--tmpfs=/tmp",
                 f"--bind={self.volume}:/var/lib/reident",
                 f"--bind-ro={self.configuration}:/etc/reident/reident.toml",
                 *command],
                stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT)

    def inside(self):
        return inside(self.process, f"--setuid={USER}", f"--setgid={USER}")

    def __call__(self, *command, check=True):
        return run(*self.inside(), *command, check=check)

    def end(self):
        self.process.terminate()
        self.process.wait()


def serve(folder, packages, pod):
    steps, command = last_stage()
    container = Container(folder, packages, steps)
    service, page = pod["containers"]
    container.start(folder / "log", *command)
    try:
        wait_until(lambda: container(*service["startupProbe"]["exec"]["command"],
                                     check=False).returncode == 0, "the service is heard")
        container(*pod["initContainers"][0]["command"])
        assert container("touch", "/etc/written", check=False).returncode != 0
        second = subprocess.Popen(
            [*container.inside(), *page["command"]], stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            wait_until(lambda: container(*page["livenessProbe"]["exec"]["command"],
                                         check=False).returncode == 0, "the page answers")
        finally:
            second.terminate()
            second.wait()
    finally:
        container.end()
    assert (container.volume / "reident.db").stat().st_uid == USER


def main():
    missing = [tool for tool in [*TOOLS, "npm", "node"] if not shutil.which(tool)]
    if os.geteuid() != 0 or missing:
        reason = "needs root" if os.geteuid() != 0 else f"without {', '.join(missing)}"
        print(json.dumps({"left_out": {"container": reason}}))
        return
    packages = make_packages()
    with tempfile.TemporaryDirectory(prefix="reident-container-") as name:
        os.chdir(name)
        pod = manifest()
        serve(Path(name), packages, pod)
        os.chdir("/")
    print(json.dumps({"container_serves": True, "manifest_valid": True,
                      "left_out": {"container engine": "none is asked for. The steps of the image's last "
                                   "stage are carried out on a bare Debian"}}))


if __name__ == "__main__":
    main()
