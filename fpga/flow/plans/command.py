# SPDX-License-Identifier: Apache-2.0
"""What a plan costs: synthesizes the units of several plans, routes some of them, and fits the coefficients from which
`photonloom plan` predicts resources. Writes the plans (fpga/plans/), the measurements (fpga/plans.json), the coefficients
(golden/planner/resource_fit.hpp; build again to use them) and docs/fpga-plans.md. What was measured of the same sources
before is kept in build/fpga-plans. With --fit it only fits the committed measurements again, with --check it tells
whether coefficients and page are those of the measurements, and plans those of fpga/plans.toml."""
import argparse
import os

from flow.arguments import check_names, refuse_idle, whole
from flow.jobs import each
from flow.package import UNITS
from flow.plans.catalogue import Catalogue, check_plans, read_catalogue, write_plans
from flow.plans.fit import Fits, fit
from flow.plans.measurements import DATA, WORK, Measurements, check_complete, jobs_of, measure, merge, read_data
from flow.plans.pages import header, page
from flow.shell import ROOT, Failure, UsageError, read_text, say, write_json
from flow.tables import between, replace_between
from flow.tools import find_tools

HEADER = ROOT / "golden" / "planner" / "resource_fit.hpp"
PAGE = ROOT / "docs" / "fpga-plans.md"


def options(catalogue: Catalogue) -> argparse.Namespace:
    p = argparse.ArgumentParser(prog="fpga-plans", description=__doc__)
    p.add_argument("plans", nargs="*", help="measure these alone; without --update nothing is written but build/fpga-plans")
    p.add_argument("--units", help="with plans: these units of them alone, separated by commas")
    p.add_argument("--update", action="store_true",
                   help="with plans: put what was measured in the place of what fpga/plans.json has of them, and fit again")
    p.add_argument("--no-route", action="store_true", help="synthesis alone")
    only = p.add_mutually_exclusive_group()
    only.add_argument("--plans-only", action="store_true", help="write the plans alone")
    only.add_argument("--fit", action="store_true", help="fit the committed measurements again")
    only.add_argument("--check", action="store_true", help="tell whether the fit is that of the committed measurements, and plans those of fpga/plans.toml")
    p.add_argument("--jobs", type=whole(1), help="units at a time (default: one a core)")
    o = p.parse_args()
    if (o.units or o.update) and not o.plans:
        p.error(f"{'--units' if o.units else '--update'} goes with plans")
    if o.update and o.no_route and any(name in catalogue.scenes for name in o.plans):
        p.error("--update takes no Fmax from a scene's plan; leave out --no-route")
    check_names(p, o.plans, catalogue.names(), "plan")
    check_names(p, o.units.split(",") if o.units is not None else [], UNITS, option="--units")
    if o.plans and (o.plans_only or o.fit or o.check):
        p.error("--plans-only, --fit and --check are of all plans, expected none by name")
    if o.plans_only or o.fit or o.check:
        refuse_idle(p, o, ("no_route", "jobs"), "--plans-only" if o.plans_only else "--fit" if o.fit else "--check", "measure")
    if o.no_route and not o.plans:
        p.error("--no-route takes no Fmax, which fpga/plans.json has of scenes' plans; expected plans with it")
    o.jobs = o.jobs or os.cpu_count()
    return o


def measured_now(o: argparse.Namespace, catalogue: Catalogue) -> Measurements | None:
    """Measures, and writes fpga/plans.json; None where it stays as it is."""
    tools = find_tools(catalogue.board)
    WORK.mkdir(parents=True, exist_ok=True)
    if not o.plans:
        write_plans(catalogue)
    jobs = [job for job in jobs_of(catalogue, o.plans) if not o.units or job["unit"] in o.units.split(",")]
    if not jobs:
        raise UsageError(f"--units: none of {', '.join(o.plans)} has {o.units}, expected a unit of one of them")
    measured = each(o.jobs, lambda job: measure(job, catalogue, tools, not o.no_route), jobs)
    if o.plans and not o.update:
        return None
    data: Measurements = {"board": catalogue.board.name, "versions": tools.versions, "measurements": measured}
    if o.update:
        data = read_data(catalogue)
        merge(data, measured, tools.versions)
    write_json(DATA, data)
    return data


def check(catalogue: Catalogue, data: Measurements, fitted: Fits) -> None:
    """Fails where what is committed is not what the measurements give, or a plan not what the catalogue does."""
    if read_text(HEADER) != header(fitted) or between(PAGE, "tables") != page(catalogue, data, fitted):
        raise Failure("golden/planner/resource_fit.hpp or docs/fpga-plans.md is not what fpga/plans.json gives; "
                      "scripts/fpga-plans --fit writes them")
    check_plans(catalogue)
    say("coefficients and page are those of fpga/plans.json, plans those of fpga/plans.toml")


def main() -> int:
    catalogue = read_catalogue()
    o = options(catalogue)
    if o.plans_only:
        write_plans(catalogue)
        return 0
    data = read_data(catalogue) if o.fit or o.check else measured_now(o, catalogue)
    if data is None:
        return 0
    if o.check:
        check_complete(catalogue, data)
    fitted = fit(data["measurements"])
    if o.check:
        check(catalogue, data, fitted)
        return 0
    HEADER.write_text(header(fitted))
    replace_between(PAGE, "tables", page(catalogue, data, fitted))
    for unit, resources in fitted.items():
        say(f"{unit}: largest cross-validated error " +
            ", ".join(f"{r} {100 * f.error:.1f} %" for r, f in resources.items()))
    return 0
