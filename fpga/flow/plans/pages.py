# SPDX-License-Identifier: Apache-2.0
"""What is written of measurements and fit: a C++ header for `photonloom plan`, tables for people."""
from collections.abc import Mapping

from flow.plans.catalogue import Catalogue, Variation, line_of
from flow.plans.fit import RESOURCES, TWIN, Fits
from flow.plans.measurements import Measurement, Measurements
from flow.tables import markdown
from flow.tools import nextpnr_version

COLUMNS = {"LUT4": "LUT4", "CCU2C": "CCU2C", "DPR16X4": "DPR16X4", "LUT-eq": "LUT-eq", "FF": "FF", "MULT18X18D": "DSP",
           "DP16KD": "EBR"}


def name_of(unit: str) -> str:
    """A unit's name in C++, which takes it from the list of units."""
    return f"unit_name<{''.join(word.capitalize() for word in unit.split('_'))}>"


def header(fitted: Fits) -> str:
    """golden/planner/resource_fit.hpp."""
    lines = ["// SPDX-License-Identifier: Apache-2.0",
             "// Coefficients of the terms in resources.cpp, written by scripts/fpga-plans from fpga/plans.json.",
             "#pragma once", "", '#include "golden/plan/units.hpp"', "", "// clang-format off", "namespace photonloom {", "",
             "struct ResourceCoefficient {", "  const char *unit, *resource, *term;", "  double coefficient;", "};",
             "inline constexpr ResourceCoefficient kResourceCoefficients[] = {"]
    for unit, resources in fitted.items():
        for resource, f in resources.items():
            for term, value in f.coefficients.items():
                lines.append(f'    {{{name_of(unit)}, "{resource}", "{term}", {value:.6g}}},')
    lines += ["};", "", "struct ResourceError {", "  const char *unit, *resource;",
              "  double error;  // relative, the largest of all plans, each predicted from those not its twins", "};",
              "inline constexpr ResourceError kResourceErrors[] = {"]
    for unit, resources in fitted.items():
        for resource, f in resources.items():
            lines.append(f'    {{{name_of(unit)}, "{resource}", {f.error:.4f}}},')
    return "\n".join(lines + ["};", "", "}  // namespace photonloom", "// clang-format on", ""])


def plan_cells(name: str) -> list[str]:
    """What a plan is, in the cells of its rows."""
    key, caustic = line_of(name, "reorder.key"), line_of(name, "caustic.photons")
    return [f"`{name}`", f"{line_of(name, 'global.photons'):,}" + (f" + {caustic:,}" if caustic else ""),
            str(line_of(name, "gather.k")), str(line_of(name, "photon.position_bits")),
            "none" if key == "none" else f"{key}, {line_of(name, 'reorder.drain')}"]


def by_other_tools(m: Measurement, nextpnr: str) -> bool:
    """Whether the unit's Fmax is of another nextpnr than the table's."""
    return "fmax_mhz" in m and m["placed_by"] != nextpnr


def fmax_cell(m: Measurement, nextpnr: str) -> str:
    return f"{m['fmax_mhz']:.1f}" if "fmax_mhz" in m and m["placed_by"] == nextpnr else "–"


def measured_table(catalogue: Catalogue, data: Measurements) -> str:
    """Units of the scenes' plans, clocks of one version of nextpnr; below it what that leaves out."""
    nextpnr = data["versions"][catalogue.board.family.nextpnr]
    shown = [m for name in catalogue.scenes for m in data["measurements"] if m["plan"] == name]
    rows = [plan_cells(m["plan"]) + [f"`{m['unit']}`"] + [f"{m['resources'][c]:,}" for c in COLUMNS] + [fmax_cell(m, nextpnr)]
            for m in shown]
    text = markdown(rows, ["plan", "photons", "k", "position bits", "reordering", "unit", *COLUMNS.values(), "Fmax, MHz"])
    other = [m for m in shown if by_other_tools(m, nextpnr)]
    if other:
        text += ("\nNot shown are clocks by another nextpnr than that of the table: " +
                 ", ".join(f"`{m['unit']}` of `{m['plan']}` ({nextpnr_version(m['placed_by']) or m['placed_by']})" for m in other) +
                 f". `scripts/fpga-plans {' '.join(dict.fromkeys(m['plan'] for m in other))} --update` measures them again.\n")
    return text


def fit_table(fitted: Fits) -> str:
    """The formulas."""
    rows = []
    for unit, resources in fitted.items():
        for resource, f in resources.items():
            terms = " + ".join(f"{value:.3g} · {term}" for term, value in f.coefficients.items() if value > 0)
            worst = f" (`{f.worst}`)" if f.error else ""
            rows.append([f"`{unit}`", RESOURCES[resource], len(f.points), f"{100 * f.error:.1f} %{worst}", terms or "0"])
    return markdown(rows, ["unit", "resource", "plans", "largest error", "prediction"])


def is_base_of(name: str, variation: Variation, catalogue: Catalogue) -> bool:
    """Whether a plan is the one from which a variation changes lines: by its file, or as the variation that changes none."""
    own = catalogue.variations.get(name)
    return variation.base == f"plans/{name}" or (own is not None and own.base == variation.base and not own.settings)


def changed_cells(name: str, lut_eq: int, measured: Mapping[str, int], catalogue: Catalogue) -> list[str]:
    """The lines of a variation, and what they add to the LUT-equivalents of its base. measured: plan -> LUT-equivalents of the unit."""
    variation = catalogue.variations.get(name)
    if not variation:
        return ["a scene's", "–"]
    base = next((other for other in measured if other != name and is_base_of(other, variation, catalogue)), None)
    lines = ", ".join(f"`{line}`" for line in variation.settings)
    return [f"`{variation.base}`" + (f" with {lines}" if lines else ""), f"{lut_eq - measured[base]:+,} (`{base}`)" if base else "–"]


def points_table(fitted: Fits, catalogue: Catalogue) -> str:
    """Every plan, measured and predicted."""
    rows = []
    for unit, resources in fitted.items():
        of_unit = {point.plan: point.measured for point in resources["lut"].points}
        for points in zip(*(resources[resource].points for resource in RESOURCES)):
            name = points[0].plan
            rows.append([f"`{unit}`", f"`{name}`", *changed_cells(name, of_unit[name], of_unit, catalogue)] +
                        [f"{p.measured:,} / {round(p.predicted):,}" for p in points] +
                        [", ".join(f"`{twin}`" for twin in points[0].twins) or "–"])
    return markdown(rows, ["unit", "plan", "lines", "LUT-eq beside its base", *RESOURCES.values(), "its twins"])


def page(catalogue: Catalogue, data: Measurements, fitted: Fits) -> str:
    """The tables of docs/fpga-plans.md."""
    return ("\n" + measured_table(catalogue, data) + "\nTools: " + "; ".join(data["versions"].values()) +
            ".\n\n## The prediction\n\n" + fit_table(fitted) +
            f"\nMeasured, and predicted from the plans that are not its twins, of which some term differs by more than {100 * TWIN:.0f} %:\n\n" + points_table(fitted, catalogue) + "\n")
