# SPDX-License-Identifier: Apache-2.0
"""formal [NAME...]: proves the properties of tests/formal/properties.toml, all or those named, and refutes each one's planted
bug. Status 0 only where every property holds and every bug is refuted; one that is undecided at its limit passes not."""
import argparse
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from flow.arguments import positive, whole
from flow.shell import ROOT, Failure, UsageError, say

from . import elastic, engines, golden, kept, properties, report, sources, steps, tools
from .outcome import Outcome
from .properties import Property
from .report import Result

TABLE = Path("tests/formal/properties.toml")
PAGE = Path("docs/formal.md")
STEPS_PAGE = Path("docs/error-analysis.md")


def check(found: tools.Tools, proved: Property, work: Path, limit: float) -> Result:
    """A result in any case: a tool that refuses is one property's failure, not the others' end."""
    try:
        return _check(found, proved, work, limit)
    except Failure as failure:
        return Result(proved, Outcome("error", 0, 0.0, str(failure)), None)


def _check(found: tools.Tools, proved: Property, work: Path, limit: float) -> Result:
    files = sources.of(ROOT, proved)
    sound_work = work / proved.name
    planted_work = work / proved.name / "planted"
    planted_work.mkdir(parents=True, exist_ok=True)
    for folder in (sound_work, planted_work):
        (folder / "log").unlink(missing_ok=True)
    sound = engines.prove(found, ROOT, proved, files, sound_work, limit)
    if sound.verdict != "holds":
        return Result(proved, sound, None)
    copies = planted_work / "sources"
    sources.plant(ROOT, proved, files, copies)
    return Result(proved, sound, engines.refute(found, copies, proved, files, planted_work, limit))


def main() -> int:
    parser = argparse.ArgumentParser(prog="formal", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="properties by name, all without one")
    parser.add_argument("-j", "--jobs", type=whole(1), default=2, help="proofs at a time (default 2)")
    parser.add_argument("--limit", type=positive, default=600.0, help="seconds of the processor until a property counts as undecided (default 600)")
    parser.add_argument("--quick", action="store_true", help="only the properties marked quick, in a few seconds")
    parser.add_argument("--page", action="store_true", help=f"prove nothing: write the last results of all, or the rows of those named, into {PAGE}; of bounds into {STEPS_PAGE} too")
    parser.add_argument("--check", action="store_true", help="prove nothing: tell whether sources are there, planted bugs apply and the page has a row of each property")
    parser.add_argument("--golden", type=Path, metavar="PROGRAM",
                        help="prove nothing: hold the scripts of the bounds against the values of golden that this program prints")
    parser.add_argument("--list", action="store_true", help="print the table's names and what they say")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "formal", help="where models and logs go (default build/formal)")
    arguments = parser.parse_args()

    table = chosen = properties.load(ROOT / TABLE)
    unknown = sorted(set(arguments.names) - {proved.name for proved in chosen})
    if unknown:
        raise UsageError(f"{unknown[0]}: no such property in {TABLE}")
    if arguments.page and arguments.quick:
        raise UsageError("--page: wants the whole table, or properties by name")
    bounds = steps.read(ROOT / sources.BOUNDS)
    steps.check(bounds, table)
    modules = elastic.rows(elastic.elastic(ROOT), elastic.unproved(ROOT), chosen)
    if arguments.names:
        chosen = [proved for proved in chosen if proved.name in arguments.names]
    if arguments.quick:
        chosen = [proved for proved in chosen if proved.quick]
    if arguments.list:
        for proved in chosen:
            print(f"{proved.name:<32} {proved.says}")
        return 0

    if arguments.page:
        report.write_page(ROOT / PAGE, [kept.read(ROOT, arguments.work, proved) for proved in chosen], table,
                          whole=not arguments.names)
        if any(proved.method == "gappa" for proved in chosen):
            report.write_steps(ROOT / STEPS_PAGE, bounds,
                               [kept.read(ROOT, arguments.work, proved) for proved in table if proved.method == "gappa"])
        report.write_modules(ROOT / PAGE, modules)
        return 0
    if arguments.check:
        for proved in chosen:
            sources.plant(ROOT, proved, sources.of(ROOT, proved), arguments.work / "sources")
        report.check_page(ROOT / PAGE, table)
        say(f"{len(chosen)} properties, each with its sources and a bug that applies; each module that words go through is named or has a reason; "
            f"{PAGE} has a row of each")
        return 0

    if arguments.golden:
        printed = golden.values(arguments.golden)
        chosen = [proved for proved in chosen if proved.method == "gappa"]
        compared = sum(golden.check(ROOT, proved, printed, arguments.work / "sources") for proved in chosen)
        say(f"{len(chosen)} scripts of bounds give golden's numbers at {compared} inputs, and with their bugs do not")
        return 0

    found = tools.find(ROOT, {proved.method for proved in chosen})
    print(report.heading(), flush=True)
    results = []
    with ThreadPoolExecutor(max_workers=arguments.jobs) as pool:
        for result in pool.map(lambda proved: check(found, proved, arguments.work, arguments.limit), chosen):
            print(report.line(result), flush=True)
            kept.keep(ROOT, arguments.work, result)
            results.append(result)
    failed = [result for result in results if not result.passed]
    unbounded = sum(result.proved.unbounded for result in results if result.passed)
    say(f"{len(results) - len(failed)} of {len(results)} properties hold, {unbounded} without a bound, each with its planted bug refuted")
    if failed:
        print(f"formal: {', '.join(result.proved.name for result in failed)}: logs in {arguments.work}/NAME", file=sys.stderr)
    return 1 if failed else 0
