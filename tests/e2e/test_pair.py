"""Two services of a pair: what one decided the other has, and takes over when that is gone."""

import json
import os
import signal
import subprocess
import time
import unittest

import test_web
from harness import wait_until
from pair import PairOfServices, can_make_hosts, make_hosts
from secured_site import Site


class Pair(PairOfServices, test_web.WebCase):
    def setUp(self):
        super().setUp()
        self.configure_pair()

    def secure(self):
        """Every program has a certificate of its own; commands are ana's."""
        site = Site(self.folder / "site")
        for side in 2, 1:
            path = self.folder / f"{side}.toml"
            member = site.grant("service", f"reident-{side}")
            path.write_text(path.read_text().replace("[dds]", f'[dds]\nsecurity = "{member}"'))
        os.environ["REIDENT_SECURITY"] = str(site.grant("operator", "ana"))
        self.addCleanup(os.environ.pop, "REIDENT_SECURITY")
        return site

    def test_the_standby_has_every_row_and_takes_over_when_the_leader_is_killed(self):
        site = self.secure()
        station = "--security", site.grant("gateway", "station")
        self.start_both()
        _, text = self.reident("overview", "--json", "--config", self.folder / "2.toml")
        roles = {"reident-2": ("leads", 2, 0), "reident-1": ("follows", 2, 0)}

        def told(pair):
            return {one["service"]: (one["role"], one["term"], one["lag"]) for one in pair}

        self.assertEqual(told(json.loads(text)["pair"]), roles)
        page = self.start_web(config="1.toml")
        wait_until(lambda: told(self.api("overview")["pair"]) == roles, "the page shows both")
        self.assertEqual([(one["service"], one["pair"]["name"], one["pair"]["role"],
                           one["pair"]["partner"]) for one in self.api("service")["services"]],
                         [("reident-1", "reident", "follows", "reident-2"),
                          ("reident-2", "reident", "leads", "reident-1")])
        metrics = self.request("/metrics")[2].decode()
        for line in ("leads 0", "term 2", "lag_rows 0", "partner_heard 1"):
            name, value = line.split()
            self.assertIn(f'\nreident_pair_{name}{{pair="reident"}} {value}\n', metrics)
        page.terminate()
        simulator = self.start_simulator("trainer", "--security",
                                         site.grant("simulator", "trainer"))
        self.replay_flight("first", 3, *station, count=1300)
        first = self.wait_for_champion(2, [simulator])
        self.assertEqual(first % 2, 0, "the leader's terms are even, and so are its versions")
        self.assert_same_rows()
        self.assertEqual(self.ask(1, "SELECT count(*) FROM telemetry_series"),
                         self.ask(2, "SELECT count(*) FROM telemetry_series"))

        self.sides[2].kill()
        wait_until(lambda: self.leads(1), "the standby leads")
        self.replay_flight("second", 2, *station, count=1900, first=1300, gain=2.0)
        second = self.wait_for_champion(1, [simulator], above=first)
        self.assertEqual(second % 2, 1)

        self.start_side(2)
        wait_until(lambda: self.leads(1, follower=2), "the old leader follows")
        self.assert_same_rows()
        # Another version may have followed by now.
        wait_until(lambda: self.champion_of(2) == self.champion_of(1), "both have the champion")
        self.assertGreaterEqual(self.champion_of(2), second)
        self.assertEqual([one for one in simulator.text().splitlines() if '"refused"' in one], [])

    def test_a_hung_leader_is_replaced_and_follows_when_it_goes_on(self):
        self.start_both()
        simulator = self.start_simulator("trainer")
        self.replay_flight("first", 3, count=1300)
        champion = self.wait_for_champion(2, [simulator])
        self.sides[2].signal(signal.SIGSTOP)
        begin = time.monotonic()
        wait_until(lambda: "pair: leads" in self.sides[1].text(), "the standby leads")
        self.assertLess(time.monotonic() - begin, 3)
        status, text = self.reident("hold", "PLANT", "--actor", "Ana", *self.endpoint())
        self.assertEqual(status, 0, text)
        self.sides[2].signal(signal.SIGCONT)
        wait_until(lambda: self.leads(1, follower=2), "it follows")
        self.assert_same_rows()
        self.assertEqual(self.ask(2, "SELECT actor FROM hold_now"), [("Ana",)])
        self.assertEqual(self.champion_of(2), champion)

    def test_a_leader_that_cannot_write_is_replaced_and_follows_when_it_can(self):
        self.start_both()
        process = str(self.sides[2].process.pid)
        subprocess.run(["prlimit", "--pid", process, "--fsize=4096:unlimited"], check=True)
        self.replay_flight("first", 2, count=1300)
        wait_until(lambda: "pair: leads" in self.sides[1].text(), "the standby leads")
        subprocess.run(["prlimit", "--pid", process, "--fsize=unlimited"], check=True)
        wait_until(lambda: self.leads(1, follower=2), "it follows")
        wait_until(lambda: self.champion_of(1), "the standby decides")
        self.assert_same_rows()
        samples = "SELECT parameter, samples FROM telemetry_series"
        wait_until(lambda: self.ask(1, samples) == self.ask(2, samples), "no sample is missing")

    def test_leadership_is_given_back_by_command_alone(self):
        self.start_both()
        self.sides[2].terminate()
        wait_until(lambda: self.leads(1), "a leader that stops is replaced")
        self.start_side(2)
        wait_until(lambda: self.leads(1, follower=2), "the stronger one follows")
        status, text = self.reident("switch-over", "--actor", "Ana", "--reason", "new disk",
                                    *self.endpoint())
        self.assertEqual(status, 0, text)
        wait_until(lambda: self.leads(2, follower=1), "it leads again")
        self.assert_same_rows()
        self.assertEqual(self.ask(1, "SELECT action, actor, ok FROM command"),
                         [("switch_over", "Ana", 1)])
        [(requester, request)] = self.ask(2, "SELECT requester, request FROM command")
        copy = self.start("repeat_command", *self.endpoint()[1::2], "reident-2", "switch_over",
                          requester, request, "Ana", "new disk")
        self.assertEqual(copy.wait(), 0, copy.text())
        self.assertIn("reident-1 gives leadership", copy.text(), "a copy gets the first reply")
        self.assertTrue(self.leads(2, follower=1), "and does nothing")
        status, text = self.reident("simulators", "--json", *self.endpoint())
        self.assertEqual(json.loads(text)["services"], 1, "one of a pair publishes")
        # One that stands by says who leads.
        status, text = self.reident("hold", "PLANT", "--actor", "Bo", "--service", "reident-1",
                                    *self.endpoint())
        self.assertEqual(status, 2, text)
        self.assertIn("give the command to reident-2", text)
        self.sides[1].kill()
        wait_until(lambda: any("no_standby" in alarm for one in self.statuses().values()
                               for alarm in one["alarms"]), "the leader says that it is alone")
        status, text = self.reident("switch-over", *self.endpoint())
        self.assertEqual(status, 2, text)
        self.assertIn("is not there", text)

    def test_a_service_with_another_history_neither_follows_nor_leads(self):
        config = self.folder / "1.toml"
        paired = config.read_text()
        config.write_text(paired.replace("standby = true\nstrength = 1", 'name = "alone"'))
        self.start_side(1)
        status, text = self.reident("hold", "PLANT", "--actor", "Ana", *self.endpoint())
        self.assertEqual(status, 0, text)
        self.sides[1].terminate()
        config.write_text(paired)
        self.start_side(2)
        wait_until(lambda: self.leads(2), "2 leads")
        self.start_side(1)
        wait_until(lambda: any("cannot_follow" in alarm for alarm in self.alarms_of(1)), "it says so")
        self.start_web(config="2.toml")
        wait_until(lambda: any(alarm["code"] == "cannot_follow" and "reident-1" in alarm["text"]
                               for alarm in self.api("overview")["alarms"]), "and so does the page")
        before = self.ask(1, "SELECT * FROM hold")
        self.sides[2].kill()
        wait_until(lambda: list(self.statuses()) == [1], "it is alone")
        self.assertFalse(self.leads(1))
        self.assertEqual(self.ask(1, "SELECT * FROM hold"), before)

    def test_the_database_of_a_pair_takes_commands_of_its_leader_alone(self):
        self.start_both()
        for side in self.sides.values():
            side.terminate()
        database = ["--database", self.folder / "2.db", "--timeout", 1, *self.endpoint()]
        status, text = self.reident("hold", "PLANT", "--actor", "Ana", *database)
        self.assertEqual(status, 4, text)
        self.assertIn("of a pair", text)
        status, text = self.reident("backfill", "--config", self.folder / "2.toml")
        self.assertEqual(status, 2, text)
        self.assertEqual(self.ask(2, "SELECT count(*) FROM hold"), [(0,)])

    @unittest.skipUnless(can_make_hosts(), "needs root, ip, nft and network namespaces")
    def test_of_two_leaders_of_a_cut_network_the_later_term_wins_and_the_other_stays_visible(self):
        hosts = make_hosts(self)
        for strength in 2, 1:
            self.start_side(strength, host=hosts[strength])
        simulators = {strength: self.start_simulator(f"trainer-{strength}", host=hosts[strength])
                      for strength in hosts}
        wait_until(lambda: self.leads(2, follower=1, host=hosts[1]), "2 leads and 1 follows")
        self.replay_flight("first", 4, host=hosts[2], count=1300)
        shared = self.wait_for_champion(2, simulators.values())
        self.assert_same_rows()

        for host in hosts.values():
            host.cut()
        wait_until(lambda: "pair: leads" in self.sides[1].text(), "both lead")
        champions = {}
        for strength, host in hosts.items():
            self.replay_flight(f"apart-{strength}", 2, host=host, count=1300, first=1300,
                               gain=1.0 + strength)
            champions[strength] = self.wait_for_champion(strength, [simulators[strength]], shared)
        self.assertEqual({strength: number % 2 for strength, number in champions.items()},
                         {2: 0, 1: 1}, "no number is given twice")

        for host in hosts.values():
            host.heal()
        wait_until(lambda: self.leads(1, follower=2, host=hosts[1]), "the later term wins")
        self.assert_same_rows()
        self.assertEqual(self.champion_of(2), champions[1])
        wait_until(lambda: all(self.runs(simulator)[-1] == champions[1]
                               for simulator in simulators.values()), "all run what it decided")
        overruled = self.ask(2, "SELECT service, version FROM overruled_decision "
                                "WHERE kind = 'approve'")
        self.assertIn(("reident-2", champions[2]), overruled)
        wait_until(lambda: any(alarm.startswith("overruled: ")
                               for alarm in self.alarms_of(1, hosts[1])), "an alarm says so")


if __name__ == "__main__":
    unittest.main()
