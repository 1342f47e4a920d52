# SPDX-License-Identifier: Apache-2.0
"""The plans of the headline: files of fpga/headline, and of fpga/headline.toml those that were rejected, the variants that
show something else, and those in coarser formats."""
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from flow.goals import HEADLINE, headline_names
from flow.package import PHOTONLOOM, set_options
from flow.shell import ROOT, Failure, UsageError, field, read_toml, run

VARIANTS = ROOT / "fpga" / "headline.toml"


@dataclass(frozen=True)
class HeadlinePlan:
    """rejected: why it is none of the headline's; "" for one of them, or of the user's. shows: what a variant shows, "" for others.
    finer: the plan of the headline of which it is one in coarser formats, "" for others. clock: MHz that its core is asked for, None for
    the board's default."""
    name: str
    path: Path
    rejected: str = ""
    shows: str = ""
    finer: str = ""
    clock: float | None = None


def clock_of(name: str, variants: Path = VARIANTS) -> float | None:
    """MHz that the core of a plan of this name is asked for, None for the board's default. Every clock must be of a plan, and one."""
    clocks: dict[str, float] = {}
    known = known_names(variants)
    for plan in field(read_toml(variants), variants, "clock", dict, "a table of MHz"):
        if plan not in known:
            raise Failure(f"{variants}: clock.{plan} is of no plan, expected some of {', '.join(known)}")
        clocks[plan] = float(field(read_toml(variants), variants, f"clock.{plan}", (int, float), "MHz of the core"))
        if not 1 <= clocks[plan] <= 400:
            raise Failure(f"{variants}: clock.{plan} is {clocks[plan]:g}, expected 1 to 400 MHz")
    return clocks.get(name)


def names_of(kind: str, variants: Path) -> list[str]:
    return list(field(read_toml(variants), variants, kind, dict, "a table of plans"))


def rejected_names(variants: Path = VARIANTS) -> list[str]:
    return names_of("rejected", variants)


def variant_names(variants: Path = VARIANTS) -> list[str]:
    return names_of("variant", variants)


def coarse_names(variants: Path = VARIANTS) -> list[str]:
    return names_of("coarse", variants)


def what_shows(name: str, variants: Path = VARIANTS) -> str:
    said: str = field(read_toml(variants), variants, f"variant.{name}.shows", str, "what it shows")
    return said


def why_rejected(name: str, variants: Path = VARIANTS) -> str:
    said: str = field(read_toml(variants), variants, f"rejected.{name}.why", str, "why it is not in the headline")
    if not said:  # by which a rejected plan is known
        raise Failure(f"{variants}: rejected.{name}.why is empty, expected why it is not in the headline")
    return said


def base_of(kind: str, name: str, variants: Path = VARIANTS) -> str:
    said: str = field(read_toml(variants), variants, f"{kind}.{name}.base", str, "a plan of fpga/headline")
    if said not in headline_names():
        raise Failure(f"{variants}: {kind}.{name}.base is {said}, expected one of {', '.join(headline_names())}")
    return said


def changes_of(kind: str, name: str, variants: Path = VARIANTS) -> list[str]:
    """The lines in which a plan differs from its base, as options of photonloom have them."""
    said: list[str] = field(read_toml(variants), variants, f"{kind}.{name}.set", list, "a list of strings")
    if not all(isinstance(line, str) for line in said):
        raise Failure(f"{variants}: {kind}.{name}.set is {said}, expected a list of strings")
    return said


def changed_plan(kind: str, name: str, work: Path, variants: Path) -> Path:
    """Writes the plan into `work`: its base with lines that change."""
    base = base_of(kind, name, variants)
    settings = changes_of(kind, name, variants)
    path = work / "plans" / f"{name}.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    run([PHOTONLOOM, "plan", str(HEADLINE / f"{base}.toml"), "-o", str(path)] + set_options(settings))
    return path


def rejected_plan(name: str, work: Path, variants: Path = VARIANTS) -> HeadlinePlan:
    return HeadlinePlan(name, changed_plan("rejected", name, work, variants), why_rejected(name, variants))


def variant_plan(name: str, work: Path, variants: Path = VARIANTS) -> HeadlinePlan:
    return HeadlinePlan(name, changed_plan("variant", name, work, variants), shows=what_shows(name, variants))


def coarse_plan(name: str, work: Path, variants: Path = VARIANTS) -> HeadlinePlan:
    return HeadlinePlan(name, changed_plan("coarse", name, work, variants), finer=base_of("coarse", name, variants))


def known_names(variants: Path = VARIANTS) -> list[str]:
    """Every plan, by which its results are kept: each name stands once."""
    known = headline_names()
    for kind in ("rejected", "variant", "coarse"):
        for name in names_of(kind, variants):
            if name in known:
                raise Failure(f"{variants}: {kind}.{name} is the name of another plan too, expected each name once")
            known.append(name)
    return known


def check_variants(variants: Path = VARIANTS) -> None:
    """That all of the file is as expected; writes no plan, so it can be asked before anything is built."""
    for name in rejected_names(variants):
        why_rejected(name, variants)
    for name in variant_names(variants):
        what_shows(name, variants)
    for kind in ("rejected", "variant", "coarse"):
        for name in names_of(kind, variants):
            base_of(kind, name, variants)
            changes_of(kind, name, variants)
    clock_of("", variants)  # looks at all of them


def check_plan_names(names: Sequence[str]) -> None:
    """That there are such plans, each name once; writes none, so it can be asked before anything is built or fetched."""
    known = known_names()
    called = [name if name in known else Path(name).stem for name in names]
    for name in names:
        if name not in known and not Path(name).is_file():
            raise UsageError(f"{name}: there is no such plan, expected a file or one of {', '.join(known)}")
    if twice := next((name for name in called if called.count(name) > 1), None):
        raise UsageError(f"there are two plans {twice}, expected each name once")


def known_plan(name: str, work: Path) -> HeadlinePlan:
    path = HEADLINE / f"{name}.toml"
    if path.is_file():
        return HeadlinePlan(name, path)
    if name in rejected_names():
        return rejected_plan(name, work)
    return variant_plan(name, work) if name in variant_names() else coarse_plan(name, work)


def find_plan(name: str, work: Path) -> HeadlinePlan:
    """A plan of the headline, a rejected one, a variant, each with the clock that its core is asked for, or one of a file of its
    own, which is judged as one of the headline."""
    path = Path(name)
    if path.is_file() and path.resolve().parent == HEADLINE:
        name = path.stem
    if name in known_names():
        return replace(known_plan(name, work), clock=clock_of(name))
    check_plan_names([name])
    return HeadlinePlan(path.stem, path)


def find_plans(names: Sequence[str], work: Path) -> list[HeadlinePlan]:
    """The named plans, or those of fpga/headline; each of a name of its own, under which results are kept."""
    check_plan_names(names)
    plans = [find_plan(name, work) for name in names or headline_names()]
    if not plans:
        raise Failure("fpga/headline: has no plan")
    return plans
