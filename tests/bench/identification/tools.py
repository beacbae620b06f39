"""The programs that are compared, and the files that pass between them."""

import array
import json
import os
import shutil
import struct
import subprocess


REMEDY = "deploy/install_packages.sh --with-bench installs it"


class ToolFailed(Exception):
    """A program gave no model; the text is what it said."""


def run(command):
    """Standard output of a program; its BLAS has one thread."""
    one_thread = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                          env=one_thread)
    if done.returncode != 0:
        said = (done.stderr.strip() or done.stdout.strip() or f"exit status {done.returncode}")
        raise ToolFailed(said.splitlines()[-1])
    return done.stdout


class Tools:
    """What was built and what is installed; a tool that is not there is None."""

    def __init__(self, build):
        bench = build / "tests/bench/identification"
        self.reident = build / "service/cli/reident"
        self.bench = bench / "reident_identification_bench"
        slicot = bench / "slicot_n4sid"
        self.slicot = slicot if slicot.exists() else None
        self.octave = shutil.which("octave-cli")
        if self.octave:
            try:
                run([self.octave, "--quiet", "--no-init-file", "--eval", "pkg load control"])
            except ToolFailed:
                self.octave = None

    def left_out(self):
        """What the comparison lacks, a sentence each."""
        if not self.slicot:
            yield "SLICOT is left out: slicot_n4sid is not built, which needs libslicot-dev; " + REMEDY
        if not self.octave:
            yield "Octave is left out: it does not load octave-control; " + REMEDY

    def identify(self, *arguments):
        """A mode of reident's program; its JSON."""
        return json.loads(run([self.bench, *arguments]))

    def slicot_identify(self, *arguments):
        return json.loads(run([self.slicot, *arguments]))

    def score(self, samples, model, folder, rows=None, state_rows=None):
        """Free-run error of any tool's model, and its poles. With `state_rows` the initial state
        comes from the first so many rows alone."""
        file = folder / "model.json"
        file.write_text(json.dumps(model))
        return json.loads(run([self.bench, "score", samples, file,
                               *(["--rows", *rows] if rows else []),
                               *(["--state-rows", state_rows] if state_rows else [])]))

    def octave_identify(self, script, csv_file, inputs, order, horizon):
        text = run([self.octave, "--quiet", "--no-init-file", script, csv_file, inputs, order,
                    horizon])
        model = {}
        for line in text.splitlines():
            name, rows, columns, *values = line.split()
            columns = int(columns)
            model[name] = [[float(v) for v in values[r * columns:(r + 1) * columns]]
                           for r in range(int(rows))]
        return model


def write_samples(file, inputs, outputs):
    """The file of samples.hpp from lists of columns."""
    with open(file, "wb") as out:
        out.write(struct.pack("=8sqqq", b"REIDSMP1", len(outputs[0]), len(inputs), len(outputs)))
        for column in inputs + outputs:
            array.array("d", column).tofile(out)


def table(header, rows):
    """Markdown."""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)
