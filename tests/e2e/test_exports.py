"""A model that a running service approved, taken elsewhere: its FMU, run by a host in Python."""

import ctypes
import json
import sys
import time
import unittest
import xml.etree.ElementTree as ElementTree
import zipfile

import plant
from harness import EndToEnd

LOGGER = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p,
                          ctypes.c_char_p)


class Callbacks(ctypes.Structure):
    _fields_ = [("logger", LOGGER), ("allocate", ctypes.c_void_p), ("free", ctypes.c_void_p),
                ("finished", ctypes.c_void_p), ("environment", ctypes.c_void_p)]


class Fmu:
    """Runs an unpacked FMU whose inputs come before its outputs."""

    def __init__(self, folder):
        root = ElementTree.parse(folder / "modelDescription.xml").getroot()
        variables = root.findall("ModelVariables/ScalarVariable")
        self.inputs, self.outputs = (
            [int(one.get("valueReference")) for one in variables if one.get("causality") == kind]
            for kind in ("input", "output"))
        self.period = float(root.find("DefaultExperiment").get("stepSize"))
        identifier = root.find("CoSimulation").get("modelIdentifier")
        self.library = ctypes.CDLL(str(folder / "binaries" / "linux64" / f"{identifier}.so"))
        self.messages = []
        self.callbacks = Callbacks(LOGGER(lambda *words: self.messages.append(words[4])))
        self.library.fmi2Instantiate.restype = ctypes.c_void_p
        self.component = ctypes.c_void_p(self.library.fmi2Instantiate(
            b"one", 1, root.get("guid").encode(), (folder / "resources").as_uri().encode(),
            ctypes.byref(self.callbacks), 0, 0))
        if not self.component:
            raise AssertionError(self.messages)
        self.ticks = 0
        self.call("fmi2EnterInitializationMode")
        self.call("fmi2ExitInitializationMode")

    def call(self, function, *arguments):
        status = getattr(self.library, function)(self.component, *arguments)
        if status != 0:
            raise AssertionError(f"{function} gives {status}: {self.messages}")

    def step(self, inputs):
        """The outputs for the inputs of now; then a step of one period."""
        count = len(self.inputs)
        self.call("fmi2SetReal", (ctypes.c_uint * count)(*self.inputs), ctypes.c_size_t(count),
                  (ctypes.c_double * count)(*inputs))
        count = len(self.outputs)
        values = (ctypes.c_double * count)()
        self.call("fmi2GetReal", (ctypes.c_uint * count)(*self.outputs), ctypes.c_size_t(count),
                  values)
        self.call("fmi2DoStep", ctypes.c_double(self.ticks * self.period),
                  ctypes.c_double(self.period), 0)
        self.ticks += 1
        return list(values)


def simulate(model, rows, start=None):
    def times(matrix, vector):
        return [sum(a * b for a, b in zip(row, vector)) for row in matrix]

    state = start or [0.0] * model["order"]
    for row in rows:
        change = [u - u0 for u, u0 in zip(row, model["input_offset"])]
        yield [a + b + c for a, b, c in zip(times(model["C"], state), times(model["D"], change),
                                            model["output_offset"])]
        state = [a + b for a, b in zip(times(model["A"], state), times(model["B"], change))]


class ExportsEndToEnd(EndToEnd):
    def test_the_champion_runs_as_an_fmu_while_the_service_goes_on(self):
        self.configure([plant.equipment()])
        self.start_daemon()
        self.replay_rows("real", count=1900)
        self.assertIsNotNone(self.champion())
        fmu, text = self.folder / "a.fmu", self.folder / "a.json"
        status, said = self.reident("export-model", "SAT/PLANT", "--fmu", fmu, "--json", text,
                                    "--mat", self.folder / "a.mat", "--database", self.database)
        self.assertEqual(status, 0, said)
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(self.folder / "unpacked")
        version = json.loads(text.read_text())
        self.assertEqual((version["version"], version["status"]), (self.champion(), "approved"))
        model = version["model"]
        rows = [[u0 + ((7 * k + i) % 11) / 5 for i, u0 in enumerate(model["input_offset"])]
                for k in range(200)]
        running = Fmu(self.folder / "unpacked")
        for row, expected in zip(rows, simulate(model, rows)):
            for ours, theirs in zip(running.step(row), expected, strict=True):
                self.assertLessEqual(abs(ours - theirs), 1e-12 * max(1, abs(theirs)))
        self.begins_where_telemetry_is(model)
        self.assertTrue(all(process.running() for process in self.processes
                            if process.log.stem.startswith("reidentd")))

    def begins_where_telemetry_is(self, model):
        """The state of a row in the middle of the telemetry, where the plant is far from rest."""
        first = 1000
        text = self.folder / "at.json"
        status, said = self.reident(
            "export-model", "SAT/PLANT", "--json", text, "--fmu3", self.folder / "at.fmu",
            "--at", "2019-01-01T00:00:00Z", "--database", self.database)
        self.assertEqual(status, 2, said)  # there is no telemetry before it
        self.assertFalse(text.exists())
        at = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(plant.START_S + first))
        status, said = self.reident(
            "export-model", "SAT/PLANT", "--json", text, "--fmu3", self.folder / "at.fmu",
            "--at", at, "--database", self.database)
        self.assertEqual(status, 0, said)
        self.assertIn(at, said)
        start = json.loads(text.read_text())["start"]
        self.assertEqual((start["time"], len(start["state"])), (at, model["order"]))
        rows = list(plant.rows(1900))[first:first + 20]
        inputs, measured = [row[1:3] for row in rows], [row[3] for row in rows]

        def worst(state):
            return max(abs(y[0] - expected)
                       for y, expected in zip(simulate(model, inputs, state), measured))

        self.assertLess(worst(start["state"]), 0.1)  # the noise is 0.01
        self.assertGreater(worst([0.0] * model["order"]), 0.3)


if __name__ == "__main__":
    sys.exit(unittest.main())
