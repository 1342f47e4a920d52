// SPDX-License-Identifier: Apache-2.0
// Processes and bounded streams for native runs. A process is a coroutine with a clock of its own;
// it runs until it waits for a stream. When all wait the run ends and says for which streams. Which
// of the processes that could run goes next is drawn from a seed: it must not matter.
#pragma once
#include <ucontext.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace photonloom_hls {

class Simulation;

// The pipelined loop of a process, as it was counted.
struct LoopCount {
  std::string process;
  unsigned interval = 0;  // cycles between the starts of two turns
  uint64_t turns = 0;
};

struct Process {
  std::string name;
  std::function<void()> body;
  uint64_t cycle = 0;     // of its own clock
  unsigned interval = 0;  // of its pipelined loop
  uint64_t turns = 0;
  bool serves = false;  // a far end of the kernel's ports, which waits forever when all is done
  bool done = false;
  const std::string* stream = nullptr;  // what it waits for; nullptr: it can run
  const char* state = "";               // "empty" or "full"
  Process* parent = nullptr;            // waits for its children
  int children = 0;
  ucontext_t context{};
  std::unique_ptr<char[]> stack;
};

class Simulation {
 public:
  explicit Simulation(uint64_t seed) : random_(seed * 2 + 1) {}
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // The one whose process is running on this thread.
  static Simulation*& current() {
    thread_local Simulation* simulation = nullptr;
    return simulation;
  }

  Process& running() { return *running_; }
  bool aborting() const { return aborting_; }

  // A process that starts with the clock of the one that adds it.
  Process& add(const std::string& name, std::function<void()> body, bool serves = false) {
    auto process = std::make_unique<Process>();
    process->name = name;
    process->body = std::move(body);
    process->serves = serves;
    process->cycle = running_ ? running_->cycle : cycle_;
    process->parent = running_;
    if (running_) ++running_->children;
    process->stack.reset(new char[kStack]);
    getcontext(&process->context);
    process->context.uc_stack.ss_sp = process->stack.get();
    process->context.uc_stack.ss_size = kStack;
    process->context.uc_link = &home_;
    makecontext(&process->context, &Simulation::enter, 0);
    processes_.push_back(std::move(process));
    return *processes_.back();
  }

  // Until every process that does not merely serve is done. What stopped it, empty where nothing
  // did: "stuck: stream S empty (process P) ...".
  std::string run() {
    Simulation* const before = current();
    current() = this;
    problem_.clear();
    while (step()) {
    }
    std::string waiting;
    for (const auto& p : processes_)
      if (!p->done && !p->serves && p->stream)
        waiting += (waiting.empty() ? "stuck: stream " : "; stream ") + *p->stream + " " +
                   p->state + " (process " + p->name + ")";
    if (problem_.empty()) problem_ = waiting;
    // Whatever is left unwinds, children before those that wait for them.
    aborting_ = true;
    for (size_t i = processes_.size(); i-- > 0;)
      if (!processes_[i]->done) resume(*processes_[i]);
    aborting_ = false;
    for (const auto& p : processes_) {
      if (!p->serves) cycle_ = std::max(cycle_, p->cycle);
      if (p->turns != 0) count(*p);
    }
    processes_.clear();
    current() = before;
    return problem_;
  }

  // The loops of all runs so far, in the order in which their processes were added.
  const std::vector<LoopCount>& loops() const { return loops_; }

  // The latest clock of all runs so far.
  uint64_t cycle() const { return cycle_; }

  void fail(const std::string& problem) {
    if (problem_.empty()) problem_ = problem;
  }

  // The running process waits until `stream` wakes it. Throws where the run has ended meanwhile.
  void wait(const std::string& stream, const char* state) {
    running_->stream = &stream;
    running_->state = state;
    leave();
  }
  // The running process waits for those that it added.
  void join() {
    while (running_->children > 0) {
      running_->stream = nullptr;
      leave();
    }
  }
  void wake(Process*& process) {
    if (process) process->stream = nullptr;
    process = nullptr;
  }

 private:
  struct Aborted {};
  static constexpr size_t kStack = 256 * 1024;

  void leave() {
    Process& self = *running_;
    swapcontext(&self.context, &home_);
    if (aborting_) throw Aborted();
  }

