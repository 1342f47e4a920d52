// SPDX-License-Identifier: Apache-2.0
// photonloom board info DEVICE, photonloom board replay DEVICE SCENE
#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <random>

#include "command/console.hpp"
#include "command/frame_options.hpp"
#include "command/json_text.hpp"
#include "golden/packet/signature.hpp"
#include "golden/plan/plan_file.hpp"
#include "host/board.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;

// What both commands take.
struct DeviceOptions {
  std::string device;
  double wait = 10;
  bool json = false;

  void add_to(CLI::App& c) {
    c.add_option("DEVICE", device,
                 "Serial port of the board, DEVICE@BAUD for another rate than " +
                     std::to_string(kDefaultBaud))
        ->required();
    c.add_option("--board-wait", wait, "Seconds without an answer before giving up (default 10)")
        ->check(number_range(0.1, 86400))
        ->type_name("S");
    c.add_flag("--json", json, "Print one JSON object");
  }
  Board open() const {
    DeviceName name;
    as_usage("DEVICE: ", [&] { name = parse_device(device); });
    return Board(open_serial(name, wait), wait);
  }
};

std::string megahertz(uint32_t khz) {
  return khz ? fmt::format("{} MHz", khz / 1000.0) : "none, it is simulated";
}

const char* self_test_text(uint32_t state) {
  switch (state) {
    case kTestNone:
      return "none";
    case kTestRunning:
      return "running";
    case kTestPassed:
      return "passed";
    case kTestFailed:
      return "FAILED";
    default:
      return "unknown";
  }
}

void info(const DeviceOptions& o) {
  Board board = o.open();
  const BoardState& s = board.first_state();
  Json all;
  all["device"] = board.name();
  all["version"] = s.version;
  all["plan_hash"] = fmt::format("{:016x}", s.plan_hash);
  all["gatherers"] = s.gatherers;
  all["clock_khz"] = s.clock_khz;
  all["rx_bytes"] = s.rx_bytes;
  all["session"] = s.session;
  all["queries_inside"] = (s.flags & kFlagQueriesInside) != 0;
  all["memory_ready"] = (s.flags & kFlagMemoryReady) != 0;
  all["replay_busy"] = (s.flags & kFlagReplayBusy) != 0;
  all["input_position"] = s.input_position;
  all["output_first"] = s.output_first;
  all["output_end"] = s.output_end;
  all["frames_bad"] = s.frames_bad;
  all["bytes_lost"] = s.bytes_lost;
  all["self_test"] = self_test_text(s.self_test);
  all["faults"] = s.faults;
  all["counters"] = s.counters;
  if (o.json) {
    fmt::print("{}\n", json_text(all));
    return;
  }
  const auto yes = [](bool value) { return value ? "yes" : "no"; };
  fmt::print("{}: a Photonloom board, host link version {}\n", board.name(), s.version);
  fmt::print("  {:<28}{:016x}\n", "plan", s.plan_hash);
  fmt::print("  {:<28}{}\n", "gatherers", s.gatherers);
  fmt::print("  {:<28}{}\n", "clock", megahertz(s.clock_khz));
  fmt::print("  {:<28}{}\n", "photon memory ready", yes(s.flags & kFlagMemoryReady));
  fmt::print("  {:<28}{}\n", "queries inside", yes(s.flags & kFlagQueriesInside));
  fmt::print("  {:<28}{}\n", "replayer busy", yes(s.flags & kFlagReplayBusy));
  fmt::print("  {:<28}{:08x}\n", "session", s.session);
  fmt::print("  {:<28}{} words in, {} to {} kept out\n", "streams", s.input_position,
             s.output_first, s.output_end);
  fmt::print("  {:<28}{} bad frames, {} bytes lost, {} bytes of frames held\n", "link",
             s.frames_bad, s.bytes_lost, s.rx_bytes);
  fmt::print("  {:<28}{}\n", "power-up self-test", self_test_text(s.self_test));
  fmt::print("  {:<28}{}\n", "wrong words of memory", s.faults);
  for (const char* name : link_counter_names())
    fmt::print("  {:<28}{}\n", name, s.counters.at(name));
}

