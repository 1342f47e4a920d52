# SPDX-License-Identifier: Apache-2.0
"""Results kept beside their logs, each with a hash of all that it was made from, so that a page can be written of several runs."""
import dataclasses
import hashlib
import json
from pathlib import Path

from flow.shell import Failure, read_json

from . import sources
from .outcome import Outcome
from .properties import Property
from .report import Result


def _key(root: Path, proved: Property) -> str:
    made_from = hashlib.sha256(repr(proved).encode())
    if proved.method == "gappa":
        made_from.update(repr((proved.step, proved.ranges)).encode())
    for file in [*sources.of(root, proved), sources.bug_file(root, proved)]:
        made_from.update((root / file).read_bytes())
    return made_from.hexdigest()


def keep(root: Path, work: Path, result: Result) -> None:
    planted = dataclasses.asdict(result.planted) if result.planted else None
    (work / result.proved.name).mkdir(parents=True, exist_ok=True)
    kept = {"made_from": _key(root, result.proved), "sound": dataclasses.asdict(result.sound), "planted": planted}
    (work / result.proved.name / "result.json").write_text(json.dumps(kept, indent=1) + "\n")


def read(root: Path, work: Path, proved: Property) -> Result:
    """The kept result of a property; a Failure where there is none of the property, sources and bug as they are now."""
    file = work / proved.name / "result.json"
    if not file.is_file():
        raise Failure(f"{proved.name}: was not run yet (there is no {file})")
    kept = read_json(file)
    if kept["made_from"] != _key(root, proved):
        raise Failure(f"{proved.name}: its sources, its bug or its entry have changed since it was run")
    return Result(proved, Outcome(**kept["sound"]), Outcome(**kept["planted"]) if kept["planted"] else None)
