// SPDX-License-Identifier: Apache-2.0
// What a person at a terminal sees while work runs, and Ctrl-C.
#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "golden/numeric/progress.hpp"

namespace photonloom {

// Wall-clock and CPU seconds (all threads) of a phase that has ended.
struct PhaseTime {
  std::string phase;
  double wall = 0, cpu = 0;
  uint64_t steps = 0;
  std::string unit;
};

// Keeps the time of each phase; when stderr is a terminal also draws one line with a bar, the rate
// and the time left, five times a second.
class ConsoleProgress final : public Progress {
 public:
  ConsoleProgress();
  ~ConsoleProgress() override;
  void begin(const std::string& phase, uint64_t total, const std::string& unit) override;
  void advance(uint64_t steps) override { done_.fetch_add(steps, std::memory_order_relaxed); }
  void end() override;

  const std::vector<PhaseTime>& times() const { return times_; }
  std::string table() const;  // of times(), a line each

 private:
  void draw_until_stopped();
  void draw(double seconds) const;

  std::string phase_, unit_;
  uint64_t total_ = 0;
  std::atomic<uint64_t> done_{0};
  std::chrono::steady_clock::time_point started_;
  double cpu_started_ = 0;
  std::vector<PhaseTime> times_;

  bool terminal_;
  bool stop_ = false;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::thread painter_;
};

// A bar where stderr is a terminal; else, for logs, a line at each tenth of a long phase.
std::unique_ptr<Progress> make_progress_or_log();

// CPU seconds of this process so far, all threads.
double cpu_seconds();

// From now on SIGINT and SIGTERM remove unfinished outputs and end the program with status 130 and
// 143.
void handle_interrupts();

}  // namespace photonloom
