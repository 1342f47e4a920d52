# SPDX-License-Identifier: Apache-2.0
"""Whole images by golden, on one thread and on all, and how much of each is gathers: what a board would take over."""
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from flow.goals import HEADLINE, ImageGoals
from flow.headline.data import FrameTime, ImageTime, Seconds
from flow.package import PHOTONLOOM
from flow.results import median
from flow.shell import ROOT, Failure, field, read_toml, said_json, say

RUNS = 7  # of each scene and number of threads, in turn
# Lines of a plan that make its gathers what they are; the cube, the powers and the radius are the scene's.
LINES = ("photon.position_bits", "photon.direction_bits", "photon.mantissa_bits", "photon.exponent_bits", "photon.bucket",
         "gather.normal_bits", "gather.leaf_limit", "reorder.key", "reorder.drain", "reorder.packets", "reorder.bins",
         "reorder.cell_bits")
ON_A_BOARD = ("photon_gatherer", "reorder_buffer")
NOT_OF_THE_FRAME = "write"  # of the image's files


def render_options(plan: Path, goals: ImageGoals) -> list[str]:
    """Options of `photonloom render` for a frame whose gathers are those of a plan."""
    said = read_toml(plan)
    photons, k = (field(said, plan, name, int, "a count") for name in ("global.photons", "gather.k"))
    lines = [f"{line}={field(said, plan, line, (int, str), 'a value')}" for line in LINES]
    return (["--size", f"{goals.width}x{goals.height}", "--spp", str(goals.spp), "--gather-rays", str(goals.gather_rays),
             "--photons", str(photons), "--caustic-photons", str(photons), "--k", str(k)] +
            [word for line in lines for word in ("--set", line)])


def render(scene: Path, options: Sequence[str], threads: int, folder: Path) -> dict[str, Any]:
    """What `photonloom render --json` says."""
    said: dict[str, Any] = said_json([PHOTONLOOM, "render", str(scene), *options, "--threads", str(threads), "--json", "-o", str(folder / "frame.exr")])
    return said


def parts(said: Mapping[str, Any], clock: str) -> tuple[float, float]:
    """Seconds of the frame, and of those in the units that a board has; clock: wall or cpu."""
    return (sum(phase[clock] for phase in said["phases"] if phase["phase"] != NOT_OF_THE_FRAME),
            sum(said["unit_seconds"][unit][clock] for unit in ON_A_BOARD))


def seconds(values: Sequence[float]) -> Seconds:
    return {"least": min(values), "median": median(values), "most": max(values)}


def frame_time(said: Sequence[Mapping[str, Any]], threads: int) -> FrameTime:
    """Of one thread CPU seconds, which other programs do not change."""
    times = [parts(run, "cpu" if threads == 1 else "wall") for run in said]
    return {"threads": threads, "runs": len(times), "frame": seconds([frame for frame, _ in times]),
            "gathers": seconds([gathers for _, gathers in times]), "host": seconds([frame - gathers for frame, gathers in times])}


def image_time(scene: Path, goals: ImageGoals, one: Sequence[Mapping[str, Any]], every: Sequence[Mapping[str, Any]],
               threads: int, processor: str) -> ImageTime:
    first = one[0]
    if len({said["pixels_sha256"] for said in [*one, *every]}) != 1:
        raise Failure(f"{scene}: its images differ from run to run")
    return {"scene": scene.stem, "plan": goals.plan, "processor": processor, "width": first["width"], "height": first["height"],
            "spp": first["spp"], "gather_rays": first["gather_rays"], "photons": first["photons"],
            "caustic_photons": first["caustic_photons"], "k": first["k"], "queries": first["units"]["photon_gatherer"]["queries"],
            "busy": median([parts(said, "wall")[0] / parts(said, "cpu")[0] for said in one]),
            "one": frame_time(one, 1), "all": frame_time(every, threads)}


def time_images(goals: ImageGoals, processor: str, runs: int = RUNS) -> list[ImageTime]:
    """Scenes and numbers of threads in turn."""
    threads = len(os.sched_getaffinity(0))
    options = render_options(HEADLINE / f"{goals.plan}.toml", goals)
    said: dict[tuple[Path, bool], list[dict[str, Any]]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for turn in range(runs):
            for scene in goals.scenes:
                say(f"renders {scene.relative_to(ROOT)} on one thread and on {threads}, {turn + 1} of {runs}")
                for every in (False, True):
                    said.setdefault((scene, every), []).append(render(scene, options, threads if every else 1, Path(folder)))
    return [image_time(scene, goals, said[scene, False], said[scene, True], threads, processor) for scene in goals.scenes]
