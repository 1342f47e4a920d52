// SPDX-License-Identifier: Apache-2.0
// Points as array jobs of Slurm.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace photonloom {

struct SlurmWork {
  std::string program, study_file, folder, work_dir;
  std::vector<uint32_t> points;
};

// What this machine lacks to submit jobs, as a sentence; empty where it lacks nothing.
std::string slurm_missing();

// Submits one array job and returns when none of its tasks is queued or running; what they left
// behind is the caller's to see. `alive` is called while it waits. Throws std::runtime_error where
// sbatch is missing or refuses.
void run_on_slurm(const SlurmWork& work, const std::function<void()>& alive);

}  // namespace photonloom
