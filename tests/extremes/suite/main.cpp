// SPDX-License-Identifier: Apache-2.0
// extremes [--rtl] [--slow] [--case TEXT] [--page FILE]: runs the suite and prints its table;
// --steps the bounds of golden's arithmetic, --stability the error against every width. Exit status
// 0 when all held.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>

#include "golden/numeric/output_file.hpp"
#include "tests/extremes/suite/stability.hpp"
#include "tests/extremes/suite/steps.hpp"
#include "tests/extremes/suite/suite.hpp"

using namespace photonloom;
using namespace photonloom::extremes;

namespace {

const char* known_text(Known known) {
  switch (known) {
    case Known::kClosedForm:
      return "closed form";
    case Known::kDefinition:
      return "definition";
    case Known::kReference:
      return "reference";
    case Known::kSaturation:
      return "saturation, counted";
    case Known::kRefusal:
      return "refusal";
  }
  return "";
}

std::string cell(std::string text) {
  for (size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
    text.insert(at, "\\");
  for (char& c : text)
    if (c == '\n') c = ' ';
  return text.size() > 200 ? text.substr(0, 200) + " ..." : text;
}

struct Totals {
  uint64_t cases = 0, held = 0, checks = 0, rtl_cases = 0, rtl_packets = 0, differences = 0;
};

// Puts each text between the page's lines <!-- mark --> and <!-- end of mark -->.
void write_page(const std::string& page,
                const std::vector<std::pair<std::string, std::string>>& marks) {
  if (page.empty()) return;
  std::string text = read_file(page);
  for (const auto& [mark, body] : marks) {
    const std::string begin = "<!-- " + mark + " -->\n", end = "<!-- end of " + mark + " -->";
    const size_t from = text.find(begin), to = text.find(end);
    if (from == std::string::npos || to == std::string::npos)
      throw std::runtime_error(page + ": expected the lines " + begin + end);
    text.replace(from + begin.size(), to - from - begin.size(), body);
  }
  write_file(page, text);
}

int run_steps(const std::string& page) {
  std::string table =
      "| step | computes | bound | at | measured | of the bound |\n|---|---|---|---|---|---|\n";
  int steps = 0, tight = 0, missed = 0, exact = 0;
  for (const Step& step : arithmetic_steps()) {
    bool is_tight = true, is_exact = true;
    std::string at, measured, part;
    for (const StepError& e : step.measure()) {
      const bool held = e.measured <= e.bound;
      missed += !held;
      const double ratio = e.bound > 0 ? e.measured / e.bound : 0;
      is_exact = is_exact && e.bound == 0;
      is_tight = is_tight && held && (e.bound == 0 || ratio >= 0.25);
      const char* comma = at.empty() ? "" : "; ";
      at += comma + e.width;
      measured += fmt::format("{}{:.3g}", comma, e.measured);
      part +=
          held ? e.bound > 0 ? fmt::format("{}{:.2f}", comma, ratio) : std::string(comma) + "exact"
               : std::string(comma) + "**MISSED**";
    }
    ++steps;
    exact += is_exact;
    tight += is_tight;
    table += fmt::format("| {} | {} | {} | {} | {} | {} |\n", step.name, cell(step.computes),
                         cell(step.bound), at, measured, part);
  }
  const std::string summary = fmt::format(
      "{} steps: {} within their bound at every width; {} of them tight to a factor of 4 at every "
      "width, {} exact.\n",
      steps, missed ? "NOT all" : "all", tight, exact);
  fmt::print("{}\n{}", table, summary);
  write_page(page, {{"steps", "\n" + summary + "\n" + table + "\n"}});
  return missed == 0 && 2 * tight >= steps ? 0 : 1;
}

int run_stability(const std::string& csv, const std::string& page) {
  std::string text = "line,bits,error\n";
  std::string table =
      "| line | error | bits | error at the least | at the greatest | verdict |\n"
      "|---|---|---|---|---|---|\n";
  int faults = 0;
  const auto curves = width_curves();
  for (const StabilityCurve& c : curves) {
    // The figure is logarithmic: a curve of zeros is in the table alone.
    const bool nothing = changes_nothing(c);
    if (!nothing)
      for (const StabilityPoint& p : c.points)
        text += fmt::format("{},{},{:.6g}\n", c.line, p.bits, p.error);
    const std::string fault = curve_fault(c);
    faults += !fault.empty();
    table += fmt::format("| `{}` | {} | {} to {} | {:.2g} | {:.2g} | {} |\n", c.line, c.error,
                         c.points.front().bits, c.points.back().bits, c.points.front().error,
                         c.points.back().error,
                         !fault.empty() ? "**MISSED** " + fault
                         : nothing      ? "held: changes nothing"
                                        : "held: falls, no cliff");
  }
  std::string summary =
      fmt::format("{} lines of the plan are a number of bits: {} held, {} missed.\n", curves.size(),
                  curves.size() - static_cast<size_t>(faults), faults);
  for (const std::string& missing : missing_widths(curves)) {
    ++faults;
    summary += fmt::format("**MISSED** {}.\n", missing);
  }
  if (!curve_fault_works()) {
    ++faults;
    summary += "**MISSED** the check takes curves that rise or end in a cliff.\n";
  }
  fmt::print("{}\n{}", table, summary);
  if (csv != "-") write_file(csv, text);
  write_page(page, {{"stability", "\n" + summary + "\n" + table + "\n"}});
  return faults == 0 ? 0 : 1;
}

int run_cases(const Settings& settings, const std::string& only, const std::string& page);

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Cases at the ends of what units, conversions and frames can meet."};
  Settings settings;
  std::string only, page, csv;
  bool steps = false;
  app.add_flag("--rtl", settings.rtl, "The RTL beside golden; models are built first.");
  app.add_flag("--slow", settings.slow, "Cases that take more than a second, too.");
  app.add_option("--case", only, "Only cases with this text in their name or group.");
  app.add_option("--page", page,
                 "Markdown file that the tables are written into, between its marks.");
  app.add_option("--work", settings.work, "Where models are kept.");
  app.add_flag("--steps", steps,
               "Instead: the bounds of golden's arithmetic, and what was measured.");
  app.add_option("--stability", csv,
                 "Instead: the error against every width, into this file (- for none).");
  CLI11_PARSE(app, argc, argv);
  try {
    if (steps) return run_steps(page);
    if (!csv.empty()) return run_stability(csv, page);
    return run_cases(settings, only, page);
  } catch (const std::exception& error) {
    fmt::print(stderr, "extremes: {}\n", error.what());
    return 2;
  }
}

namespace {

int run_cases(const Settings& settings, const std::string& only, const std::string& page) {
  Totals totals;
  std::string tables, missed;
  const auto started = std::chrono::steady_clock::now();
  for (const Group& group : {gatherer_cases(), reorder_cases(), sampler_cases(), cache_cases(),
                             conversion_cases(), frame_cases()}) {
    const std::string head = fmt::format(
        "\n## {}\n\n{}\n\n| case | what is right, and why | known by | reference | golden | RTL | "
        "error | "
        "verdict |\n|---|---|---|---|---|---|---|---|\n",
        group.name, group.about);
    tables += head;
    std::fputs(head.c_str(), stdout);
    for (const Case& c : group.cases) {
      if (c.slow && !settings.slow) continue;
      if ((group.name + ": " + c.name).find(only) == std::string::npos) continue;
      Run run(settings);
      std::string failure;
      try {
        c.run(run);
      } catch (const std::exception& error) {
        failure = error.what();
      }
      if (failure.empty() && c.known == Known::kSaturation && !run.reads_counter())
        failure = "reads no counter that is not 0, expected of a saturation";
      if (failure.empty() && run.leaves_out_rtl() && c.no_rtl.empty())
        failure = "asks units and no RTL, expected a reason";
      if (failure.empty() && !c.no_rtl.empty() && !run.leaves_out_rtl())
        failure = "has a reason for no RTL, which runs or has nothing to answer";
      const bool held = failure.empty() && run.held();
      ++totals.cases;
      totals.held += held;
      totals.checks += run.checks();
      totals.rtl_cases += run.ran_rtl();
      totals.rtl_packets += run.rtl_packets();
      totals.differences += run.differences();
      const std::string rtl = !c.no_rtl.empty() ? "not run: " + c.no_rtl
                              : !run.ran_rtl()  ? "–"
                              : run.differences()
                                  ? fmt::format("{} differences", run.differences())
                                  : fmt::format("= golden, {} packets", run.rtl_packets());
      const std::string row =
          fmt::format("| {} | {} | {} | {} {} | {} | {} | {} | {} |\n", cell(c.name), cell(c.right),
                      known_text(c.known), cell(run.what()), cell(run.due()), cell(run.golden()),
                      rtl, run.error(), held ? "held" : "**MISSED**");
      tables += row;
      std::fputs(row.c_str(), stdout);
      std::fflush(stdout);
      if (!held) {
        missed += fmt::format("{}: {}: {} is {}, expected {}{}{}\n", group.name, c.name, run.what(),
                              run.golden(), run.due(), failure.empty() ? "" : "; " + failure,
                              run.differences() ? "; RTL: " + run.first_difference() : "");
      }
    }
  }
  const std::string summary = fmt::format(
      "{} cases, {} checks: {} held, {} missed. Through the RTL: {} cases, {} packets, {} "
      "differences.\n",
      totals.cases, totals.checks, totals.held, totals.cases - totals.held, totals.rtl_cases,
      totals.rtl_packets, totals.differences);
  fmt::print("\n{}{}", missed, summary);
  fmt::print("{:.0f} s\n",
             std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count());
  write_page(page, {{"summary", summary}, {"cases", tables + "\n"}});
  return totals.cases > 0 && totals.held == totals.cases && totals.differences == 0 ? 0 : 1;
}

}  // namespace
