# SPDX-License-Identifier: Apache-2.0
"""What the model says of itself: numbers by their properties, the search by its definition, and that a difference is told."""
import tempfile
import unittest
from pathlib import Path
from random import Random
from typing import Any

import cdf_sampler
import irradiance_cache
import photon_gatherer
import photon_map
import reorder_buffer
from comparing import Tally, first_difference
from drawing import Widths, gather_queries, map_photons
from numeric import hilbert_index, oct_decode, reciprocal
from plan import Plan
from program import Failure, read_packets, write_packets

SMALL: dict[str, Any] = {
    "photon.position_bits": 6, "photon.direction_bits": 4, "photon.mantissa_bits": 4, "photon.exponent_bits": 2,
    "photon.channels": 1, "photon.bucket": 4, "photon.photon_bytes": 8,
    "photon.lines": "plain", "photon.further_percent": 25, "gather.k": 5, "gather.normal_bits": 4,
    "gather.r2_floor": 1, "gather.epsilon_factor": 1, "gather.epsilon_shift": 0, "gather.leaf_limit": 0,
    "gather.reciprocal_bits": 8, "global.photons": 60, "caustic.photons": 0, "global.radius": 0.0, "sampler.cell_bits": 2, "sampler.probability_bits": 8,
    "sampler.u_bits": 20, "sampler.v_bits": 2, "sampler.combine": "sum", "sampler.levels": 1, "sampler.cosine_samples": 1,
    "reorder.key": "hilbert", "reorder.drain": "sweep", "reorder.packets": 64, "reorder.bins": 64, "reorder.cell_bits": 2,
    "cache.records": 2, "cache.hits": 1, "cache.weight_bits": 4, "cache.angle_bits": 4,
}
QUERY = {"pixel": 0, "sample": 0, "tag": 0, "map": 0, "flush": 0, "want_photons": 1, "position": [0, 0, 0], "normal": [8, 8]}


class Numbers(unittest.TestCase):
    def test_octahedral_codes(self) -> None:
        for bits in range(1, 6):
            codes = [(u, v) for u in range(1 << bits) for v in range(1 << bits)]
            points = [oct_decode(u, v, bits) for u, v in codes]
            self.assertEqual(len(set(points)), len(codes))
            self.assertEqual({abs(x) + abs(y) + abs(z) for x, y, z in points}, {1 << bits})
        self.assertEqual([oct_decode(128, 128, 8), oct_decode(0, 0, 8)], [(1, 1, 254), (-1, -1, -254)])

    def test_hilbert_index(self) -> None:
        for bits in range(1, 5):
            side = range(1 << bits)
            cells = {hilbert_index(x, y, z, bits): (x, y, z) for x in side for y in side for z in side}
            self.assertEqual(sorted(cells), list(range(8**bits)))
            for index in range(8**bits - 1):
                self.assertEqual(sum(abs(a - b) for a, b in zip(cells[index], cells[index + 1])), 1)

    def test_reciprocal(self) -> None:
        self.assertEqual(reciprocal(1, 8), (256, 0))
        self.assertEqual(reciprocal(1 << 20, 18), (1 << 18, 20))
        self.assertEqual(reciprocal(1023, 8), (256, 10))  # the carry of its rounding moves the exponent
        for value in range(1, 3000):
            mantissa, exponent = reciprocal(value, 12)
            self.assertLess(abs(value * mantissa - (1 << 12 + exponent)), value * 3)


