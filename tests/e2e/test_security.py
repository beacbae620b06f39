"""A secured domain: who is heard, who decides, what happens when certificates end, and who is not
heard whatever they try."""

import json
import os
import shutil
import subprocess
import unittest
from pathlib import Path

import plant
from harness import DEADLINE_S, EndToEnd, wait_until
from secured_site import Site

BUILD = Path(os.environ["REIDENT_BUILD"])
PARTY = BUILD / "tests/service/dds/domain_party"
LOOPBACK = Path(__file__).resolve().parents[2] / "service/dds/loopback.xml"
TOPICS = ["satcs/TelemetryFrame", "satcs/ParameterDescriptor", "reident/ModelVersion",
          "reident/IdentificationReport", "reident/ModelAcknowledgement", "reident/ServiceStatus",
          "reident/HistoryRequest", "reident/HistoryReply", "reident/Command",
          "reident/CommandReply", "reident/Leadership", "reident/Replica"]
# What the role of the intruders that are simulators may do (service/security/roles.cpp).
MAY_SEE = {"satcs/TelemetryFrame", "satcs/ParameterDescriptor", "reident/ModelVersion"}
MAY_WRITE = {"reident/ModelAcknowledgement"}


class Secured(EndToEnd):
    def setUp(self):
        super().setUp()
        self.site = Site(self.folder / "site")

    def configure_secured(self, member, **changes):
        path = self.configure([plant.equipment(**changes)])
        path.write_text(path.read_text().replace("[dds]", f'[dds]\nsecurity = "{member}"'))
        return path

    def configured(self, *arguments):
        status, text = self.reident(*arguments, "--config", self.folder / "reident.toml")
        return status, text

    def alarms(self):
        return dict(self.query("SELECT code, text FROM alarm_now"))

    def party(self, folder, mark, library=None):
        environment = {**os.environ, "CYCLONEDDS_URI": f"file://{LOOPBACK}"}
        with open(self.folder / f"{mark}.log", "wb") as log:
            process = subprocess.Popen(
                [str(PARTY), str(folder), str(self.domain), self.partition, mark,
                 *([str(library)] if library else [])],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, env=environment,
                text=True)
        self.addCleanup(lambda: process.poll() is None and process.kill())
        self.assertEqual(process.stdout.readline(), "ready\n")
        return process

    def ended(self, process):
        out, _ = process.communicate(timeout=DEADLINE_S)
        return json.loads(out.splitlines()[-1])


