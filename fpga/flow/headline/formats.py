# SPDX-License-Identifier: Apache-2.0
"""What a plan's number formats cost an image: golden arithmetic beside reference arithmetic, on the same photons and queries."""
from pathlib import Path

from flow.package import PHOTONLOOM, set_options
from flow.shell import Failure, run, said_json, say

NO_RADIUS = set_options(["global.radius=0", "caustic.radius=0"])


def formats_relmse(plan: Path, scene: Path, folder: Path) -> float:
    """relMSE of the plan's own frame of the scene, with its photons and k, without a radius. Leaves both images in the folder."""
    say(f"renders {scene.stem} in the formats of {plan.stem}")
    images = []
    for arithmetic in ("golden", "reference"):
        images.append(folder / f"{plan.stem}-{arithmetic}.exr")
        run([PHOTONLOOM, "render", str(scene), "--plan", str(plan), *NO_RADIUS, "--arithmetic", arithmetic, "-o", str(images[-1])])
    said = said_json([PHOTONLOOM, "compare", *map(str, images), "--json"])
    if "relmse" not in said:
        raise Failure(f"photonloom compare {images[0]} --json: says no relmse")
    return float(said["relmse"])
