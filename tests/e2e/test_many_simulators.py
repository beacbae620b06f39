"""A hundred simulators on one machine: they find the service, and not each other."""

import json
import unittest

import plant
from harness import EndToEnd, wait_until

EQUIPMENT = [f"PLANT{number}" for number in range(3)]
PORTS = 104  # of simulators of a domain (service/dds/domain.cpp)


class ManySimulators(EndToEnd):
    own_domains = range(1, 11)  # all ports are taken

    def setUp(self):
        super().setUp()
        self.configure([plant.equipment(name=name) for name in EQUIPMENT])

    def start_simulators(self, count):
        return [self.start("reident-simulator", "--spacecraft", "SAT", "--name", f"trainer-{i}",
                           "--json", "--cache", "", *self.endpoint(), name=f"trainer-{i}")
                for i in range(count)]

    def adopted(self, simulator):
        lines = [json.loads(line) for line in simulator.out.read_text().splitlines() if line]
        return {line["equipment"] for line in lines if line["event"] == "adopted"}

    def wait_for_champions(self, simulators):
        wait_until(lambda: all(self.adopted(one) == set(EQUIPMENT) for one in simulators),
                   "every simulator has every champion")

    def test_a_hundred_that_come_late_get_every_champion_and_one_too_many_is_told(self):
        self.start_daemon()
        self.replay_rows("first", count=700)
        simulators = self.start_simulators(PORTS)
        self.wait_for_champions(simulators)
        one_more = self.start_simulator("one-more")
        self.assertEqual(one_more.wait(), 1)
        self.assertIn(f"at most {PORTS} simulators", one_more.text())
        self.assertTrue(all(simulator.running() for simulator in simulators))

    def test_those_that_came_before_the_service_get_every_champion(self):
        simulators = self.start_simulators(30)
        self.start_daemon()
        self.replay_rows("first", count=700)
        self.wait_for_champions(simulators)


if __name__ == "__main__":
    unittest.main()