// Hands queries on and keeps them.
class Keeping final : public ReorderBuffer {
 public:
  Keeping(std::unique_ptr<ReorderBuffer> unit, std::vector<GatherQuery>& kept)
      : unit_(std::move(unit)), kept_(kept) {}
  void process(std::span<const GatherQuery> in, std::vector<GatherQuery>& out) override {
    for (const GatherQuery& q : in)
      if (!q.flush) kept_.push_back(q);
    unit_->process(in, out);
  }
  Counters counters() const override { return unit_->counters(); }

 private:
  std::unique_ptr<ReorderBuffer> unit_;
  std::vector<GatherQuery>& kept_;
};

struct BoardReplayOptions {
  DeviceOptions device;
  FrameOptions frame;
  ThreadsOption threads;
  uint32_t passes = 100;
  uint64_t queries = 0, skip = 0;
  bool reorder = false, cold = false;
};

void replay_on_board(const BoardReplayOptions& o) {
  const FrameRequest request = o.frame.request();
  o.threads.apply();
  Board board = o.device.open();  // one that is not there is told before the work
  ConsoleProgress progress;
  PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, &progress);
  print_warnings(frame.warnings);
  const Plan& plan = frame.plan;
  board.check_plan(plan);
  const uint64_t room = static_cast<uint64_t>(plan.replay_queries) - (o.reorder ? 1 : 0);
  const uint64_t wanted = o.queries ? o.queries : room;
  if (wanted > room)
    throw std::runtime_error(
        fmt::format("--queries {}: the plan's replayer holds {} (board.replay_queries = {}{})",
                    wanted, room, plan.replay_queries, o.reorder ? ", one of them the flush" : ""));

  // The frame's final gather queries in the order in which rays hit.
  std::vector<GatherQuery> queries;
  FrameUnits units = make_golden_units(plan);
  units.reorder_buffer = std::make_unique<Keeping>(std::move(units.reorder_buffer), queries);
  FrameCounts counts;
  render_frame(frame.input(Arithmetic::kGolden), units, counts, &progress);
  if (o.skip >= queries.size())
    throw std::runtime_error(
        fmt::format("--skip {}: the frame has {} final gather queries", o.skip, queries.size()));
  queries.erase(queries.begin(), queries.begin() + static_cast<long>(o.skip));
  queries.resize(std::min<uint64_t>(queries.size(), wanted));
  if (o.reorder) {
    GatherQuery flush{};
    flush.flush = 1;
    queries.push_back(flush);
  }

  const auto golden = make_golden_photon_gatherer(plan);
  golden->load(frame.global, frame.caustic);
  std::vector<GatherQuery> ordered;
  if (o.reorder)
    make_golden_reorder_buffer(plan)->process(queries, ordered);
  else
    ordered = queries;
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  golden->process(ordered, results, photons);
  uint64_t full = 0, clamped = 0;  // flags of results, which the signature covers
  for (const GatherResult& r : results)
    if (!r.flush) full += r.full, clamped += r.clamped;
  ResultSignature signature(plan);
  for (uint32_t pass = 0; pass < o.passes; ++pass)
    for (const GatherResult& r : results) signature.add(r);

  Board::Replay did;
  uint64_t lines = 0;
  {
    const ProgressPhase phase(&progress, "board", 1, "replays");
    std::random_device random;
    uint32_t session = 0;
    while (session == 0 || session == board.first_state().session)
      session = static_cast<uint32_t>(random());
    board.start_session(session);
    board.load(plan, photon_gatherer_image(plan, frame.global, frame.caustic));
    const uint64_t before = board.state().counters.at("line requests");
    did = board.replay(plan, queries, o.passes,
                       (o.reorder ? kReplayReordered : 0) | (o.cold ? kReplayCold : 0));
    lines = board.state().counters.at("line requests") - before;
    phase.advance(1);
  }

  const uint64_t gathers = uint64_t{o.passes} * (queries.size() - (o.reorder ? 1 : 0));
  const double cycles = static_cast<double>(did.cycles) / static_cast<double>(gathers);
  const uint32_t khz = board.first_state().clock_khz;
  const bool same =
      did.signature == signature.value() && did.results == uint64_t{o.passes} * queries.size();
  if (o.device.json) {
    Json all;
    all["plan_hash"] = plan_hash_text(plan);
    all["gatherers"] = board.first_state().gatherers;
    all["clock_khz"] = khz;
    all["gathers"] = gathers;
    all["cycles"] = did.cycles;
    all["cycles_per_gather"] = cycles;
    if (khz) all["gathers_per_second"] = 1000.0 * khz / cycles;
    all["lines_per_gather"] = static_cast<double>(lines) / static_cast<double>(gathers);
    all["signature"] = fmt::format("{:016x}", did.signature);
    all["golden_full"] = full;
    all["golden_clamped"] = clamped;
    all["golden_signature"] = fmt::format("{:016x}", signature.value());
    fmt::print("{}\n", json_text(all));
  } else {
    fmt::print("{} gathers ({} queries, {} passes) on {} gatherers, k = {}, {} photons{}{}\n",
               gathers, gathers / o.passes, o.passes, board.first_state().gatherers, plan.k,
               plan.global.photons, o.reorder ? ", reordered" : "", o.cold ? ", cold caches" : "");
    fmt::print("{} cycles, {:.2f} a gather; {:.2f} lines requested a gather\n", did.cycles, cycles,
               static_cast<double>(lines) / static_cast<double>(gathers));
    if (khz) fmt::print("{:.0f} gathers a second at {}\n", 1000.0 * khz / cycles, megahertz(khz));
    fmt::print("signature {:016x}, golden {:016x}, {} results\n", did.signature, signature.value(),
               did.results);
    fmt::print("a pass of golden: {} results full, {} clamped\n", full, clamped);
  }
  if (!same) throw CheckFailed("the board's results are not golden's");
}