class SecuredLoop(Secured):
    def test_telemetry_versions_and_decisions_pass_encrypted(self):
        self.configure_secured(self.site.grant("service", "reident-1"))
        ana = self.site.grant("operator", "ana")
        self.start_daemon()
        simulator = self.start_simulator("trainer", "--security",
                                         self.site.grant("simulator", "trainer"))
        csv = plant.write(self.folder / "rows.csv", plant.rows(count=1900))
        self.replay_all(csv, "--wait-readers", 2, "--security",
                        self.site.grant("gateway", "station"))
        status, text = self.configured("status", "--security", ana, "--wait", "idle", "--timeout",
                                       DEADLINE_S, "--json")
        self.assertEqual(status, 0, text)
        self.assertEqual(json.loads(text)["certificate_days"], 364)
        wait_until(self.champion, "a champion")
        wait_until(lambda: self.champion() in self.runs(simulator), "the simulator runs it")
        # The decision names the certificate, whatever the command line says.
        status, text = self.configured("hold", "PLANT", "--actor", "somebody", "--security", ana)
        self.assertEqual(status, 0, text)
        self.assertEqual(self.query("SELECT actor FROM hold"), [("ana",)])
        status, text = self.configured("--remote", "history", "--security", ana, "--json")
        self.assertEqual(status, 0, text)
        status, text = self.configured("simulators", "--security", ana, "--json")
        self.assertEqual([one["simulator"] for one in json.loads(text)["simulators"]], ["trainer"])

    def test_without_a_certificate_programs_say_that_the_domain_is_secured(self):
        self.configure_secured(self.site.grant("service", "reident-1"))
        self.start_daemon()
        simulator = self.start_simulator("trainer")
        for arguments in (["status", "--timeout", 3], ["simulators"],
                          ["--remote", "history", "--timeout", 3],
                          ["hold", "PLANT", "--timeout", 3]):
            status, text = self.reident(*arguments, *self.endpoint())
            self.assertEqual(status, 2, text)
            self.assertIn("REIDENT_SECURITY", text)
        told = wait_until(simulator.out.read_text, "the simulator says why it has no version")
        event = json.loads(told.splitlines()[0])
        self.assertEqual((event["event"], event["equipment"]), ("unpublished", "PLANT"))
        self.assertIn("REIDENT_SECURITY", event["reason"])

    def test_a_role_that_may_not_order_is_refused(self):
        self.configure_secured(self.site.grant("service", "reident-1"))
        self.start_daemon()
        status, text = self.configured("hold", "PLANT", "--security",
                                       self.site.grant("simulator", "trainer"))
        self.assertEqual(status, 2, text)
        self.assertEqual(self.query("SELECT count(*) FROM hold"), [(0,)])

    def test_a_command_that_nobody_signed_changes_nothing(self):
        self.configure_secured(self.site.grant("service", "reident-1"))
        daemon = self.start_daemon()
        party = self.party(self.site.grant("operator", "ana"), "ana")
        wait_until(lambda: "command: refused" in daemon.text(), "the service heard it")
        self.ended(party)
        self.assertEqual(self.query("SELECT count(*) FROM command"), [(0,)])

    def test_a_folder_that_is_wrong_stops_the_daemon_before_it_joins(self):
        member = self.site.grant("service", "reident-1")
        self.configure_secured(member)
        (member / "permissions.p7s").unlink()
        daemon = self.start("reidentd", "--config", self.folder / "reident.toml")
        self.assertEqual(daemon.wait(), 1)
        self.assertIn(str(member / "permissions.p7s"), daemon.text())
        status, text = self.reident("check-config", self.folder / "reident.toml")
        self.assertEqual(status, 2, text)
        self.assertIn(str(member / "permissions.p7s"), text)

    def test_of_a_pair_one_whose_certificate_has_ended_neither_leads_nor_dies(self):
        path = self.configure_secured(self.site.grant("service", "reident-1", "--valid", "5s"))
        path.write_text(path.read_text().replace("[service]", "[service]\nstandby = true\nstrength = 2"))
        daemon = self.start_daemon()
        wait_until(lambda: "pair: leads no more" in daemon.text(), "it steps down")
        status, text = self.configured("overview", "--json", "--security",
                                       self.site.grant("operator", "ana"))
        self.assertIn("certificate", [one["code"] for one in json.loads(text)["alarms"]])
        self.assertTrue(daemon.running())

    def test_an_ended_certificate_is_an_alarm_and_a_new_one_is_taken_up(self):
        self.configure_secured(self.site.grant("service", "reident-1", "--valid", "20s"))
        ana = self.site.grant("operator", "ana")
        daemon = self.start_daemon()
        wait_until(lambda: "certificate" in self.alarms(), "an alarm before the end")
        before = self.alarms()["certificate"]
        wait_until(lambda: self.alarms()["certificate"] != before, "an alarm at the end")
        self.assertNotIn("alarm: cleared", daemon.text())
        status, text = self.configured("status", "--security", ana, "--timeout", 0.2)
        self.assertEqual(status, 4, text)
        self.assertIn("reident-1/certificate.pem: ended", text)
        self.site.renew("reident-1")
        wait_until(lambda: "certificate" not in self.alarms(), "the alarm is cleared")
        status, text = self.configured("status", "--security", ana, "--timeout", DEADLINE_S)
        self.assertEqual(status, 0, text)
        self.assertTrue(daemon.running())


    def test_nothing_is_lost_when_certificates_change_and_end_while_telemetry_flows(self):
        self.configure_secured(self.site.grant("service", "reident-1", "--valid", "40s"))
        ana = self.site.grant("operator", "ana")
        daemon = self.start_daemon()
        csv = plant.write(self.folder / "rows.csv", plant.rows(count=1200))
        replay = self.replay(csv, "--speed", 20, "--security",
                             self.site.grant("gateway", "station", "--valid", "40s"))
        wait_until(self.stored, "telemetry flows")
        self.site.renew("reident-1")
        self.site.renew("station")
        wait_until(lambda: "took up" in daemon.text() and "took up" in replay.text(), "new files")
        self.assertEqual(replay.wait(deadline_s=150), 0, replay.text())  # 60 s of telemetry
        wait_until(lambda: self.stored() >= 3 * 1200, "the last frame is committed")
        self.assertEqual(self.stored(), 3 * 1200)
        status, text = self.configured("status", "--security", ana, "--timeout", DEADLINE_S)
        self.assertEqual(status, 0, text)

    def test_who_is_revoked_is_not_heard_any_more(self):
        self.configure_secured(self.site.grant("service", "reident-1"))
        ana = self.site.grant("operator", "ana")
        daemon = self.start_daemon()
        shutil.copytree(ana, self.folder / "stolen")
        ask = ["status", "--security", self.folder / "stolen"]
        self.assertEqual(self.configured(*ask, "--timeout", DEADLINE_S)[0], 0)
        self.site.call("revoke", self.site.folder, "ana")
        wait_until(lambda: self.configured(*ask, "--timeout", 3)[0] == 4, "nothing is heard")
        self.assertEqual(daemon.text().count("certificate revoked"), 1, daemon.text())
        status, text = self.configured("status", "--security", ana)
        self.assertEqual(status, 1, text)
        self.assertIn(str(ana / "certificate.pem"), text)


