"""Exported versions, read by programs that are not ours: Python's zip, XML and JSON, and Octave.

    check_exports.py WRITE_EXPORTS [OCTAVE]
"""

import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

WRITE_EXPORTS = sys.argv[1]
OCTAVE = sys.argv[2] if len(sys.argv) > 2 else ""
NAMES = ("plain", "derived")


def bits(value):
    return struct.pack(">d", value).hex()


def value_of(digits):
    return struct.unpack(">d", bytes.fromhex(digits))[0]


def simulate(model, inputs):
    """The equations, in plain Python."""

    def times(matrix, vector):
        return [sum(a * b for a, b in zip(row, vector)) for row in matrix]

    state = [0.0] * model["order"]
    for row in inputs:
        change = [u - u0 for u, u0 in zip(row, model["input_offset"])]
        yield [a + b + c for a, b, c in zip(times(model["C"], state), times(model["D"], change),
                                            model["output_offset"])]
        state = [a + b for a, b in zip(times(model["A"], state), times(model["B"], change))]


class Exports(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory(prefix="reident-exports-")
        cls.folder = Path(cls.kept.name)
        subprocess.run([WRITE_EXPORTS, cls.folder], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()

    def version(self, name):
        return json.loads((self.folder / f"{name}.json").read_text(encoding="utf-8"))

    def run_of(self, name):
        return json.loads((self.folder / f"{name}.run.json").read_text())

    def assert_close(self, ours, theirs):
        for row, (a, b) in enumerate(zip(ours, theirs, strict=True)):
            for x, y in zip(a, b, strict=True):
                self.assertLessEqual(abs(x - y), 1e-12 * max(1, abs(y)), f"tick {row}")

    def test_json_is_enough_to_simulate_the_model(self):
        for name in NAMES:
            version, run = self.version(name), self.run_of(name)
            self.assertEqual(version["format"], "reident model version 1")
            self.assertEqual((version["version"], len(version["digest"])), (7, 64))
            self.assertEqual(version["model"]["inputs"][0]["unit"], "A" if name == "plain" else "W")
            self.assert_close(simulate(version["model"], run["inputs"]), run["outputs"])

    def description(self, name, suffix="fmu"):
        with zipfile.ZipFile(self.folder / f"{name}.{suffix}") as fmu:
            self.assertIsNone(fmu.testzip())
            return fmu.namelist(), ElementTree.fromstring(fmu.read("modelDescription.xml"))

    def test_the_fmus_have_every_file_in_its_place(self):
        for suffix, platform in (("fmu", "linux64"), ("fmu3", "x86_64-linux")):
            files, root = self.description("plain", suffix)
            identifier = root.find("CoSimulation").get("modelIdentifier")
            self.assertRegex(identifier, "^[A-Za-z_][A-Za-z0-9_]*$")
            for file in ("modelDescription.xml", "resources/model.txt", "documentation/index.html",
                         "documentation/model.json", f"binaries/{platform}/{identifier}.so",
                         "sources/reident_fmu.c", "sources/fmi2.h", "sources/fmi3.h"):
                self.assertIn(file, files)
            with zipfile.ZipFile(self.folder / f"plain.{suffix}") as fmu:
                ElementTree.fromstring(fmu.read("documentation/index.html").split(b"\n", 1)[1])
                self.assertEqual(json.loads(fmu.read("documentation/model.json")),
                                 self.version("plain"))
                if suffix == "fmu3":
                    root = ElementTree.fromstring(fmu.read("sources/buildDescription.xml"))
            sources = root.findall(".//SourceFile") + root.findall(".//SourceFiles/File")
            self.assertEqual([one.get("name") for one in sources], [f"{identifier}.c"])
            self.assertIn(f"sources/{identifier}.c", files)

    def test_the_model_description_keeps_the_rules_of_fmi_2(self):
        for name in NAMES:
            version = self.version(name)
            _, root = self.description(name)
            self.assertEqual((root.tag, root.get("fmiVersion")), ("fmiModelDescription", "2.0"))
            self.assertEqual(root.get("guid"), version["digest"])
            order = ["CoSimulation", "UnitDefinitions", "LogCategories", "DefaultExperiment",
                     "VendorAnnotations", "ModelVariables", "ModelStructure"]
            self.assertEqual([child.tag for child in root], order)
            step = float(root.find("DefaultExperiment").get("stepSize"))
            self.assertEqual(step, version["model"]["sample_period_s"])
            for flag in ("canHandleVariableCommunicationStepSize", "canGetAndSetFMUstate",
                         "canSerializeFMUstate"):
                self.assertEqual(root.find("CoSimulation").get(flag), "true")
            self.check_variables(version["model"], root)
            self.check_structure(version["model"], root)

    def check_variables(self, model, root):
        variables = root.findall("ModelVariables/ScalarVariable")
        references = [variable.get("valueReference") for variable in variables]
        self.assertEqual(references, [str(i) for i in range(len(variables))])
        names = [variable.get("name") for variable in variables]
        self.assertEqual(len(set(names)), len(names))
        units = [unit.get("name") for unit in root.findall("UnitDefinitions/Unit")]
        self.assertEqual(len(set(units)), len(units))
        offsets = {signal["name"]: offset
                   for signal, offset in zip(model["inputs"], model["input_offset"])}
        stated = {signal["name"]: signal["unit"] for signal in model["inputs"] + model["outputs"]}
        for variable in variables:
            real, name = variable.find("Real"), variable.get("name")
            self.assertEqual(real.get("unit", ""), stated.get(name, ""))
            if real.get("unit"):
                self.assertIn(real.get("unit"), units)
            if variable.get("causality") == "input":
                self.assertIsNone(variable.get("initial"))
                self.assertEqual(float(real.get("start")), offsets.get(name, 1))
            elif variable.get("causality") == "local":
                self.assertEqual((variable.get("initial"), real.get("start")), ("exact", "0"))
            else:
                self.assertEqual(variable.get("causality"), "output")
                self.assertEqual(variable.get("initial"), "calculated")
                self.assertIsNone(real.get("start"))
        self.assertEqual(sum(one.get("causality") == "local" for one in variables), model["order"])

    def check_structure(self, model, root):
        variables = root.findall("ModelVariables/ScalarVariable")
        places = [i for i, one in enumerate(variables, 1) if one.get("causality") == "output"]
        self.assertEqual(len(places), len(model["outputs"]))
        for element in ("Outputs", "InitialUnknowns"):
            unknowns = root.findall(f"ModelStructure/{element}/Unknown")
            self.assertEqual([int(unknown.get("index")) for unknown in unknowns], places)
            kinds = {"input"} if element == "Outputs" else {"input", "local"}
            for unknown in unknowns:
                self.assertEqual({variables[int(place) - 1].get("causality")
                                  for place in unknown.get("dependencies").split()}, kinds)

    def test_the_model_description_of_fmi_3_says_the_same(self):
        for name in NAMES:
            _, two = self.description(name)
            _, three = self.description(name, "fmu3")
            self.assertEqual(three.get("fmiVersion"), "3.0")
            self.assertEqual(three.get("instantiationToken"), two.get("guid"))
            self.assertEqual(three.find("CoSimulation").get("hasEventMode"), "true")
            order = ["CoSimulation", "UnitDefinitions", "LogCategories", "DefaultExperiment",
                     "ModelVariables", "ModelStructure", "Annotations"]
            self.assertEqual([child.tag for child in three], order)
            theirs = [(one.get("name"), one.get("valueReference"), one.get("causality"),
                       one.find("Real").get("unit"), one.find("Real").get("start"))
                      for one in two.findall("ModelVariables/ScalarVariable")]
            ours = [(one.get("name"), one.get("valueReference"), one.get("causality"),
                     one.get("unit"), one.get("start"))
                    for one in three.findall("ModelVariables/Float64")]
            self.assertEqual(ours[:-1], theirs)
            self.assertEqual(ours[-1][2], "independent")
            for ours, theirs in (("Output", "Outputs"), ("InitialUnknown", "InitialUnknowns")):
                self.assertEqual(
                    [(int(one.get("valueReference")) + 1,
                      [int(place) + 1 for place in one.get("dependencies").split()])
                     for one in three.findall(f"ModelStructure/{ours}")],
                    [(int(one.get("index")), [int(place) for place
                                              in one.get("dependencies").split()])
                     for one in two.findall(f"ModelStructure/{theirs}/Unknown")])

    def octave(self, name):
        """What Octave found: {variable: words}, and the outputs of its run."""
        inputs = self.folder / f"{name}.inputs"
        inputs.write_text("\n".join(" ".join(map(repr, row)) for row in self.run_of(name)["inputs"]))
        done = subprocess.run(
            [OCTAVE, "--no-gui", "--no-init-file", "--no-history", "--quiet",
             str(Path(__file__).with_name("read_mat.m")), str(self.folder / f"{name}.mat"),
             str(inputs)], capture_output=True, text=True, timeout=60, check=False,
            env={**os.environ, "HOME": str(self.folder)})
        self.assertEqual(done.returncode, 0, done.stderr)
        found, run = {}, []
        for line in done.stdout.splitlines():
            key, *words = line.split(" ")
            if key == "run":
                run.append([value_of(word) for word in words])
            else:
                found[key] = words
        return found, run

    @unittest.skipUnless(OCTAVE, "there is no Octave here")
    def test_octave_reads_every_number_of_the_matlab_file_to_the_last_bit(self):
        for name in NAMES:
            version, (found, run) = self.version(name), self.octave(name)
            model = version["model"]
            expected = {key: model[key] for key in "ABCDK"}
            expected |= {"u0": [[value] for value in model["input_offset"]],
                         "y0": [[value] for value in model["output_offset"]],
                         "x0": [[0]] * model["order"],
                         "Ts": [[model["sample_period_s"]]], "version": [[7]]}
            if "tracking" in model:
                expected |= {"tracking_state": model["tracking"]["state"],
                             "tracking_integral": model["tracking"]["integral"],
                             "tracking_error_limit": [[value] for value
                                                      in model["tracking"]["error_limit"]]}
            self.assertEqual("tracking" in model, "tracking_state" in found)
            for key, matrix in expected.items():
                size = f"{len(matrix)}x{len(matrix[0]) if matrix else 0}"
                self.assertEqual([word for word in found[key] if word],
                                 [size] + [bits(value) for row in matrix for value in row], key)
            self.check_texts(version, found)
            self.assert_close(run, self.run_of(name)["outputs"])

    def check_texts(self, version, found):
        model = version["model"]
        for key in ("spacecraft", "equipment", "digest", "status", "decided", "decided_by"):
            self.assertEqual(" ".join(found[key]), f"text {version[key]}")
        for side in ("input", "output"):
            for member in ("name", "unit", "expression"):
                if (side, member) == ("output", "expression"):
                    continue
                values = [signal.get(member, "") for signal in model[f"{side}s"]]
                self.assertEqual(" ".join(found[f"{side}_{member}s"]),
                                 f"cells {len(values)}x1 {'|'.join(values)}")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
