// SPDX-License-Identifier: Apache-2.0
#include "command/console.hpp"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>

#include "command/tell.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/numeric/text.hpp"

namespace photonloom {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// 1234567 -> "1.23M"
std::string counted(double n) {
  for (const auto& [scale, letter] : {std::pair{1e9, "G"}, {1e6, "M"}, {1e3, "k"}})
    if (n >= scale) return fmt::format("{:.3g}{}", n / scale, letter);
  return fmt::format("{:.3g}", n);
}

int interrupt_pipe[2];

void on_interrupt(int signal) {
  const int saved = errno;
  const char byte = static_cast<char>(signal);
  if (write(interrupt_pipe[1], &byte, 1) != 1) _exit(128 + signal);
  errno = saved;
}

}  // namespace

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

namespace {

class LineProgress final : public Progress {
 public:
  void begin(const std::string& phase, uint64_t total, const std::string& unit) override {
    phase_ = phase;
    unit_ = unit;
    total_ = total;
    done_ = 0;
    start_ = std::chrono::steady_clock::now();
  }
  void advance(uint64_t steps) override {
    const uint64_t before = done_.fetch_add(steps), now = before + steps;
    if (total_ < 10 || now * 10 / total_ == before * 10 / total_) return;
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (seconds < 10) return;
    const double rate = static_cast<double>(now) / std::max(seconds, 1e-9);
    tell("{}: {} of {} {}, {:.3g}/s, {} left\n", phase_, now, total_, unit_, rate,
         spoken(static_cast<double>(total_ - now) / rate));
  }

 private:
  std::string phase_, unit_;
  uint64_t total_ = 0;
  std::atomic<uint64_t> done_{0};
  std::chrono::steady_clock::time_point start_;
};

}  // namespace

std::unique_ptr<Progress> make_progress_or_log() {
  if (isatty(STDERR_FILENO) == 1) return std::make_unique<ConsoleProgress>();
  return std::make_unique<LineProgress>();
}

ConsoleProgress::ConsoleProgress() : terminal_(isatty(STDERR_FILENO) == 1) {}

ConsoleProgress::~ConsoleProgress() {
  if (painter_.joinable()) end();
}

void ConsoleProgress::begin(const std::string& phase, uint64_t total, const std::string& unit) {
  phase_ = phase;
  unit_ = unit;
  total_ = total;
  done_ = 0;
  cpu_started_ = cpu_seconds();
  started_ = std::chrono::steady_clock::now();
  if (!terminal_) return;
  stop_ = false;
  painter_ = std::thread([this] { draw_until_stopped(); });
}

void ConsoleProgress::end() {
  times_.push_back({phase_, seconds_since(started_), cpu_seconds() - cpu_started_, done_, unit_});
  if (!painter_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  painter_.join();
  std::fputs("\r\x1b[K", stderr);
}

void ConsoleProgress::draw_until_stopped() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, std::chrono::milliseconds(200), [this] { return stop_; }))
    draw(seconds_since(started_));
}

void ConsoleProgress::draw(double seconds) const {
  const double done = static_cast<double>(done_.load(std::memory_order_relaxed));
  const double rate = seconds > 0 ? done / seconds : 0;
  std::string line = phase_;
  if (total_ > 0) {
    const double part = std::min(1.0, done / static_cast<double>(total_));
    const int filled = static_cast<int>(part * 20);
    line += fmt::format(" [{}{}] {:3.0f} %", std::string(static_cast<size_t>(filled), '#'),
                        std::string(static_cast<size_t>(20 - filled), '.'), 100 * part);
  }
  if (done > 0) line += fmt::format("  {} {}/s", counted(rate), unit_);
  if (total_ > 0 && rate > 0)
    line +=
        fmt::format("  {} left", spoken(std::max(0.0, static_cast<double>(total_) - done) / rate));
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1)
    line.resize(std::min(line.size(), static_cast<size_t>(size.ws_col - 1)));
  tell("\r\x1b[K{}", line);
  std::fflush(stderr);
}

std::string ConsoleProgress::table() const {
  std::string text;
  for (const PhaseTime& t : times_) {
    text += fmt::format("  {:<28} {:>9.2f} s  {:>9.2f} CPU s", t.phase, t.wall, t.cpu);
    if (t.steps > 0)
      text += fmt::format("  {:>8} {}", counted(static_cast<double>(t.steps)), t.unit);
    text += '\n';
  }
  return text;
}

void handle_interrupts() {
  if (pipe(interrupt_pipe) != 0) return;
  // Removing files is not allowed in a signal handler: a thread waits for it and does it.
  std::thread([] {
    char signal = 0;
    while (read(interrupt_pipe[0], &signal, 1) != 1) {
    }
    remove_unfinished_outputs();
    if (isatty(STDERR_FILENO) == 1) std::fputs("\r\x1b[K", stderr);
    tell("photonloom: interrupted; nothing half-written was left\n");
    _exit(128 + signal);
  }).detach();
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction now {};
  sigaction(SIGHUP, nullptr, &now);
  if (now.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // as nohup has it
  // That nobody reads an output any more is told where it is written. Not ignored: programs that
  // are started would inherit that.
  action.sa_handler = [](int) {};
  sigaction(SIGPIPE, &action, nullptr);
}

}  // namespace photonloom
