"""The operators' page: how soon it answers and draws, what viewers cost, and what hostile ones do.

    web.py BUILD [--days N] [--repetitions N] [--archive FILE] [--only year|live]

Three databases: a year of five signals at 1 Hz with twenty equipment, and a day with a hundred, which are
made here, and one that a real service writes meanwhile. The browser is Debian's Chromium. Prints what was measured and, as the
last line, one JSON object of the figures.
"""

import argparse
import contextlib
import gzip
import http.client
import json
import os
import selectors
import socket
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "e2e"))

import plant  # noqa: E402: found in the folder above

DEADLINE_S = 120
FLIGHTS = 4  # four times as many in all: an archive that grows slows both kinds alike
BURST_S = 2.5  # of processor time, that questions without end may have at first, and a little more


def median(values):
    return statistics.median(values)


def p95(values):
    return sorted(values)[min(len(values) - 1, int(0.95 * len(values)))]


def wait_until(condition, what):
    end = time.monotonic() + DEADLINE_S
    while not (value := condition()):
        if time.monotonic() > end:
            raise SystemExit(f"after {DEADLINE_S} s still not: {what}")
        time.sleep(0.01)  # poll
    return value


class Page:
    """reident-web on a database of its own."""

    def __init__(self, build, folder, config, *options):
        self.log = folder / "web.log"
        with open(self.log, "ab") as log:
            self.process = subprocess.Popen(
                [build / "service/web/reident-web", "--config", config, "--port", "0", *options],
                stdout=subprocess.PIPE, stderr=log, text=True)
        self.url = self.process.stdout.readline().strip()
        self.port = int(self.url.rsplit(":", 1)[1].strip("/"))

    def get(self, path, timeout=DEADLINE_S):
        """Status, bytes on the way, and milliseconds."""
        begun = time.monotonic()
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        connection.request("GET", path, headers={"Accept-Encoding": "gzip"})
        answer = connection.getresponse()
        body = answer.read()
        connection.close()
        took = 1000 * (time.monotonic() - begun)
        return answer.status, body, took

    def json(self, path):
        status, body, _ = self.get(path)
        assert status == 200, body
        return json.loads(gzip.decompress(body) if body[:2] == b"\x1f\x8b" else body)

    def resident_mib(self):
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(status.split("VmRSS:")[1].split()[0]) / 1024

    def processor_s(self):
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def stop(self):
        self.process.terminate()
        self.process.wait()


def stand_behind():
    """This thread gives way to all others: viewers are elsewhere, and their work shall not count."""
    os.sched_setscheduler(threading.get_native_id(), os.SCHED_IDLE, os.sched_param(0))


class Viewers:
    """Connections that get events, read by one thread."""

    def __init__(self, port, count):
        self.heard = [b""] * count
        self.changed = threading.Condition()
        self.selector = selectors.DefaultSelector()
        for index in range(count):
            one = socket.create_connection(("127.0.0.1", port))
            one.sendall(b"GET /api/v1/stream HTTP/1.1\r\nHost: localhost\r\n\r\n")
            self.selector.register(one, selectors.EVENT_READ, index)
        self.stopping = False
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        stand_behind()
        while not self.stopping:
            for key, _ in self.selector.select(0.2):
                got = key.fileobj.recv(1 << 16)
                with self.changed:
                    self.heard[key.data] = (self.heard[key.data] + got)[-4096:]
                    self.changed.notify_all()

    def wait(self, text):
        """Until every viewer has heard it."""
        with self.changed:
            self.changed.wait_for(lambda: all(text in one for one in self.heard), DEADLINE_S)

    def stop(self):
        self.stopping = True
        self.thread.join()
        for key in list(self.selector.get_map().values()):
            key.fileobj.close()


def config_of(folder, database, domain):
    """A service with the plant of the tests, whose versions wait for an operator."""
    equipment = "[[spacecraft]]\nname = \"SAT\"\n[[spacecraft.equipment]]\n" + "\n".join(
        f"{key} = {json.dumps(value)}"
        for key, value in plant.equipment(approval="by_hand").items())
    path = folder / f"{database}.toml"
    path.write_text(f'[archive]\ndatabase = "{database}"\n[dds]\ndomain = {domain}\n'
                    f'partition = "bench-{os.getpid()}"\n[limits]\nsettle = "300ms"\n{equipment}')
    return path


def browser(url, *arguments):
    done = subprocess.run(["node", str(HERE / "web/browser.mjs"), url, *map(str, arguments)],
                          stdout=subprocess.PIPE, text=True, check=True, timeout=30 * 60)
    return json.loads(done.stdout.splitlines()[-1])


def make(build, database, days, equipment):
    subprocess.run([build / "tests/bench/web/reident_web_archive", database, str(days),
                    str(equipment)], check=True)


