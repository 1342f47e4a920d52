# SPDX-License-Identifier: Apache-2.0
"""A replay on a verilated board_core: the whole board, from its serial link to its photon memory, asked by the host's own
program over a pseudo-terminal."""
import contextlib
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from flow.headline.data import Replay
from flow.headline.plans import HeadlinePlan
from flow.package import PHOTONLOOM
from flow.shell import ROOT, Failure, complaint, field, read_text, read_toml, run, said_json, say, started

BOARD_SIM = ROOT / "build" / "verilator_tb" / "board_sim"
SPARE_PHOTONS = 16  # a path is stored to its end, so so many fewer are asked for than the map has room for
BUILT_WITHIN = 600  # seconds until the model is there
PASSES = 20


@contextlib.contextmanager
def simulated_board(plan: Path, work: Path, link: Path) -> Iterator[None]:
    """A board behind the pseudo-terminal `link` for as long as it is needed."""
    log, command = link.with_suffix(".log"), [str(BOARD_SIM), str(plan), "--link", str(link), "--work", str(work)]
    with open(log, "w") as out:
        if not BOARD_SIM.is_file():
            raise Failure(f"{BOARD_SIM}: is not there; make board-sim builds it")
        with started(command, out) as running:
            for _ in range(10 * BUILT_WITHIN):
                if link.exists():
                    break
                if running.poll() is not None:
                    raise complaint(command, read_text(log), None)
                time.sleep(0.1)
            else:
                raise Failure(f"{BOARD_SIM}: no board within {BUILT_WITHIN} seconds")
            yield


def replay(plan: HeadlinePlan, digest: str, scene: Path, work: Path) -> Replay:
    """Replays the first queries of a frame, as many as the replayer holds; photonloom compares all results with golden's.
    The frame is the plan's, so its queries are not those of the simulated engine, but of the same kind."""
    photons = field(read_toml(plan.path), plan.path, "global.photons", int, "a number of photons")
    say(f"replays {plan.name} on a simulated board")
    with tempfile.TemporaryDirectory() as folder:
        stored, link = Path(folder, "photons.ply"), Path(folder, "tty")
        run([PHOTONLOOM, "photons", str(scene), "--photons", str(photons - SPARE_PHOTONS), "-o", str(stored)])
        with simulated_board(plan.path, work / "models", link):
            said = said_json([PHOTONLOOM, "board", "replay", str(link), str(scene), "--plan", str(plan.path), "--load-photons",
                              str(stored), "--passes", str(PASSES), "--board-wait", "60", "--json"])
    if said["signature"] != said["golden_signature"]:
        raise Failure(f"{plan.name}: the board's signature is {said['signature']}, expected golden's {said['golden_signature']}")
    if not said["golden_full"]:
        raise Failure(f"{plan.path}: global.radius: none of {said['gathers'] // PASSES} replayed queries has k photons within it, expected a "
                      "radius within which they gather, or 0")
    return {"plan": plan.name, "digest": digest, "queries": said["gathers"] // PASSES, "passes": PASSES,
            "cycles": said["cycles"], "lines_per_gather": said["lines_per_gather"]}
