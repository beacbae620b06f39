"""reidentd with a DDS domain and a folder of its own, and the programs that talk to it."""

import json
import os
import random
import signal
import subprocess


class RealService:
    """Runs while the context lasts. `configuration` is the text of a configuration without [dds];
    its database and the log are in `folder`. `programs` is the folder service of a build."""

    def __init__(self, programs, folder, configuration):
        self.programs, self.folder = programs, folder
        domain = random.SystemRandom().randint(1, 200)
        partition = f"trust-{os.getpid()}"
        self.endpoint = ["--domain", str(domain), "--partition", partition]
        self.environment = {k: v for k, v in os.environ.items() if k != "CYCLONEDDS_URI"}
        (folder / "service.toml").write_text(
            f'[dds]\ndomain = {domain}\npartition = "{partition}"\n\n{configuration}')

    def __enter__(self):
        with open(self.folder / "reidentd.log", "w") as log:
            self.process = subprocess.Popen(
                [self.programs / "daemon/reidentd", "--config", self.folder / "service.toml"],
                stdout=log, stderr=log, env=self.environment)
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait()

    def run(self, program, *arguments):
        """What a program that prints a JSON object says."""
        done = subprocess.run([self.programs / program, *arguments, "--json"], check=True,
                              env=self.environment, stdout=subprocess.PIPE, text=True)
        return json.loads(done.stdout)

    def receive(self, *arguments, speed="max"):
        """Takes all that satcs-reference sends."""
        return self.run("satcs/satcs-reference", *arguments, "--speed", speed, "--wait-readers",
                        "1", *self.endpoint)

    def wait_idle(self):
        """Until no window is pending; the service's status."""
        return self.run("cli/reident", "status", "--wait", "idle", "--timeout", "3600",
                        *self.endpoint)
