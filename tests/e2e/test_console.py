"""What people expect of the programs: several services, signals, an installation that works."""

import json
import signal
import unittest

import plant
from harness import BIN, DEADLINE_S, EndToEnd, wait_until


class Console(EndToEnd):
    def second_service(self, name, equipment="PLANT"):
        """Another service of the partition, with a database of its own."""
        text = (self.folder / "reident.toml").read_text()
        config = self.folder / f"{name}.toml"
        config.write_text(text.replace("reident.db", f"{name}.db").replace('"PLANT"', f'"{equipment}"')
                          .replace("[service]", f'[service]\nname = "{name}"'))
        service = self.start("reidentd", "--config", config, name=name)
        wait_until(lambda: "service: started" in service.text(), f"{name} has started")
        return service

    def hold(self, *options):
        return self.reident("hold", "SAT/PLANT", "--reason", "test", "--timeout", DEADLINE_S,
                            *self.endpoint(), *options)

    def test_a_service_is_found_whatever_its_name(self):
        self.configure([plant.equipment()])
        self.second_service("flight")
        self.assertEqual(self.hold()[0], 0)
        status, text = self.reident("release", "PLANT", "--config", self.folder / "reident.toml")
        self.assertEqual(status, 0, text)
        status, text = self.reident("--remote", "overview", "--json", *self.endpoint())
        self.assertEqual((status, json.loads(text)["equipment"]), (0, []), text)

    def test_of_two_services_the_one_that_is_meant_has_to_be_named(self):
        self.configure([plant.equipment()])
        self.start_daemon()
        self.second_service("other")
        said = wait_until(lambda: (said := self.reident("status", *self.endpoint())[1]).count(
            "alarm: two_services") == 2 and said, "status shows both, and what is wrong")
        self.assertIn("service other ", said)
        status, text = self.hold()
        self.assertEqual(status, 2, text)
        self.assertIn("2 services are on domain", text)
        self.assertIn("other, reident", text)
        status, text = self.reident("--remote", "history", *self.endpoint())
        self.assertEqual(status, 2, text)
        self.assertEqual(self.hold("--service", "other")[0], 0)
        self.assertEqual(self.query("SELECT count(*) FROM hold")[0][0], 0, "it was the other's")

    def test_a_hangup_reads_the_log_level_again_and_nothing_ends(self):
        path = self.configure([plant.equipment()])
        daemon = self.start_daemon()
        path.write_text(path.read_text().replace('"debug"', '"error"'))
        daemon.signal(signal.SIGHUP)
        wait_until(lambda: "log level read again" in daemon.text(), "it was read")
        before = daemon.text()
        self.replay_rows("first", count=700)
        self.assertEqual(daemon.text(), before, "what is no error is not logged any more")
        path.write_text("[nonsense]\n")
        daemon.signal(signal.SIGHUP)
        wait_until(lambda: "the configuration has mistakes" in daemon.text(), "a mistake is named")
        self.assertEqual(daemon.terminate()[0], 0)


if __name__ == "__main__":
    unittest.main()