void add_board(CLI::App& app) {
  CLI::App* board = app.add_subcommand("board", "Talks to a board with a plan's bitstream");
  board->require_subcommand(1);
  board->footer(fmt::format(
      "docs/board.md says how a board gets there. To render a frame with its gatherers:\n"
      "  photonloom cosim SCENE --plan plan.toml --backend {}=board:DEVICE",
      unit_name<PhotonGatherer>));

  auto i = std::make_shared<DeviceOptions>();
  CLI::App* c = board->add_subcommand("info", "What the board is and what it has counted");
  i->add_to(*c);
  c->callback([i] { info(*i); });

  auto o = std::make_shared<BoardReplayOptions>();
  c = board->add_subcommand("replay", "The board's own rate, without its link");
  c->footer(
      "Puts final gather queries of the frame into the board's replayer, which plays them into "
      "the\n"
      "gatherers as fast as they take them. The board counts cycles and folds all results into a\n"
      "signature; exit status 0 when it is golden's.\n\n"
      "Example:\n"
      "  photonloom board replay /dev/ttyUSB0 scenes/cornell.xml --plan plan.toml --passes 1000");
  o->device.add_to(*c);
  o->frame.add_to(*c);
  c->add_option("--passes", o->passes, "How often the queries are played (default 100)")
      ->check(CLI::Range(1u, 1u << 30))
      ->type_name("N");
  c->add_option("--queries", o->queries, "How many (default: as many as the replayer holds)")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 32))
      ->type_name("N");
  c->add_option("--skip", o->skip, "Leaves out the frame's first queries")
      ->check(CLI::Range(uint64_t{0}, uint64_t{1} << 48))
      ->type_name("N");
  c->add_flag("--reorder", o->reorder, "Through the board's reorder buffer");
  c->add_flag("--cold", o->cold, "With caches that have forgotten everything");
  o->threads.add_to(*c);
  c->callback([o] { replay_on_board(*o); });
}

const Command board_command(52, add_board);

}  // namespace
}  // namespace photonloom