  static void enter() {
    Simulation& simulation = *current();
    Process& self = *simulation.running_;
    try {
      if (!simulation.aborting_) self.body();
    } catch (const Aborted&) {
    }
    self.body = nullptr;
    self.done = true;
    if (self.parent) {
      --self.parent->children;
      self.parent->cycle = std::max(self.parent->cycle, self.cycle);
    }
  }

  void count(const Process& p) {
    auto place = std::find_if(loops_.begin(), loops_.end(),
                              [&](const LoopCount& l) { return l.process == p.name; });
    if (place == loops_.end()) place = loops_.insert(loops_.end(), LoopCount{p.name});
    place->interval = p.interval;
    place->turns += p.turns;
  }

  void resume(Process& process) {
    running_ = &process;
    swapcontext(&home_, &process.context);
    running_ = nullptr;
  }

  // One turn of any process that can run; false where none can, or something failed.
  bool step() {
    if (!problem_.empty()) return false;
    const size_t n = processes_.size();
    random_ = random_ * 6364136223846793005ull + 1442695040888963407ull;
    const size_t first = static_cast<size_t>((random_ >> 33) % n);
    for (size_t i = 0; i < n; ++i) {
      Process& p = *processes_[(first + i) % n];
      if (p.done || p.stream || p.children > 0) continue;
      resume(p);
      return true;
    }
    return false;
  }

  uint64_t random_;
  uint64_t cycle_ = 0;
  std::vector<std::unique_ptr<Process>> processes_;
  std::vector<LoopCount> loops_;
  Process* running_ = nullptr;
  bool aborting_ = false;
  ucontext_t home_{};
  std::string problem_;
};

// A stream with one writer and one reader that holds at most `depth` packets. A packet can be read
// in the cycle after the one it was written in; a place can be written in the cycle after it was
// read.
template <class E>
class Stream {
 public:
  Stream(const char* name, unsigned depth) : name_(name), ring_(depth) {}
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() {
    Simulation* const simulation = Simulation::current();
    if (count_ > 0 && simulation && !simulation->aborting())
      simulation->fail("stream " + name_ + ": " + std::to_string(count_) +
                       " packets were never read");
  }

  E read() {
    uint64_t ignored = 0;
    return read(ignored);
  }
  // `written` becomes the writer's cycle.
  E read(uint64_t& written) {
    Simulation& simulation = *Simulation::current();
    while (count_ == 0) {
      reader_ = &simulation.running();
      simulation.wait(name_, "empty");
    }
    Place& place = ring_[first_];
    uint64_t& cycle = simulation.running().cycle;
    cycle = std::max(cycle, place.cycle + 1);
    written = place.cycle;
    place.cycle = cycle;
    first_ = first_ + 1 == ring_.size() ? 0 : first_ + 1;
    --count_;
    if (reads_) reads_->push_back(cycle);
    simulation.wake(writer_);
    return place.packet;
  }
  void write(const E& packet) {
    Simulation& simulation = *Simulation::current();
    while (count_ == ring_.size()) {
      writer_ = &simulation.running();
      simulation.wait(name_, "full");
    }
    const size_t at = first_ + count_;
    Place& place = ring_[at < ring_.size() ? at : at - ring_.size()];
    uint64_t& cycle = simulation.running().cycle;
    if (place.used) cycle = std::max(cycle, place.cycle + 1);
    place.packet = packet;
    place.cycle = cycle;
    place.used = true;
    ++count_;
    simulation.wake(reader_);
  }

  // The cycles of reads are appended to `cycles` from now on.
  void watch_reads(std::vector<uint64_t>* cycles) { reads_ = cycles; }

 private:
  struct Place {
    E packet{};
    uint64_t cycle = 0;  // in which it was written, or read where it is free
    bool used = false;
  };
  const std::string name_;
  std::vector<Place> ring_;
  size_t first_ = 0, count_ = 0;
  Process *reader_ = nullptr, *writer_ = nullptr;  // that wait
  std::vector<uint64_t>* reads_ = nullptr;
};

// Processes that run beside each other until all are done.
class Dataflow {
 public:
  void add(const char* name, std::function<void()> body) {
    Simulation::current()->add(name, std::move(body));
  }
  void run() { Simulation::current()->join(); }
};

// The running process does nothing for so many cycles.
inline void pass(uint64_t cycles) { Simulation::current()->running().cycle += cycles; }

// A turn of the pipelined loop of the running process.
inline void turn(unsigned interval) {
  Process& process = Simulation::current()->running();
  process.cycle += interval;
  process.interval = interval;
  ++process.turns;
}

}  // namespace photonloom_hls