def year(build, folder, days, repetitions, archive):
    """What is measured on a year that nobody writes any more."""
    if archive:
        (folder / "year.db").symlink_to(archive.resolve())
    else:
        make(build, folder / "year.db", days, 20)
    page = Page(build, folder, config_of(folder, "year.db", 1 + os.getpid() % 200))
    try:
        path = "/api/v1/telemetry?spacecraft=BENCH&parameter=P1&bins=500"
        answers = [page.get(path) for _ in range(repetitions)]
        assert all(status == 200 for status, _, _ in answers), answers[0]
        figures = {"year_ms": p95([took for *_, took in answers]),
                   "year_bytes": max(len(body) for _, body, _ in answers)}
        used = page.processor_s()
        for _ in range(5):
            page.get(path)
        figures["year_processor_ms"] = 1000 * (page.processor_s() - used) / 5
        figures |= browser(page.url, "first", repetitions)
        figures |= browser(page.url, "plot", repetitions)
    finally:
        page.stop()
    return figures


def scrape(build, folder, repetitions):
    """What a monitoring system waits for, and gets, of a hundred equipment."""
    make(build, folder / "hundred.db", 1, 100)
    page = Page(build, folder, config_of(folder, "hundred.db", 1 + os.getpid() % 200))
    try:
        used = page.processor_s()
        scrapes = [page.get("/metrics") for _ in range(repetitions)]
        return {"scrape_ms": p95([took for *_, took in scrapes]),
                "scrape_bytes": max(len(body) for _, body, _ in scrapes),
                "scrape_processor_ms": 1000 * (page.processor_s() - used) / repetitions}
    finally:
        page.stop()


def slow(page, repetitions):
    """Normal requests while 200 connections each send a head, or a body, slowly, or read slowly."""
    figures, times = {}, []
    kinds = {"head": b"GET / HTTP/1.1\r\nX: a", "read": None,
             "body": b"POST /api/v1/orders HTTP/1.1\r\nHost: localhost\r\nContent-Length: 4000\r\n\r\n"}
    for kind, text in kinds.items():
        begun = time.monotonic()
        held = []
        for _ in range(200):
            one = socket.socket()
            if kind == "read":
                one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
            one.connect(("127.0.0.1", page.port))
            one.setblocking(False)
            one.send(text or b"GET /page.js HTTP/1.1\r\nHost: localhost\r\n\r\n" * 4)
            held.append(one)
        times += [page.get("/api/v1/service")[2] for _ in range(repetitions)]
        wait_until(lambda: page.json("/api/v1/service")["page"]["connections"] < 10, "closed")
        figures[f"slow_{kind}_closed_s"] = time.monotonic() - begun
        for one in held:
            one.close()
    figures["slow_p95_ms"] = p95(times)
    return figures


def live(build, folder, repetitions):
    """What is measured beside a service that decides and archives."""
    domain = 1 + os.getpid() % 200
    config = config_of(folder, "live.db", domain)
    endpoint = ["--domain", str(domain), "--partition", f"bench-{os.getpid()}"]
    reident = build / "service/cli/reident"

    def ordered(*words):
        subprocess.run([reident, *words, "--config", config, "--actor", "bench"], check=True,
                       stdout=subprocess.DEVNULL)

    with open(folder / "reidentd.log", "ab") as log:
        daemon = subprocess.Popen([build / "service/daemon/reidentd", "--config", config],
                                  stderr=log)
    page = Page(build, folder, config)
    figures = {}
    try:
        csv = plant.write(folder / "plant.csv", plant.rows(count=1900))
        replay = [build / "service/satcs/satcs-replay", csv, "--spacecraft", "SAT", "--speed", "max",
                  "--wait-readers", "1", *endpoint]
        subprocess.run(replay, check=True, stdout=subprocess.DEVNULL)
        subprocess.run([reident, "status", "--wait", "idle", "--timeout", "120", *endpoint],
                       check=True, stdout=subprocess.DEVNULL)
        viewers = Viewers(page.port, 50)
        times = []
        for turn in range(repetitions):
            before = page.json("/api/v1/changes")
            (now,) = [one["data"] for one in before["changes"] if one["event"] == "registry"]
            expected = f'"hold":"{int(now["hold"]) + 1}"'.encode()
            ordered("hold" if turn % 2 == 0 else "release", "PLANT")
            begun = time.monotonic()  # when the order is committed: its reply has come
            viewers.wait(expected)
            times.append(1000 * (time.monotonic() - begun))
        figures["decision_to_viewers_ms"] = p95(times)
        viewers.stop()
        figures |= browser(page.url, "live")
        figures |= browser(page.url, "tabs", min(repetitions, 10))
        viewers = Viewers(page.port, 100)
        wait_until(lambda: page.json("/api/v1/service")["page"]["streams"] >= 100, "100 viewers")
        used, begun = page.processor_s(), time.monotonic()
        span = 20
        while time.monotonic() < begun + span:
            time.sleep(0.5)  # poll
        figures["viewers_core"] = (page.processor_s() - used) / (time.monotonic() - begun)
        figures["viewers_mib"] = page.resident_mib()
        figures["viewers_answer_ms"] = p95([page.get("/api/v1/overview")[2]
                                            for _ in range(repetitions)])
        viewers.stop()
        figures |= slow(page, repetitions)
        figures |= ingest(build, folder, config, endpoint, page)
    finally:
        page.stop()
        daemon.terminate()
        daemon.wait()
    return figures


