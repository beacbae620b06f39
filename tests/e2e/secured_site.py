"""The authorities of a secured domain, and members of it."""

import subprocess

from harness import BIN, DEADLINE_S


class Site:
    """A site's folder, and members of it."""

    def __init__(self, folder):
        self.folder = folder
        self.call("init", folder)

    def call(self, action, *arguments):
        done = subprocess.run([str(BIN / "reident"), "security", action, *map(str, arguments)],
                              capture_output=True, text=True, timeout=DEADLINE_S, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def member(self, name):
        return self.folder / "members" / name

    def grant(self, role, name, *options):
        self.call("grant", self.folder, role, name, "--partition", "*", *options)
        return self.member(name)

    def renew(self, name, *options):
        self.call("renew", self.folder, name, *options)
