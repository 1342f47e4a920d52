// SPDX-License-Identifier: Apache-2.0
// The host program against a simulated board over a pseudo-terminal, as over a serial port.
#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "golden/pipeline/prepare.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "tests/units/board_double.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

constexpr const char* kFrame =
    "--size 6x6 --spp 1 --gather-rays 4 --k 4 --photons 300 --caustic-photons 100 "
    "--set gatherer.contexts=2 --set gatherer.lanes=2 --set gatherer.cache_bytes=1024 "
    "--set board.replay_queries=64 --set board.parity=true --set board.self_test=true";

std::string scene() { return source("scenes/cornell_balls.xml"); }

// board_sim of a plan, at tty of the scratch folder until it is ended.
class SimulatedBoard {
 public:
  SimulatedBoard(const Scratch& scratch, std::vector<std::string> options = {})
      : tty(scratch / "tty") {
    std::vector<std::string> words{
        environment("BOARD_SIM"), scratch / "plan.toml", "--link", tty, "--work", "cosim"};
    words.insert(words.end(), options.begin(), options.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      execv(argv[0], argv.data());
      _exit(127);
    }
    while (!std::filesystem::exists(tty)) {
      if (waitpid(pid_, nullptr, WNOHANG) != 0) {
        pid_ = -1;
        FAIL("board_sim did not start");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  ~SimulatedBoard() { end(SIGTERM); }
  SimulatedBoard(const SimulatedBoard&) = delete;
  SimulatedBoard& operator=(const SimulatedBoard&) = delete;

  void end(int signal) {
    if (pid_ < 0) return;
    kill(pid_, signal);
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
    std::filesystem::remove(tty);
  }

  const std::string tty;

 private:
  pid_t pid_ = -1;
};

std::string board_cosim(const Scratch& scratch, const std::string& more) {
  return fmt::format("cosim {} --plan {} --backend photon_gatherer=board:{} --work {} -o {} {}",
                     scene(), scratch / "plan.toml", scratch / "tty", scratch / "work",
                     scratch / "out", more);
}

// What a command does that has this board at a pseudo-terminal; it gets the terminal's name.
Outcome run_on(BoardDouble& board,
               const std::function<std::string(const std::string&)>& arguments) {
  const int device = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  REQUIRE(device >= 0);
  REQUIRE(grantpt(device) == 0);
  REQUIRE(unlockpt(device) == 0);
  const std::string tty = ptsname(device);
  // Somebody has it open, or reading fails before the command comes.
  const int held = open(tty.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  std::atomic<bool> stop{false};
  std::thread serve([&] {
    while (!stop) {
      pollfd ready{device, POLLIN, 0};
      if (poll(&ready, 1, 20) != 1) continue;
      uint8_t bytes[256];
      const ssize_t n = read(device, bytes, sizeof bytes);
      Bytes answers;
      for (ssize_t i = 0; i < n; ++i)
        for (const uint8_t byte : board.take(bytes[i])) answers.push_back(byte);
      for (size_t at = 0; at < answers.size() && !stop;) {
        const ssize_t written = write(device, answers.data() + at, answers.size() - at);
        if (written > 0) at += static_cast<size_t>(written);
      }
    }
  });
  const Outcome o = run(arguments(tty));
  stop = true;
  serve.join();
  close(held);
  close(device);
  return o;
}

void make_plan(const Scratch& scratch, const std::string& more = "") {
  const Outcome o =
      run(fmt::format("plan {} {} {} -o {}", scene(), kFrame, more, scratch / "plan.toml"));
  INFO(o.err);
  REQUIRE(o.status == 0);
}

}  // namespace

TEST_CASE("a frame through the board has golden's packets and bytes") {
  const Scratch scratch;
  make_plan(scratch);
  const auto render = run(fmt::format("render {} --plan {} -o {}", scene(), scratch / "plan.toml",
                                      scratch / "render.exr"));
  REQUIRE(render.status == 0);
  const SimulatedBoard board(scratch);
  const auto state_now = [&] {
    const Outcome info = run("board info --json " + board.tty);
    REQUIRE(info.status == 0);
    return nlohmann::json::parse(info.out);
  };
  const auto first = state_now();
  CHECK(first["self_test"] == "passed");
  CHECK(first["faults"] == 0);
  // The link hears nothing until the self-test is through, which may cut one frame.
  CHECK(first["frames_bad"].get<int>() <= 1);
  const Outcome o = run(board_cosim(scratch, ""));
  INFO(o.out << o.err);
  REQUIRE(o.status == 0);
  // How often a frame is sent again on a clean wire is the machine's; tests/units/host_link.cpp
  // asks for 0 in time that is simulated.
  CHECK_THAT(o.out,
             ContainsSubstring("golden == board: ") &&
                 ContainsSubstring("image bytes of golden and board are identical") &&
                 ContainsSubstring(" frames sent again, lost 0 times\n  0 packets were answered"));
  const auto summary = nlohmann::json::parse(read_file(scratch / "out/summary.json"));
  CHECK(summary["units"]["photon_gatherer"]["backend"] == "board");
  CHECK(summary["units"]["photon_gatherer"]["packets"] > 200);
  CHECK(read_file(scratch / "out/board.exr") == read_file(scratch / "render.exr"));
  CHECK(std::filesystem::is_empty(scratch / "work"));

  const auto state = state_now();
  CHECK(state["plan_hash"] == summary["plan_hash"]);
  CHECK(state["queries_inside"] == false);
  CHECK(state["frames_bad"] == first["frames_bad"]);
  // The flush at the end of the frame is no query.
  const auto& counters = summary["units"]["photon_gatherer"]["counters"];
  CHECK(state["counters"]["queries"].get<int>() - first["counters"]["queries"].get<int>() ==
        counters["packets in"].get<int>() - 1);
  CHECK(state["faults"] == 0);

  for (const char* mode : {"--passes 3", "--passes 2 --reorder --cold --queries 20 --skip 5"}) {
    const Outcome replay = run(fmt::format("board replay {} {} --plan {} --json {}", board.tty,
                                           scene(), scratch / "plan.toml", mode));
    INFO(replay.out << replay.err);
    CHECK(replay.status == 0);
    const auto report = nlohmann::json::parse(replay.out);
    CHECK(report["signature"] == report["golden_signature"]);
    CHECK(report["cycles_per_gather"] > 1);
  }
}

TEST_CASE("each flag of a board is told under its own name") {
  BoardDouble board{Plan{}};
  for (const uint32_t flag : {kFlagQueriesInside, kFlagMemoryReady, kFlagReplayBusy}) {
    CAPTURE(flag);
    board.flags = flag;
    const Outcome o =
        run_on(board, [](const std::string& tty) { return "board info --json " + tty; });
    INFO(o.err);
    REQUIRE(o.status == 0);
    const auto said = nlohmann::json::parse(o.out);
    CHECK(said["queries_inside"] == (flag == kFlagQueriesInside));
    CHECK(said["memory_ready"] == (flag == kFlagMemoryReady));
    CHECK(said["replay_busy"] == (flag == kFlagReplayBusy));
  }
}

TEST_CASE("a replay plays as many queries as there are and as have room, and says their rate") {
  const Scratch scratch;
  // A floor at which some estimates are clamped.
  make_plan(scratch, "--set gather.r2_floor=67108864");
  FrameRequest request;
  request.scene_file = scene();
  request.plan_file = scratch / "plan.toml";
  const PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, nullptr);
  const auto room = static_cast<uint64_t>(frame.plan.replay_queries);
  const Outcome render = run(fmt::format("render {} --plan {} --json -o {}", scene(),
                                         request.plan_file, scratch / "a.exr"));
  REQUIRE(render.status == 0);
  const uint64_t there = nlohmann::json::parse(render.out)["counts"]["final_gathers"];
  REQUIRE(there > room);

  BoardDouble board(frame.plan);
  board.set_maps(frame.global, frame.caustic);
  board.clock_khz = 12500;
  board.replay_cycles = 1000003;
  const auto replay = [&](const std::string& more) {
    return run_on(board, [&](const std::string& tty) {
      return fmt::format("board replay {} {} --plan {} {}", tty, scene(), request.plan_file, more);
    });
  };
  for (const auto& [mode, queries] : {std::pair<std::string, uint64_t>{"", room},
                                      {" --reorder", room - 1},  // the flush takes a place
                                      {fmt::format(" --skip {}", there - 1), 1},
                                      {fmt::format(" --reorder --skip {}", there - 1), 1}}) {
    const Outcome o = replay("--json --passes 3" + mode);
    INFO(mode << ": " << o.err);
    REQUIRE(o.status == 0);
    const auto said = nlohmann::json::parse(o.out);
    CHECK(said["signature"] == said["golden_signature"]);
    CHECK(said["gathers"] == 3 * queries);
    CHECK(said["golden_full"] == board.full);
    CHECK(said["golden_clamped"] == board.clamped);
    if (queries > 1) {
      REQUIRE(board.clamped > 0);
      REQUIRE(board.full != board.clamped);
    }
    const double seconds = static_cast<double>(board.replay_cycles) / (board.clock_khz * 1000.0);
    CHECK(said["cycles"] == board.replay_cycles);
    CHECK(said["cycles_per_gather"].get<double>() * static_cast<double>(3 * queries) ==
          Approx(static_cast<double>(board.replay_cycles)));
    CHECK(said["gathers_per_second"].get<double>() * seconds ==
          Approx(static_cast<double>(3 * queries)));
  }
  CHECK(board.loaded());
  CHECK_THAT(replay("--passes 3").out,
             ContainsSubstring(fmt::format("\n{:.0f} gathers a second at 12.5 MHz\n",
                                           static_cast<double>(3 * room) * 12.5e6 /
                                               static_cast<double>(board.replay_cycles))));

  const auto refused = [&](const std::string& more, const std::string& why) {
    const Outcome o = replay(more);
    INFO(more << ": " << o.err);
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    CHECK_THAT(o.err, ContainsSubstring(why));
  };
  for (const uint64_t skip : {there, there + 1})
    refused(fmt::format("--skip {}", skip),
            fmt::format("--skip {}: the frame has {} final gather queries", skip, there));
  refused(fmt::format("--queries {}", room + 1),
          fmt::format("the plan's replayer holds {} ", room));
  refused(fmt::format("--reorder --queries {}", room),
          fmt::format("the plan's replayer holds {} ", room - 1));
}

TEST_CASE("a frame over a wire that bends, loses and doubles bytes has the same image", "[slow]") {
  const Scratch scratch;
  make_plan(scratch);
  REQUIRE(run(fmt::format("render {} --plan {} -o {}", scene(), scratch / "plan.toml",
                          scratch / "render.exr"))
              .status == 0);
  const SimulatedBoard board(
      scratch, {"--corrupt", "1/2000", "--drop", "1/2000", "--duplicate", "1/2000", "--seed", "7"});
  const Outcome o = run(board_cosim(scratch, ""));
  INFO(o.out << o.err);
  REQUIRE(o.status == 0);
  CHECK_THAT(o.out, !ContainsSubstring(" 0 frames sent again"));
  CHECK(read_file(scratch / "out/board.exr") == read_file(scratch / "render.exr"));
}

TEST_CASE("another plan's bitstream, and a board that goes away") {
  const Scratch scratch;
  make_plan(scratch);
  SimulatedBoard board(scratch);
  const Outcome wrong = run(
      fmt::format("cosim {} {} --set gather.leaf_limit=5 --backend photon_gatherer=board:{} -o {}",
                  scene(), kFrame, board.tty, scratch / "out"));
  CHECK(wrong.status == 1);
  CHECK(wrong.one_error_line());
  CHECK_THAT(wrong.err, ContainsSubstring(": holds the bitstream of plan ") &&
                            ContainsSubstring(", but this is plan ") &&
                            ContainsSubstring("make fpga"));

  std::thread unplug([&] {
    for (;;) {
      uintmax_t kept = 0;
      std::error_code error;
      for (const auto& file : std::filesystem::directory_iterator(scratch / "work", error))
        kept += file.file_size(error);
      if (kept > 2000) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    board.end(SIGKILL);
  });
  const Outcome cut = run(board_cosim(scratch, "--board-wait 0.5"));
  unplug.join();
  INFO(cut.err);
  CHECK(cut.status == 1);
  CHECK_THAT(cut.err, ContainsSubstring("; waiting 0.5 seconds for it to come back\n") &&
                          ContainsSubstring(": did not come back within 0.5 seconds; ") &&
                          ContainsSubstring(", the same command goes on after them\n"));

  const SimulatedBoard again(scratch);
  const Outcome rest = run(board_cosim(scratch, "--json"));
  INFO(rest.err);
  CHECK(rest.status == 0);
  CHECK_THAT(rest.err, ContainsSubstring(" answers are there already, going on after them\n"));
  const auto summary = nlohmann::json::parse(rest.out);
  const auto& counters = summary["units"]["photon_gatherer"]["counters"];
  CHECK(counters["packets resumed"] > 5);
  CHECK(counters["queries"] ==
        counters["packets in"].get<int>() - counters["packets resumed"].get<int>() - 1);
  CHECK(summary["images_identical"] == true);
}

TEST_CASE("what is no board") {
  const Scratch scratch;
  make_plan(scratch);
  const auto error = [&](const std::string& arguments, int status) {
    INFO(arguments);
    const Outcome o = run(arguments);
    CHECK(o.status == status);
    CHECK(o.one_error_line());
    return o.err;
  };
  const auto with = [&](const std::string& backend) {
    return fmt::format("cosim {} --plan {} --backend {} --board-wait 0.2 -o {}", scene(),
                       scratch / "plan.toml", backend, scratch / "out");
  };
  CHECK_THAT(error(with("photon_gatherer=board:/nonexistent"), 1),
             ContainsSubstring("/nonexistent: cannot be opened: No such file"));
  CHECK_THAT(error(with("photon_gatherer=board:/dev/null"), 1),
             ContainsSubstring("/dev/null: is no serial port or pseudo-terminal"));
  CHECK_THAT(error(with("photon_gatherer=board:/dev/ttyS0@fast"), 2),
             ContainsSubstring("after @ expected a rate in baud"));
  CHECK_THAT(error(with("photon_gatherer=board"), 2), ContainsSubstring("board:DEVICE"));
  CHECK_THAT(error(with("reorder_buffer=board:/dev/ttyS0"), 2),
             ContainsSubstring("a board has photon_gatherer only"));
  CHECK_THAT(error("board info /nonexistent", 1), ContainsSubstring("cannot be opened"));
  const Outcome replayed = run("board replay /nonexistent " + scene() + " --photons 300");
  CHECK(replayed.status == 1);
  CHECK(replayed.one_error_line());  // before any progress of photons
  CHECK_THAT(error("board replay /dev/ttyS0@fast none.xml", 2),
             ContainsSubstring("after @ expected a rate in baud"));
  CHECK(run("board").status == 2);
  CHECK(run("board info").status == 2);

  // A terminal at whose other end nobody is.
  const int device = posix_openpt(O_RDWR | O_NOCTTY);
  REQUIRE(device >= 0);
  REQUIRE(grantpt(device) == 0);
  REQUIRE(unlockpt(device) == 0);
  CHECK_THAT(error(fmt::format("board info {} --board-wait 0.2", ptsname(device)), 1),
             ContainsSubstring("no answer for 0.2 seconds; nothing came at all"));
  close(device);
  CHECK(!std::filesystem::exists(scratch / "out"));
}
