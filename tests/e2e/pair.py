"""Two services of a pair with databases of their own, and what a test asks of them."""

import json
import os
import shutil
import sqlite3
import subprocess
import threading
import time

import plant
from harness import DEADLINE_S, EndToEnd, wait_until

# Every table that the two share; rows of `journal` are the order of all others.
SHARED = ["term", "journal", "attempt", "version", "decision", "hold", "command", "alarm", "change",
          "simulator", "block", "score", "overruled"]


def can_make_hosts():
    """Whether this user may make network namespaces, and the tools are there."""
    if os.geteuid() != 0 or not shutil.which("ip") or not shutil.which("nft"):
        return False
    return subprocess.run(["unshare", "--net", "true"], check=False, capture_output=True).returncode == 0


class Host:
    """A machine: a network namespace with an address and a cable to others."""

    def __init__(self, name, address, others):
        """`others`: their addresses."""
        self.name, self.address, self.others = name, address, others
        self.prefix = ["ip", "netns", "exec", name]
        self.uri = (
            f'<CycloneDDS><Domain Id="any"><General><Interfaces><NetworkInterface address="{address}"'
            ' multicast="false"/></Interfaces><AllowMulticast>false</AllowMulticast></General>'
            "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>12"
            "</MaxAutoParticipantIndex><Peers>"
            + "".join(f'<Peer address="{one}"/>' for one in [address, *others])
            + "</Peers></Discovery></Domain></CycloneDDS>")

    def run(self, *command, text=None):
        subprocess.run([*self.prefix, *command], check=True, input=text, text=True,
                       capture_output=True)

    def cut(self, others=None):
        """Hears these no more; all by default."""
        addresses = ", ".join(others or self.others)
        self.run("nft", "-f", "-", text="table inet cut { chain input { type filter hook input "
                                        f"priority 0; ip saddr {{ {addresses} }} drop; }}; }}")

    def heal(self):
        self.run("nft", "delete", "table", "inet", "cut")


def make_hosts(test):
    """Two hosts by strength; they go with the test."""
    names = [f"reident-{os.getpid()}-{strength}" for strength in (2, 1)]
    addresses = "192.0.2.2", "192.0.2.1"
    for name in names:
        subprocess.run(["ip", "netns", "add", name], check=True)
        test.addCleanup(subprocess.run, ["ip", "netns", "delete", name], check=False)
    subprocess.run(["ip", "link", "add", "cable", "netns", names[0], "type", "veth", "peer", "name",
                    "cable", "netns", names[1]], check=True)
    hosts = {}
    for i, strength in enumerate((2, 1)):
        host = hosts[strength] = Host(names[i], addresses[i], [addresses[1 - i]])
        host.run("ip", "address", "add", f"{host.address}/24", "dev", "cable")
        for link in "lo", "cable":
            host.run("ip", "link", "set", link, "up")
    return hosts


class Operator(threading.Thread):
    """Gives one command after the other to whoever leads, under a new name each."""

    def __init__(self, run, equipment, host=None, pause_s=0):
        super().__init__()
        self.run_of, self.equipment, self.host, self.pause_s = run, equipment, host, pause_s
        self.answered = []  # names whose command was carried out
        self.stopping = False

    def run(self):
        for count in range(10**9):
            if self.stopping:
                return
            actor = f"operator-{count}"
            action = ("hold", "identify-now", "release", "identify-now", "rollback")[count % 5]
            status, _ = self.run_of.reident(action, self.equipment, "--actor", actor, "--json",
                                            "--timeout", 20, *self.run_of.endpoint(),
                                            host=self.host)
            if status == 0:
                self.answered.append(actor)
            time.sleep(self.pause_s)


class PairOfServices(EndToEnd):
    """`self.sides` are by strength: 2 leads when both start."""

    def configure_pair(self, **changes):
        self.sides = {}
        text = self.configure([plant.equipment(**changes)]).read_text()
        for strength in 2, 1:
            path = self.folder / f"{strength}.toml"
            path.write_text(text.replace("reident.db", f"{strength}.db").replace(
                "[service]", f"[service]\nstandby = true\nstrength = {strength}"))

    def start_side(self, strength, **options):
        side = self.start("reidentd", "--config", self.folder / f"{strength}.toml",
                          name=f"side-{strength}-{len(self.processes)}", **options)
        self.sides[strength] = side
        wait_until(lambda: "service: started" in side.text() or not side.running(), "it started")
        self.assertTrue(side.running(), side.text())
        return side

    def statuses(self, host=None):
        """What `reident status` says of each side that is heard, by strength."""
        status, text = self.reident("status", "--json", "--timeout", DEADLINE_S, *self.endpoint(),
                                    host=host)
        self.assertEqual(status, 0, text)
        first = json.loads(text)
        return {int(one["service"][-1]): one for one in [first, *first["others"]] if "pair" in one}

    def leads(self, strength, follower=None, host=None):
        """Whether this side leads, and the other one, if named, follows and lacks nothing."""
        statuses = self.statuses(host)

        def role(side):
            return statuses.get(side, {}).get("pair", {}).get("role")

        return role(strength) == "leads" and (follower is None or (
            role(follower) == "follows" and statuses[follower]["pair"]["lag"] == 0
            and statuses[strength]["pair"]["lag"] == 0))

    def alarms_of(self, strength, host=None):
        """None where it is not heard at the moment."""
        return self.statuses(host).get(strength, {"alarms": []})["alarms"]

    def start_both(self):
        for strength in 2, 1:
            self.start_side(strength)
        wait_until(lambda: self.leads(2, follower=1), "2 leads and 1 follows")

    def database_of(self, strength):
        return self.folder / f"{strength}.db"

    def ask(self, strength, sql, *values):
        connection = sqlite3.connect(f"file:{self.database_of(strength)}?mode=ro", uri=True,
                                     timeout=10)
        try:
            return connection.execute(sql, values).fetchall()
        finally:
            connection.close()

    def shared_rows(self, strength):
        return {table: self.ask(strength, f"SELECT * FROM {table}") for table in SHARED}

    def assert_same_rows(self):
        """The two registries become the same to the last bit."""
        def same():
            return self.shared_rows(1) == self.shared_rows(2)

        try:
            wait_until(same, "both have the same rows", deadline_s=20)
        except AssertionError:
            first, second = self.shared_rows(1), self.shared_rows(2)
            for table in SHARED:
                self.assertEqual(first[table], second[table], table)

    def champion_of(self, strength):
        rows = self.ask(strength, "SELECT version FROM champion")
        return rows[0][0] if rows else None

    def replay_flight(self, name, readers, *options, host=None, **keywords):
        csv = plant.write(self.folder / f"{name}.csv", plant.rows(**keywords))
        replay = self.start("satcs-replay", csv, "--spacecraft", "SAT", *self.endpoint(), "--speed",
                            "max", "--wait-readers", readers, *options, host=host)
        self.assertEqual(replay.wait(), 0, replay.text())

    def wait_for_champion(self, strength, simulators, above=0):
        """Waits until the side has a champion above a number, and these simulators run it."""
        def runs():
            champion = self.champion_of(strength)
            return champion and champion > above and all(
                self.runs(simulator)[-1:] == [champion] for simulator in simulators) and champion

        return wait_until(runs, f"simulators run a champion above {above}")
