"""A site with more services on a machine than the built-in configuration of DDS has ports for services."""

import json
import re
import unittest
import urllib.request

import pair
import plant
from harness import EndToEnd, wait_until

SERVICES = 18


class Fleet(EndToEnd):
    own_domains = range(11, 31)  # ports of these services are given

    def setUp(self):
        super().setUp()
        self.names = [f"SAT-{number}" for number in range(1, SERVICES + 1)]
        self.configure([plant.equipment(bias="approve", baseline_mrse=50.0)])
        table = self.folder / "fleet.toml"
        table.write_text(f'''[fleet]
configuration = "reident.toml"
domain = {self.domain}
partition = "{self.partition}/{{}}"
data = "{self.folder}/data/{{}}"
[fleet.network]
host = "127.0.0.1"
''' + "".join(f'[[spacecraft]]\nname = "{name}"\n' for name in self.names) +
                         'page = "127.0.0.1:8480"\n')  # of the last one
        status, text = self.reident("fleet", "init", table, "--root", self.folder)
        self.assertEqual(status, 0, text)
        self.configurations = self.folder / "etc/reident"

    def middleware(self, name):
        return self.configurations / "cyclonedds" / f"{name}.xml"

    def serve(self, name):
        (self.folder / "data" / name).mkdir(parents=True)
        return self.start("reidentd", "--config", self.configurations / f"{name}.toml", name=name,
                          middleware=self.middleware(name))

    def status(self):
        code, text = self.reident("fleet", "status", self.configurations, "--json")
        return code, json.loads(text)["instances"]

    def replay(self, name):
        csv = self.folder / "rows.csv"
        if not csv.exists():
            plant.write(csv, plant.rows(2400))
        replay = self.start("satcs-replay", csv, "--spacecraft", name, "--speed", "max", "--domain",
                            self.domain, "--partition", f"{self.partition}/{name}",
                            middleware=self.middleware("gateway-1"))
        self.assertEqual(replay.wait(), 0, replay.text())

    def test_eighteen_services_and_a_simulator_of_two_spacecraft(self):
        services = {name: self.serve(name) for name in self.names}
        wait_until(lambda: all(one["service"] for one in self.status()[1]), "all run")
        self.assertEqual(len(self.status()[1]), SERVICES)
        simulator = self.start("reident-simulator", "--spacecraft", "SAT-*", "--equipment", "PLANT",
                               "--name", "trainer", "--json", "--cache", self.folder / "cache",
                               "--domain", self.domain, "--partition", f"{self.partition}/*",
                               middleware=self.middleware("clients"))
        asked = ["SAT-1", f"SAT-{SERVICES}"]
        for name in asked:
            self.replay(name)

        def adopted():
            events = [json.loads(line) for line in simulator.out.read_text().splitlines() if line]
            return {one["spacecraft"] for one in events if one.get("event") == "adopted"}

        wait_until(lambda: adopted() == set(asked), "it runs the models of both")
        for name in asked:
            wait_until(lambda: self.acknowledged(name), f"the service of {name} has heard of it")
        for name in asked:
            self.assertEqual(self.simulators(name), [("trainer", name, "current")])
        code, instances = self.status()
        self.assertEqual({one["instance"] for one in instances if one["with_champion"]}, set(asked))

        services["SAT-7"].kill()
        code, instances = self.status()
        self.assertEqual(code, 1)
        self.assertEqual((instances[0]["instance"], instances[0]["service"]), ("SAT-7", False))
        code, text = self.reident("overview", "--fleet", self.configurations, "--json")
        overview = json.loads(text)
        self.assertEqual(code, 1)
        self.assertEqual({one["spacecraft"] for one in overview["equipment"]}, set(self.names))
        self.assertIn("no_service", [one["code"] for one in overview["alarms"]])

    def test_a_page_shows_all_of_them(self):
        services = {name: self.serve(name) for name in self.names[-2:]}
        wait_until(lambda: sum(one["service"] for one in self.status()[1]) == 2, "two run")
        web = self.start("reident-web", "--config",
                         self.configurations / f"{self.names[-1]}.toml", "--port", 0, "--fleet",
                         self.configurations, middleware=self.middleware(f"{self.names[-1]}-clients"))
        wait_until(lambda: "url=" in web.text() or not web.running(), "the page is served")
        url = re.search(r"url=(\S*/)", web.text())[1]

        def rows():
            with urllib.request.urlopen(url + "api/v1/fleet") as answer:
                return {one["instance"]: one for one in json.load(answer)["instances"]}

        self.assertEqual({name for name, one in rows().items() if one["service"]}, set(services))
        self.assertEqual({name: one["page"] for name, one in rows().items() if one["page"]},
                         {self.names[-1]: "127.0.0.1:8480"})
        services[self.names[-2]].kill()
        wait_until(lambda: not rows()[self.names[-2]]["service"], "a service that ended is seen")
        self.assertIn("stopped", rows()[self.names[-2]]["note"])

    def acknowledged(self, name):
        status, text = self.reident("overview", "--json", "--config",
                                    self.configurations / f"{name}.toml")
        return json.loads(text)["equipment"][0]["simulators_current"] == 1

    def simulators(self, name):
        """As an operator sees them who names nothing but the service's configuration."""
        status, text = self.reident("simulators", "--json", "--config",
                                    self.configurations / f"{name}.toml")
        self.assertEqual(status, 0, text)
        return [(one["simulator"], one["spacecraft"], one["state"])
                for one in json.loads(text)["simulators"]]


@unittest.skipUnless(pair.can_make_hosts(), "needs root, ip, nft and network namespaces")
class FleetOfTwoMachines(EndToEnd):
    def test_the_standby_of_the_table_takes_over(self):
        hosts = pair.make_hosts(self)
        self.configure([plant.equipment()])
        table = self.folder / "fleet.toml"
        table.write_text(f'''[fleet]
configuration = "reident.toml"
data = "{self.folder}/data/{{}}"
standby = "{hosts[1].address}"
[fleet.network]
host = "{hosts[2].address}"
[[spacecraft]]
name = "SAT-1"
''')
        services, folder = {}, self.folder / "etc/reident"
        for strength, name in (2, "SAT-1"), (1, "SAT-1-standby"):
            host = hosts[strength]
            status, text = self.reident("fleet", "init", table, "--root", self.folder, "--host",
                                        host.address)
            self.assertEqual(status, 0, text)
            config = folder / f"{name}.toml"
            # The folders of two machines are one here.
            config.write_text(config.read_text().replace("data/SAT-1", f"data/{name}"))
            (self.folder / "data" / name).mkdir(parents=True)
            host.uri = f"file://{folder}/cyclonedds/{name}.xml"
            services[strength] = self.start("reidentd", "--config", config, name=name, host=host)
        hosts[1].uri = f"file://{folder}/cyclonedds/SAT-1-clients.xml"

        def roles():
            status, text = self.reident("status", "--json", "--config", folder / "SAT-1.toml",
                                        host=hosts[1])
            first = json.loads(text) if status == 0 else {"service": "", "others": []}
            return {one["service"]: one["pair"]["role"] for one in [first, *first["others"]]
                    if "pair" in one}

        wait_until(lambda: roles() == {"SAT-1-2": "leads", "SAT-1-1": "follows"}, "it is a pair")
        services[2].kill()
        wait_until(lambda: roles().get("SAT-1-1") == "leads", "the standby leads")


if __name__ == "__main__":
    unittest.main()
