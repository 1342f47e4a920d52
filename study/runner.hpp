// SPDX-License-Identifier: Apache-2.0
// Runs a study: what is not stored yet is measured, then everything is collected. Stopped at any
// moment and started again it ends with the same tables.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "golden/numeric/progress.hpp"
#include "study/collector.hpp"

namespace photonloom {

struct SweepRequest {
  std::string study_file, folder;
  std::vector<std::string> scenes;  // files instead of the study's; empty: the study's
  std::vector<uint32_t> only;       // points; empty: all
  bool wait = false;                // for another sweep on the folder
  bool is_task = false;             // part of a sweep that holds the lock and will collect
  bool on_slurm = false;
  int workers = 1;                       // results at a time
  std::string work_dir = "build/cosim";  // of Verilated models
  std::string program;                   // this program's file, for jobs
  Progress* progress = nullptr;
  std::function<void(const std::string&)> say;  // a sentence for the user
};

struct SweepReport {
  uint64_t kept = 0, computed = 0, again = 0;  // results; `again` of the computed were damaged,
                                               // failed, or made with other settings
  std::vector<std::string> failures;           // a sentence each
  CollectReport collected;
};

// Throws StudyError for a study that cannot be read, std::runtime_error for a folder that cannot be
// used (locked, full). What failed of single scenes and points is in the report.
SweepReport run_sweep(const SweepRequest& request);

}  // namespace photonloom
