// SPDX-License-Identifier: Apache-2.0
// photonloom sweep STUDY.toml -o DIR: many plans, measured.
#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "command/command.hpp"
#include "command/console.hpp"
#include "command/tell.hpp"
#include "study/runner.hpp"

namespace photonloom {
namespace {

struct SweepOptions {
  std::string study, output, on = "local", points, work = "build/cosim";
  bool wait = false, task = false;
  ThreadsOption threads;
};

void sweep(const SweepOptions& o) {
  const std::unique_ptr<Progress> progress = make_progress_or_log();
  SweepRequest request;
  request.study_file = o.study;
  request.folder = o.output;
  if (!o.points.empty()) as_usage("", [&] { request.only = parse_numbers(o.points, "--points"); });
  if (o.task && o.points.empty()) throw UsageError("--task goes with --points");
  request.wait = o.wait;
  request.is_task = o.task;
  request.on_slurm = o.on == "slurm";
  o.threads.apply();
  request.workers = o.threads.threads();
  request.work_dir = o.work;
  request.program = std::filesystem::read_symlink("/proc/self/exe").string();
  request.progress = progress.get();
  request.say = [](const std::string& sentence) { tell("photonloom: {}\n", sentence); };
  const SweepReport r = [&] {
    try {
      return run_sweep(request);
    } catch (const PointsError& error) {
      throw UsageError(error.what());
    }
  }();
  if (!o.task) {
    const CollectReport& c = r.collected;
    fmt::print(
        "{} results computed, {} there before; {} points, {} refused, {} failed, {} missing\n",
        r.computed, r.kept, c.points, c.refused, c.failed, c.missing);
    fmt::print("wrote {0}/results.sqlite, {0}/results.csv, {0}/summary.json\n", o.output);
  }
  if (!r.failures.empty())
    throw CheckFailed(fmt::format("{} of scenes and points failed; what they said stands above",
                                  r.failures.size()));
}

void add_sweep(CLI::App& app) {
  auto o = std::make_shared<SweepOptions>();
  CLI::App* c = app.add_subcommand("sweep", "Many plans, measured: error against speed");
  c->footer(
      "A study (docs/sweep.md) names scenes, lines of the plan with values, and what to measure.\n"
      "Each result is a file of its own in DIR, so that a sweep can be stopped at any moment; the\n"
      "same command goes on and ends with the same tables: results.sqlite, results.csv,\n"
      "summary.json.\n\n"
      "Examples:\n"
      "  photonloom sweep studies/tradeoffs.toml -o build/tradeoffs\n"
      "  photonloom sweep studies/tradeoffs.toml -o build/tradeoffs --points 17,23-30");
  c->add_option("STUDY", o->study, "The study file")->required()->type_name("STUDY.toml");
  c->add_option("-o,--output", o->output, "The sweep's folder, new or to go on with")
      ->required()
      ->type_name("DIR");
  c->add_option("--on", o->on, "local (default): all cores of this machine; slurm: array jobs")
      ->check(CLI::IsMember({"local", "slurm"}))
      ->type_name("WHERE");
  c->add_option("--points", o->points, "Only these points, as 17,23-30")->type_name("LIST");
  c->add_flag("--wait", o->wait, "Wait for another sweep on the folder instead of refusing");
  c->add_option("--work", o->work, "Folder of Verilated models (default build/cosim)")
      ->type_name("DIR");
  c->add_flag("--task", o->task, "Part of an array job: the sweep that submitted it collects")
      ->group("");
  o->threads.add_to(*c);
  c->callback([o] { sweep(*o); });
}

const Command sweep_command(46, add_sweep);

}  // namespace
}  // namespace photonloom
