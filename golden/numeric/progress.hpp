// SPDX-License-Identifier: Apache-2.0
// How long work tells whoever waits for it where it is. Lower folders report, the command line
// shows.
#pragma once
#include <cstdint>
#include <string>

namespace photonloom {

// begin() and end() of phases come from one thread, never nested; advance() from any. The base
// class shows nothing.
class Progress {
 public:
  virtual ~Progress() = default;
  // A phase of `total` steps (0: not known), each a `unit` ("photons", "pixels").
  virtual void begin(const std::string& /*phase*/, uint64_t /*total*/,
                     const std::string& /*unit*/) {}
  virtual void advance(uint64_t /*steps*/) {}
  virtual void end() {}
};

// One phase: ended when it goes out of scope. `progress` may be null.
class ProgressPhase {
 public:
  ProgressPhase(Progress* progress, const std::string& name, uint64_t total,
                const std::string& unit)
      : progress_(progress) {
    if (progress_) progress_->begin(name, total, unit);
  }
  ~ProgressPhase() {
    if (progress_) progress_->end();
  }
  ProgressPhase(const ProgressPhase&) = delete;
  ProgressPhase& operator=(const ProgressPhase&) = delete;
  void advance(uint64_t steps) const {
    if (progress_) progress_->advance(steps);
  }

 private:
  Progress* progress_;
};

}  // namespace photonloom
