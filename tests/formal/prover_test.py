# SPDX-License-Identifier: Apache-2.0
"""What the runner of proofs decides by itself: which tables it takes, what counts as a path and what as passed."""
import json
import tempfile
import unittest
from pathlib import Path

from flow.shell import Failure
from prover import engines, paths, properties, report
from prover.properties import Property

ENTRY = """
[[property]]
name = "a"
module = "m"
says = "s"
harness = "h"
method = "{method}"
bug = "b"
{more}
"""


def table(text: str) -> list[Property]:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "properties.toml"
        file.write_text(text)
        return properties.load(file)


class Table(unittest.TestCase):
    def refused(self, text: str, word: str) -> None:
        with self.assertRaisesRegex(Failure, word):
            table(text)

    def test_reads(self) -> None:
        (read,) = table(ENTRY.format(method="bmc", more="depth = 7"))
        self.assertEqual((read.name, read.depth, read.unbounded), ("a", 7, False))

    def test_refuses(self) -> None:
        self.refused("", "found none")
        self.refused(ENTRY.format(method="guess", more=""), "method: expected one of")
        self.refused(ENTRY.format(method="pdr", more="depth = 7"), "depth")
        self.refused(ENTRY.format(method="bmc", more=""), "depth")
        self.refused(ENTRY.format(method="induction", more=""), "depth")
        self.refused(ENTRY.format(method="path", more=""), "paths")
        self.refused(ENTRY.format(method="pdr", more="speed = 1"), "speed: no such key")
        self.refused(ENTRY.format(method="pdr", more="") * 2, "stands twice")


class Paths(unittest.TestCase):
    def leads(self, kind: str) -> bool:
        cell = {"type": kind, "port_directions": {"A": "input", "Y": "output"}, "connections": {"A": [2], "Y": [3]}}
        module = {"cells": {"c": cell}, "netnames": {"a": {"bits": [2]}, "y": {"bits": [3]}}}
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "netlist.json"
            file.write_text(json.dumps({"modules": {"top": module}}))
            return paths.leads(file, "top", "a", "y")

    def test_gates_lead_and_registers_do_not(self) -> None:
        self.assertTrue(self.leads("$_NOT_"))
        self.assertFalse(self.leads("$_DFF_P_"))


class Verdicts(unittest.TestCase):
    def test_only_a_proof_whose_bug_is_refuted_passes(self) -> None:
        (read,) = table(ENTRY.format(method="pdr", more=""))
        holds, fails = engines.Outcome("holds", None, 1.0), engines.Outcome("fails", 3, 1.0)
        undecided = engines.Outcome("undecided", 9, 1.0)
        self.assertTrue(report.Result(read, holds, fails).passed)
        for sound, planted in ((holds, holds), (holds, undecided), (holds, None), (undecided, None), (fails, None)):
            self.assertFalse(report.Result(read, sound, planted).passed)
        self.assertIn("UNDECIDED", report.Result(read, undecided, None).verdict)


if __name__ == "__main__":
    unittest.main()
