"""What an installation brings in addition to the programs: units, users, a configuration."""

import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

import helm_chart
import plant
import yaml
from harness import DEADLINE_S, EndToEnd

BUILD = os.environ["REIDENT_BUILD"]
UNITS = ["reidentd.service", "reidentd@.service", "reident-web.service"]
MOST_EXPOSURE = 1.5
CONTAINER = Path(__file__).resolve().parents[2] / "deploy/container"


class Deploy(EndToEnd):
    def setUp(self):
        super().setUp()
        self.prefix = self.folder / "opt"
        for component in "reident", "reident_web":
            self.output("cmake", "--install", BUILD, "--prefix", self.prefix, "--component",
                        component)
        self.units = self.prefix / "lib/systemd/system"

    def output(self, *words):
        done = subprocess.run([*map(str, words)], capture_output=True, text=True, check=False,
                              timeout=DEADLINE_S)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_the_installed_units_name_the_installed_programs(self):
        for unit in UNITS:
            text = (self.units / unit).read_text()
            programs = re.findall(r"(?m)^Exec(?:Start|StartPre)=(\S+)", text)
            self.assertTrue(programs)
            for program in programs:
                self.assertTrue(program.startswith(f"{self.prefix}/bin/"), program)
                self.output(program, "--version")

    @unittest.skipUnless(shutil.which("systemd-analyze"), "systemd-analyze is not there")
    def test_the_units_leave_little_exposed(self):
        for unit in UNITS:
            text = self.output("systemd-analyze", "security", "--offline=yes", "--no-pager",
                               self.units / unit)
            exposure = float(re.search(r"exposure level for \S+: ([\d.]+)", text)[1])
            self.assertLessEqual(exposure, MOST_EXPOSURE, unit)


class Chart(EndToEnd):
    def objects(self, table):
        """What Helm makes of the chart with the values of a site's table, by kind and name."""
        (self.folder / "fleet.toml").write_text(
            f'[fleet]\nconfiguration = "{self.configure([plant.equipment()])}"\n{table}')
        values = self.folder / "site.json"
        status, text = self.reident("fleet", "init", self.folder / "fleet.toml", "--helm", values)
        self.assertEqual(status, 0, text)
        chart = CONTAINER / "chart"
        self.assertLessEqual({"apiVersion", "name", "version"},
                             set(yaml.safe_load((chart / "Chart.yaml").read_text())))
        text = helm_chart.rendered((chart / "templates/spacecraft.yaml").read_text(),
                                   {**yaml.safe_load((chart / "values.yaml").read_text()),
                                    **yaml.safe_load(values.read_text())})
        return {(one["kind"], one["metadata"]["name"]): one for one in yaml.safe_load_all(text) if one}

    def test_a_spacecraft_gets_the_pod_of_the_manifest(self):
        objects = self.objects('[[spacecraft]]\nname = "SAT-1"\nmemory_max = "2G"\n'
                               'cpu_quota = "50%"\n[[spacecraft]]\nname = "SAT_2"\n')
        self.assertEqual(set(objects), {(kind, f"reident-sat-{number}") for number in (1, 2)
                                        for kind in ("ConfigMap", "StatefulSet")})
        configuration = self.folder / "SAT-1.toml"
        configuration.write_text(objects["ConfigMap", "reident-sat-1"]["data"]["reident.toml"])
        status, text = self.reident("check-config", configuration, "--json")
        self.assertEqual(status, 0, text)
        made = objects["StatefulSet", "reident-sat-1"]
        told = yaml.safe_load((CONTAINER / "reident.yaml").read_text())
        pod, manifest = (one["spec"]["template"]["spec"] for one in (made, told))
        # What is of the spacecraft; all else is the manifest's.
        service = pod["containers"][0]
        self.assertEqual(service["resources"].pop("limits"), {"cpu": "500m", "memory": "2Gi"})
        del service["resources"]
        del manifest["containers"][0]["resources"]
        for container, other in zip(pod["containers"], manifest["containers"]):
            mounts = {one["name"]: one["mountPath"] for one in container.pop("volumeMounts")}
            self.assertEqual(mounts, {
                **{one["name"]: one["mountPath"] for one in other.pop("volumeMounts")},
                "database": "/var/lib/reident/SAT-1"})
        self.assertEqual(pod["volumes"][0]["configMap"].pop("name"), "reident-sat-1")
        del manifest["volumes"][0]["configMap"]["name"]
        self.assertEqual(pod, manifest)
        self.assertEqual(made["spec"]["volumeClaimTemplates"], told["spec"]["volumeClaimTemplates"])

    def test_services_of_a_network_have_their_node_and_their_ports(self):
        objects = self.objects('[fleet.network]\nhost = "10.0.0.1"\n[[spacecraft]]\nname = "SAT-1"\n')
        pod = objects["StatefulSet", "reident-sat-1"]["spec"]["template"]["spec"]
        self.assertTrue(pod["hostNetwork"])
        self.assertEqual(pod["nodeSelector"], {"reident/host": "10.0.0.1"})
        self.assertEqual(len(pod["containers"]), 1, "pages would share the node's port")
        files = objects["ConfigMap", "reident-sat-1"]["data"]
        for file, index in ("cyclonedds.xml", "0"), ("clients.xml", "none"):
            self.assertIn(f"<ParticipantIndex>{index}</ParticipantIndex>", files[file])
        self.assertIn("CYCLONEDDS_URI=file:///etc/reident/clients.xml",
                      pod["containers"][0]["livenessProbe"]["exec"]["command"])

    def test_what_kubernetes_cannot_name_is_refused(self):
        table = self.folder / "fleet.toml"
        for names in ("SAT-1", "sat_1"), ("-SAT",), ("S" * 41,):
            table.write_text(f'[fleet]\nconfiguration = "{self.configure([plant.equipment()])}"\n' + "".join(
                f'[[spacecraft]]\nname = "{name}"\n' for name in names))
            status, text = self.reident("fleet", "init", table, "--helm", self.folder / "site.json")
            self.assertEqual(status, 2, text)
            self.assertIn(names[-1], text)
            self.assertFalse((self.folder / "site.json").exists())


if __name__ == "__main__":
    unittest.main()