class Intruders(Secured):
    def test_see_nothing_and_reach_nobody(self):
        foreign = Site(self.folder / "foreign")
        simulator = self.site.grant("simulator", "intruder")
        forged = self.folder / "forged"
        subprocess.run([str(PARTY.parent / "forge_permissions"), str(simulator), str(forged)],
                       check=True)
        revoked = self.site.grant("operator", "gone")
        shutil.copytree(revoked, self.folder / "revoked")
        expired = self.site.grant("service", "expired", "--valid", "1s")
        wait_until(lambda: self.reident("security", "check", expired)[0] == 2, "it has ended")
        honest = {role: self.site.grant(role, f"honest-{role}")
                  for role in ("service", "gateway", "simulator", "operator", "page")}
        self.site.call("revoke", self.site.folder, "gone")
        intruders = {
            "none": ("none", None), "foreign": (foreign.grant("service", "reident-1"), None),
            "revoked": (self.folder / "revoked", None), "expired": (expired, None),
            "other_role": (simulator, None), "self_granted": (forged, None),
            "changed_client": (simulator, PARTY.parent / "liblax_access_control.so")}
        others = {role: self.party(folder, role) for role, folder in honest.items()}
        trying = {name: self.party(folder, name, library)
                  for name, (folder, library) in intruders.items()}
        # As long as intruders try: the honest ones have heard 50 samples of each other meanwhile.
        self.assertEqual(others["service"].stdout.readline(), "heard\n")
        table = {name: self.ended(process) for name, process in trying.items()}
        heard = {role: self.ended(process) for role, process in others.items()}
        seen, taken = {}, {}
        for name, found in table.items():
            is_member = name in ("other_role", "changed_client")
            for topic in TOPICS:
                marks = found.get(topic, {}).get("taken", {})
                if not (is_member and topic in MAY_SEE):
                    seen[name, topic] = sum(marks.get(role, 0) for role in honest)
                if not (is_member and topic in MAY_WRITE):
                    taken[name, topic] = sum(one[topic]["taken"].get(name, 0)
                                             for one in heard.values())
        print(json.dumps({"cells": len(table) * len(TOPICS), "intruder_seen": sum(seen.values()),
                          "intruder_taken": sum(taken.values()),
                          "joined": {name: found["joined"] for name, found in table.items()}}))
        self.assertEqual({cell: count for cell, count in seen.items() if count}, {})
        self.assertEqual({cell: count for cell, count in taken.items() if count}, {})
        # The honest ones hear each other all the while, so that silence means refusal ...
        self.assertGreater(heard["simulator"]["reident/ModelVersion"]["taken"]["service"], 10)
        self.assertGreater(heard["service"]["satcs/TelemetryFrame"]["taken"]["gateway"], 10)
        self.assertGreater(heard["service"]["reident/Command"]["taken"]["operator"], 10)
        # ... and members are heard in what their role may.
        for name in ("other_role", "changed_client"):
            self.assertGreater(
                heard["service"]["reident/ModelAcknowledgement"]["taken"].get(name, 0), 0, name)


if __name__ == "__main__":
    unittest.main()