def ingest(build, folder, config, endpoint, page):
    """The rate of ingest with 100 viewers and 4 endless questions, over that without; the log."""
    flight = [build / "service/satcs/satcs-reference", "--spacecraft", "SAT", "--duration", "5d",
              "--speed", "max", "--wait-readers", "1", *endpoint]
    rates, asked = {True: [], False: []}, []
    log_bytes, stop = [0], threading.Event()
    wal = folder / "live.db-wal"

    def ask():
        """By bare bytes."""
        stand_behind()
        with socket.create_connection(("127.0.0.1", page.port)) as connection:
            while not stop.is_set():
                connection.sendall(b"GET /api/v1/telemetry?spacecraft=SAT&parameter=V_BUS&bins=1000 "
                                   b"HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n\r\n")
                got = connection.recv(1 << 16)
                while b"\r\n\r\n" not in got:
                    got += connection.recv(1 << 16)
                head, body = got.split(b"\r\n\r\n", 1)
                left = int(head.lower().split(b"content-length:")[1].split(b"\r\n")[0]) - len(body)
                while left > 0:
                    left -= len(connection.recv(1 << 16))
                asked.append(head.split()[1])

    def fly(start):
        """Seconds until all of a flight is archived: a heartbeat would round them."""
        begun = time.monotonic()
        running = subprocess.Popen([*flight, "--start", f"{2020 + start}-01-01"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while running.poll() is None:
            log_bytes.append(wal.stat().st_size)
            time.sleep(0.05)  # poll
        wait_until(lambda: stored() - before >= samples * (start + 1), "all of the flight is stored")
        return time.monotonic() - begun

    with contextlib.closing(sqlite3.connect(f"file:{folder}/live.db?mode=ro", uri=True)) as archive:
        def stored():
            return archive.execute("SELECT sum(samples) FROM series").fetchone()[0]

        samples, before = 0, stored()
        fly(0)
        subprocess.run([build / "service/cli/reident", "status", "--wait", "idle", "--timeout", "120",
                        *endpoint], check=True, stdout=subprocess.DEVNULL)
        samples = stored() - before
        for start, is_viewed in enumerate((False, True, True, False) * FLIGHTS, 1):
            stop.clear()
            viewers = Viewers(page.port, 100) if is_viewed else None
            threads = [threading.Thread(target=ask) for _ in range(4 if is_viewed else 0)]
            used = page.processor_s()
            for thread in threads:
                thread.start()
            if is_viewed:
                wait_until(lambda: page.processor_s() > used + BURST_S, "the burst is used up")
            rates[is_viewed].append(1 / fly(start))
            stop.set()
            for thread in threads:
                thread.join()
            if viewers:
                viewers.stop()
    assert asked and set(asked) <= {b"200", b"503"}, set(asked)
    return {"ingest_ratio": median(rates[True]) / median(rates[False]), "ingest_asked": len(asked),
            "log_mib": max(log_bytes) / 2**20}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path, help="folder that the programs were built in")
    parser.add_argument("--days", type=int, default=365)
    parser.add_argument("--repetitions", type=int, default=30)
    parser.add_argument("--archive", type=Path, help="a year that reident_web_archive made before")
    parser.add_argument("--only", choices=["year", "live"])
    arguments = parser.parse_args()
    figures = {}
    with tempfile.TemporaryDirectory(prefix="reident-web-bench-") as name:
        folder = Path(name)
        if arguments.only != "live":
            figures |= year(arguments.build, folder, arguments.days, arguments.repetitions,
                            arguments.archive)
            figures |= scrape(arguments.build, folder, arguments.repetitions)
        if arguments.only != "year":
            figures |= live(arguments.build, folder, arguments.repetitions)
    figures = {key: round(value, 4) if isinstance(value, float) else value
               for key, value in figures.items()}
    for key, value in figures.items():
        print(f"{key:24} {value}")
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
