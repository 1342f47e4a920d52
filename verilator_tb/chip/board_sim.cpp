// SPDX-License-Identifier: Apache-2.0
// board_sim PLAN --link tty: the Verilated board_core of a plan behind a pseudo-terminal. Bytes
// pass between the terminal and the board's two wires bit by bit; on the way they can be harmed.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>
#include <csignal>
#include <deque>
#include <vector>

#include "golden/numeric/random.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/plan/units.hpp"
#include "verilator_tb/chip/board_model.hpp"
#include "verilator_tb/chip/pseudo_terminal.hpp"
#include "verilator_tb/rig/number_options.hpp"

namespace photonloom {
namespace {

volatile std::sig_atomic_t stop_asked = 0;

struct Options {
  std::string plan, link;
  BoardRun run;
  std::string corrupt = "0", drop = "0", duplicate = "0";
  uint64_t seed = 1;
};

// "1/10000" or "0" -> one in so many, 0 for never.
uint64_t one_in(const std::string& option, const std::string& text) {
  if (text == "0") return 0;
  const auto n = text.starts_with("1/") ? strict_number<uint64_t>(text.substr(2)) : std::nullopt;
  if (!n || *n < 2)
    throw std::runtime_error(
        fmt::format("{}: '{}', expected 0 or 1/N with N 2 or more", option, text));
  return *n;
}

// Changes, loses and doubles bytes of one direction.
class Harm {
 public:
  Harm(const Options& o, uint64_t direction)
      : corrupt_(one_in("--corrupt", o.corrupt)),
        drop_(one_in("--drop", o.drop)),
        duplicate_(one_in("--duplicate", o.duplicate)),
        seed_(o.seed),
        direction_(direction) {}

  void pass(uint8_t byte, std::vector<uint8_t>& to) {
    const uint64_t n = bytes_++;
    const auto hit = [&](uint64_t one_in, uint64_t kind) {
      return one_in && hash_bits(seed_, n, direction_, kind) % one_in == 0;
    };
    if (hit(drop_, 0)) {
      ++dropped_;
      return;
    }
    if (hit(corrupt_, 1)) {
      ++corrupted_;
      byte = static_cast<uint8_t>(byte ^ (1 + hash_bits(seed_, n, direction_, 2) % 255));
    }
    to.push_back(byte);
    if (hit(duplicate_, 3)) {
      ++duplicated_;
      to.push_back(byte);
    }
  }

  std::string report(const char* where) const {
    return fmt::format("{} bytes {}: {} corrupted, {} dropped, {} duplicated\n", bytes_, where,
                       corrupted_, dropped_, duplicated_);
  }

 private:
  uint64_t corrupt_, drop_, duplicate_, seed_, direction_;
  uint64_t bytes_ = 0, corrupted_ = 0, dropped_ = 0, duplicated_ = 0;
};

constexpr int kCyclesAtOnce = 40;         // between looks at the terminal: a byte at 4 clocks a bit
constexpr uint64_t kQuietCycles = 20000;  // without a byte either way, after which it sleeps
constexpr size_t kBytesAhead = 16;        // of the terminal's, in the wire's queue

void simulate(const Options& o) {
  Harm to_board(o, 0), to_host(o, 1);
  const Plan plan = read_plan(o.plan);
  BoardModel board(plan, o.run);
  PseudoTerminal terminal(o.link);
  fmt::print("board_sim: plan {}, {} clocks a bit, at {}{}\n", plan_hash_text(plan),
             o.run.clocks_per_bit, terminal.path(), o.link.empty() ? "" : " = " + o.link);
  std::fflush(stdout);

  std::vector<uint8_t> out, harmed;  // bytes that the terminal has not yet taken
  uint64_t moved = 0;                // cycle of the last byte
  while (!stop_asked) {
    std::array<uint8_t, kBytesAhead> buffer;
    if (board.wire().waiting() < kBytesAhead) {
      const size_t n = terminal.read(buffer);
      harmed.clear();
      for (size_t i = 0; i < n; ++i) to_board.pass(buffer[i], harmed);
      board.wire().send(harmed);
      if (n) moved = board.cycles();
    }
    for (int i = 0; i < kCyclesAtOnce; ++i) board.cycle();
    std::deque<uint8_t>& received = board.wire().received();
    if (!received.empty()) moved = board.cycles();
    for (; !received.empty(); received.pop_front()) to_host.pass(received.front(), out);
    if (!out.empty()) {
      const size_t n = terminal.write(out);
      out.erase(out.begin(), out.begin() + static_cast<long>(n));
    }
    if (board.cycles() - moved > kQuietCycles && !board.wire().sending()) terminal.wait(2);
  }
  fmt::print("board_sim: {} cycles\n{}{}", board.cycles(), to_board.report("to the board"),
             to_host.report("from the board"));
}

int run(int argc, char** argv) {
  Options o;
  CLI::App app{
      "The simulated board of a plan behind a pseudo-terminal, until it is interrupted.\n" +
          fmt::format("photonloom cosim --backend {}=board:LINK talks to it as to a real one.",
                      unit_name<PhotonGatherer>),
      "board_sim"};
  app.add_option("PLAN", o.plan, "The plan whose board it is")->required()->type_name("FILE");
  app.add_option("--link", o.link, "Makes this a symbolic link to the pseudo-terminal")
      ->type_name("PATH");
  app.add_option("--divisor", o.run.clocks_per_bit, "Clocks a bit of the UART (default 4)")
      ->check(CLI::Range(4, 65535))
      ->type_name("N");
  app.add_option("--corrupt", o.corrupt, "Changes one byte in N on the link, both ways: 1/N")
      ->type_name("1/N");
  app.add_option("--drop", o.drop, "Loses one byte in N")->type_name("1/N");
  app.add_option("--duplicate", o.duplicate, "Doubles one byte in N")->type_name("1/N");
  add_seed_option(app, o.seed, "Of these");
  add_seed_option(app, o.run.initial_seed, "Of the registers' initial values", "--initial-seed");
  app.add_option("--waveform", o.run.waveform, "Writes all cycles as FST")->type_name("FILE");
  app.add_option("--rtl", o.run.rtl_dir, "Takes the RTL from here")->type_name("DIR");
  app.add_option("--work", o.run.work_dir, "Where models are kept (default build/cosim)")
      ->type_name("DIR");
  check_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  simulate(o);
  return 0;
}

}  // namespace
}  // namespace photonloom

int main(int argc, char** argv) {
  try {
    return photonloom::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "board_sim: {}\n", error.what());
    return 1;
  }
}
