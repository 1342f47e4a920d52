// SPDX-License-Identifier: Apache-2.0
#include "study/slurm.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>

#include "golden/numeric/output_file.hpp"
#include "study/process.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom {
namespace {

using model_tools::quoted;

constexpr size_t kTasks = 1000;  // of an array: Slurm's own default limit is 1001

struct Answer {
  int status;
  std::string text, errors;  // of both streams: sites tell their news on standard error
};

// `folder`: where standard error is put meanwhile.
Answer ask(const std::string& command, const std::string& folder) {
  const std::string errors = folder + "/stderr";
  const auto [status, text] = output_of(fmt::format("{{ {} 2>{}; }}", command, quoted(errors)));
  return {status, text, read_file(errors)};
}

}  // namespace

std::string slurm_missing() {
  for (const char* command : {"sbatch", "squeue"})
    if (output_of(fmt::format("command -v {}", command)).first != 0)
      return fmt::format(
          "--on slurm needs {}, which is not in PATH: only a machine of a Slurm "
          "cluster submits jobs",
          command);
  return "";
}

void run_on_slurm(const SlurmWork& work, const std::function<void()>& alive) {
  if (const std::string why = slurm_missing(); !why.empty()) throw std::runtime_error(why);
  const std::string folder = std::filesystem::absolute(work.folder).string() + "/slurm";
  std::filesystem::create_directories(folder);
  const size_t each = (work.points.size() + kTasks - 1) / kTasks;
  std::string lists;
  size_t tasks = 0;
  for (size_t i = 0; i < work.points.size(); i += each, ++tasks) {
    for (size_t j = i; j < std::min(work.points.size(), i + each); ++j)
      lists += fmt::format("{}{}", j == i ? "" : ",", work.points[j]);
    lists += '\n';
  }
  write_file(folder + "/points", lists);
  const std::string here = std::filesystem::current_path().string();
  write_file(
      folder + "/job.sh",
      fmt::format(
          "#!/bin/sh\ncd {} || exit 1\npoints=$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" {})\n"
          "exec {} sweep {} -o {} --work {} --points \"$points\" --task --threads "
          "\"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
          quoted(here), quoted(folder + "/points"), quoted(work.program), quoted(work.study_file),
          quoted(work.folder), quoted(work.work_dir)));
  const Answer job =
      ask(fmt::format("sbatch --parsable --job-name=photonloom-sweep --array=0-{} --output={} {}",
                      tasks - 1, quoted(folder + "/%A_%a.log"), quoted(folder + "/job.sh")),
          folder);
  if (job.status != 0)
    throw std::runtime_error(fmt::format("sbatch: {}", job.errors.empty() ? "failed" : job.errors));
  const std::string number = job.text.substr(0, job.text.find(';'));
  if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos)
    throw std::runtime_error(fmt::format(
        "sbatch: '{}' is not the number of a job, which --parsable asks for", job.text));
  for (;;) {
    const Answer queue =
        ask(fmt::format("squeue --noheader --jobs={} --format=%i", number), folder);
    // squeue refuses the number of a job that it has forgotten.
    if (queue.status == 0 ? queue.text.empty()
                          : queue.errors.find("nvalid job") != std::string::npos)
      return;
    if (queue.status != 0) throw std::runtime_error(fmt::format("squeue: {}", queue.errors));
    alive();
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  }
}

}  // namespace photonloom