class Units(unittest.TestCase):
    plan = Plan(SMALL)

    def test_the_search_is_its_definition(self) -> None:
        """Where it is exact and unlimited; also that the counts of a small map are those of its tree."""
        for seed in range(60):
            random = Random(seed)
            photons = map_photons(random, self.plan, 60)
            built = photon_map.build(self.plan, photons)
            self.assertEqual(sorted(built.addresses), sorted(p.index for line in built.lines for p in line))
            widths = Widths({"gather_query": {"pixel": 1, "sample": 1, "tag": 1}}, {})
            for query in gather_queries(random, self.plan, widths, 20, [photons, []]):
                radius = random.choice((0, 50, 500, 16383))
                found = photon_gatherer.search(self.plan, built, radius, query)
                self.assertEqual(found.found, photon_gatherer.nearest(self.plan, built, radius, query))
                self.assertLessEqual(found.leaves, len(built.lines))

    def test_a_leaf_read_is_the_leaf_written(self) -> None:
        compressed = Plan({**SMALL, "photon.position_bits": 14, "photon.bucket": 8, "photon.photon_bytes": 6,
                           "photon.lines": "compressed", "photon.further_percent": 700})
        for plan in (self.plan, compressed):
            built = photon_map.build(plan, map_photons(Random(3), plan, 59))
            lines = photon_map.memory(plan, built, 1)
            self.assertEqual({len(line) for line in lines}, {plan["photon.bucket"] * plan["photon.photon_bytes"]})
            self.assertEqual(len(lines) > len(built.lines), plan is compressed)
            for line, read in zip(built.lines, photon_map.leaves(plan, lines, len(built.lines))):
                self.assertEqual([(p["position"], p["mantissa"], p["exponent"], p["direction"]) for p in read],
                                 [(list(p.position), list(p.mantissa), p.exponent, list(p.direction)) for p in line])

    def test_a_sweep_is_in_the_order_of_the_curve(self) -> None:
        queries = [QUERY | {"position": [16 * x, 16 * y, 16 * z]} for x in range(4) for y in range(4) for z in range(4)]
        left = reorder_buffer.run(self.plan, [*queries, QUERY | {"flush": 1}])
        self.assertEqual([reorder_buffer.bin_of(self.plan, packet["position"]) for packet in left[:-1]], list(range(64)))
        self.assertEqual(left[-1]["flush"], 1)

    def test_what_a_sampler_ignores(self) -> None:
        header = {"kind": 0, "pixel": 1, "sample": 0, "tag": 0, "normal": [8, 8], "mantissa": [0], "exponent": 0,
                  "direction": [0, 0], "u": 0, "v": [0, 0]}
        photon = header | {"kind": 1, "mantissa": [5], "direction": [7, 7]}
        request = header | {"kind": 2, "u": 99999}
        usual = cdf_sampler.run(self.plan, [header, *[photon] * 5, request])
        self.assertEqual(cdf_sampler.run(self.plan, [photon, request, header, *[photon] * 9, request, photon, request]), usual * 2)
        self.assertNotEqual(cdf_sampler.run(self.plan, [header, request]), usual)

    def test_a_full_tile(self) -> None:
        lookup = {"pixel": 0, "sample": 0, "clear": 0, "insert": 1, "normal": [0, 0, 0], "falloff": 256, "falloff_exponent": 0}
        answers = irradiance_cache.run(self.plan, [lookup | {"position": [10 * i, 0, 0], "clear": int(i == 3)} for i in range(4)])
        self.assertEqual([(a["inserted"], a["full"], a["number"]) for a in answers], [(1, 0, 0), (1, 0, 1), (0, 1, 0), (1, 0, 0)])


class Comparing(unittest.TestCase):
    def test_a_difference_is_told(self) -> None:
        packets: list[dict[str, Any]] = [{"a": 1, "b": [2, 3]}, {"a": 4, "b": [5, 6]}]
        self.assertIsNone(first_difference(packets, packets))
        said = first_difference(packets, [packets[0], {"a": 4, "b": [5, 7]}], [{"q": 0}, {"q": 1}])
        self.assertEqual(said and said.splitlines()[:3],
                         ["packet 1 of 2 differs", "    b: golden [5, 6], model [5, 7]", "  input  {'q': 1}"])
        self.assertEqual(first_difference(packets, packets[:1]), "golden has 2 packets, the model 1")
        self.assertIn("b: golden [2, 3], model absent", first_difference(packets, [{"a": 1}]) or "")
        with self.assertRaisesRegex(Failure, "^u, s: packet 0 of 2 differs"):
            Tally().compare("u", "s", packets, packets[::-1])

    def test_wide_numbers_are_strings(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = Path(folder.name, "packets.jsonl")
        for value, bits, fine in ((1, 53, True), ("1", 53, False), ("1", 54, True), (1, 54, False)):
            write_packets(path, [{"a": [value]}])
            if fine:
                self.assertEqual(read_packets(path, {"a": bits}), [{"a": [1]}])
            else:
                with self.assertRaisesRegex(Failure, ":1: a is "):
                    read_packets(path, {"a": bits})


if __name__ == "__main__":
    unittest.main()
