"""What a service manager learns from reidentd: that it is ready, and that it goes on."""

import ctypes
import os
import socket
import subprocess
import unittest
from pathlib import Path

import plant
from harness import BIN, DEADLINE_S, EndToEnd, wait_until

SEIZE, INTERRUPT, DETACH, ALL_THREADS = 0x4206, 0x4207, 17, 0x40000000
SILENCE_S = 5  # of a watchdog that is fed when both threads came round, as each does every two seconds
LIBC = ctypes.CDLL(None, use_errno=True)


class Held:
    """While it lives, one thread of a process is stopped by the tracer's hand: a thread that hangs."""

    def __init__(self, process, name):
        tasks = Path(f"/proc/{process.process.pid}/task").iterdir()
        self.thread = next(int(task.name) for task in tasks
                           if (task / "comm").read_text().strip() == name)

    def trace(self, request):
        if LIBC.ptrace(request, self.thread, None, None) != 0:
            raise OSError(ctypes.get_errno(), f"ptrace {request:#x}")

    def __enter__(self):
        self.trace(SEIZE)
        self.trace(INTERRUPT)
        os.waitpid(self.thread, ALL_THREADS)

    def __exit__(self, *_):
        self.trace(DETACH)


class Supervision(EndToEnd):
    def setUp(self):
        super().setUp()
        self.manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.addCleanup(self.manager.close)
        self.manager.bind(str(self.folder / "notify"))
        os.environ["NOTIFY_SOCKET"] = str(self.folder / "notify")
        self.addCleanup(os.environ.pop, "NOTIFY_SOCKET")

    def notice(self, timeout_s):
        """The next notice; None when none comes in time."""
        self.manager.settimeout(timeout_s)
        try:
            return self.manager.recv(256).decode()
        except TimeoutError:
            return None

    def falls_silent(self):
        """Notices that were on the way come before the silence."""
        return self.notice(SILENCE_S) is None

    def test_the_watchdog_is_fed_by_the_threads_that_take_and_store_telemetry(self):
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        self.assertEqual(self.notice(DEADLINE_S), "READY=1")
        self.assertEqual(self.notice(DEADLINE_S), "WATCHDOG=1")
        for thread in "archive", "ingest":
            with self.subTest(thread=thread):
                with Held(daemon, thread):
                    wait_until(self.falls_silent, f"a hang of the thread {thread} shows")
                self.assertEqual(self.notice(DEADLINE_S), "WATCHDOG=1", "it goes on again")
        self.assertEqual(daemon.terminate()[0], 0)

    def test_it_goes_on_when_nobody_reads_its_log_any_more(self):
        path = self.configure([plant.equipment()])
        with subprocess.Popen([str(BIN / "reidentd"), "--config", path], stderr=subprocess.PIPE,
                              text=True) as daemon:
            self.addCleanup(lambda: daemon.poll() is None and daemon.kill())
            while "service: started" not in daemon.stderr.readline():
                self.assertIsNone(daemon.poll())
            daemon.stderr.close()
            status, text = self.reident("hold", "PLANT", "--actor", "Ana", *self.endpoint())
            self.assertEqual(status, 0, text)
            status, text = self.reident("status", *self.endpoint())
            self.assertEqual(status, 0, text)
            daemon.terminate()
            self.assertEqual(daemon.wait(DEADLINE_S), 0)

    def test_too_few_files_are_named_with_the_limit(self):
        path = self.configure([plant.equipment()])
        done = subprocess.run(["prlimit", "--nofile=20", str(BIN / "reidentd"), "--config", path],
                              capture_output=True, text=True, timeout=DEADLINE_S, check=False)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("LimitNOFILE", done.stderr)


if __name__ == "__main__":
    unittest.main()
