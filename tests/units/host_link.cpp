// SPDX-License-Identifier: Apache-2.0
// The host's side of the link against a double of the board: bytes that are changed, lost or
// doubled, boards that go away, journals.
#include <fcntl.h>
#include <fmt/core.h>
#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <utility>

#include "golden/numeric/output_file.hpp"
#include "host/photon_gatherer.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "tests/fault_report.hpp"
#include "tests/photon_sets.hpp"
#include "tests/units/board_double.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

// A small plan with both maps, their photons, queries of every kind and golden's answers.
struct LinkCase {
  Plan plan;
  PhotonMap global, caustic;
  std::vector<GatherQuery> queries;
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;

  explicit LinkCase(size_t n = 300) {
    plan.k = 6;
    plan.global = {.present = true, .photons = 203, .r2_max = plan.r2_limit()};
    plan.caustic = {.present = true, .photons = 90, .r2_max = plan.r2_limit() / 64};
    plan.replay_queries = 512;
    global = build_photon_map(make_photons(plan, PointSet::kSurfaces, 203, 1), plan);
    caustic = build_photon_map(make_photons(plan, PointSet::kClustered, 90, 2), plan);
    for (size_t i = 0; i < n; ++i) {
      queries.push_back(make_query(plan, PointSet::kSurfaces, 3, i));
      queries.back().map = i % 5 == 0;
      queries.back().want_photons = i % 3 == 0;
      queries.back().flush = i % 41 == 40;
    }
    const auto golden = make_golden_photon_gatherer(plan);
    golden->load(global, caustic);
    golden->process(queries, results, photons);
  }

  std::unique_ptr<BoardDouble> board() const {
    auto double_ = std::make_unique<BoardDouble>(plan);
    double_->set_maps(global, caustic);
    return double_;
  }
};

struct Run {
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  Counters counters;
};

// All queries, in three calls.
Run run_on(const LinkCase& c, BoardOptions options) {
  BoardPhotonGatherer unit(c.plan, std::move(options));
  unit.load(c.global, c.caustic);
  Run run;
  const std::span<const GatherQuery> in = c.queries;
  const size_t cuts[] = {0, in.size() / 7, in.size() / 2, in.size()};
  for (size_t i = 0; i < 3; ++i)
    unit.process(in.subspan(cuts[i], cuts[i + 1] - cuts[i]), run.results, run.photons);
  run.counters = unit.counters();
  return run;
}

void check_equal(const LinkCase& c, const Run& run) {
  CHECK((run.results == c.results));  // in brackets: a list of packets tells nothing
  CHECK((run.photons == c.photons));
}

}  // namespace

TEST_CASE("CRC-32 and frames") {
  const std::string digits = "123456789";
  CHECK(link_crc({reinterpret_cast<const uint8_t*>(digits.data()), digits.size()}) == 0xCBF43926);
  const Bytes content{0xC0, 0x01, 0xDB, 0xDC, 0xDD, 0x00};
  const Bytes wire = encode_frame(content);
  const Bytes start{0xC0, 0xDB, 0xDC, 0x01, 0xDB, 0xDD, 0xDC, 0xDD, 0x00};
  CHECK(Bytes(wire.begin(), wire.begin() + static_cast<long>(start.size())) == start);
  CHECK(wire.back() == 0xC0);
  FrameDecoder decoder;
  for (int i = 0; i < 3; ++i) {
    std::optional<Bytes> got;
    for (const uint8_t byte : wire)
      if (auto g = decoder.take(byte)) got = g;
    REQUIRE(got);
    CHECK(*got == content);
  }
  CHECK(decoder.bad() == 0);
}

TEST_CASE("no frame with one byte changed, lost or doubled is taken for another") {
  Bytes content;
  for (int i = 0; i < 40; ++i) content.push_back(static_cast<uint8_t>(hash_bits(1, i, 0, 0)));
  content[5] = 0xC0;
  content[9] = 0xDB;
  const Bytes wire = encode_frame(content), next = encode_frame(Bytes{1, 2, 3});
  const auto check = [&](Bytes harmed) {
    harmed.insert(harmed.end(), next.begin(), next.end());
    FrameDecoder decoder;
    std::vector<Bytes> got;
    for (const uint8_t byte : harmed)
      if (auto g = decoder.take(byte)) got.push_back(*g);
    // The next frame always arrives; of this one everything or nothing.
    REQUIRE(!got.empty());
    CHECK(got.back() == Bytes{1, 2, 3});
    for (size_t i = 0; i + 1 < got.size(); ++i) CHECK(got[i] == content);
  };
  for (size_t at = 0; at + 1 < wire.size(); ++at) {
    for (int value = 0; value < 256; ++value) {
      Bytes harmed = wire;
      harmed[at] = static_cast<uint8_t>(value);
      check(harmed);
    }
    Bytes harmed = wire;
    harmed.erase(harmed.begin() + static_cast<long>(at));
    check(harmed);
    harmed = wire;
    harmed.insert(harmed.begin() + static_cast<long>(at), wire[at]);
    check(harmed);
  }
}

TEST_CASE("registers are those of docs/host-link.md") {
  const std::string page = read_file(source("docs/host-link.md"));
  const std::map<std::string, uint32_t> registers{{"Magic", kRegMagic},
                                                  {"Version", kRegVersion},
                                                  {"PlanHash", kRegPlanHash},
                                                  {"Session", kRegSession},
                                                  {"Gatherers", kRegGatherers},
                                                  {"RxBytes", kRegRxBytes},
                                                  {"InputRoom", kRegInputRoom},
                                                  {"InputPosition", kRegInputPosition},
                                                  {"OutputFirst", kRegOutputFirst},
                                                  {"ClockKHz", kRegClockKhz},
                                                  {"Flags", kRegFlags},
                                                  {"FramesBad", kRegFramesBad},
                                                  {"BytesLost", kRegBytesLost},
                                                  {"ReplayControl", kRegReplayControl},
                                                  {"ReplayQueries", kRegReplayQueries},
                                                  {"ReplayPasses", kRegReplayPasses},
                                                  {"ReplayMode", kRegReplayMode},
                                                  {"ReplayCycles", kRegReplayCycles},
                                                  {"ReplaySignature", kRegReplaySignature},
                                                  {"ReplayResults", kRegReplayResults},
                                                  {"SelfTest", kRegSelfTest},
                                                  {"Faults", kRegFaults}};
  const std::regex row("\\| ([0-9]+)[^|]* \\| `([A-Za-z]+)`");
  size_t rows = 0;
  for (std::sregex_iterator at(page.begin(), page.end(), row), end; at != end; ++at, ++rows) {
    INFO(at->str());
    REQUIRE(registers.count((*at)[2]));
    CHECK(registers.at((*at)[2]) == std::stoul((*at)[1]));
  }
  CHECK(rows == registers.size());

  // The page's words for the counters, in its order.
  const std::pair<const char*, const char*> counters[] = {
      {"cycles with a packet inside or a line fetched ahead", "busy"},
      {"queries", "queries"},
      {"nodes", "nodes"},
      {"leaves", "leaves"},
      {"insertions", "insertions"},
      {"lines requested", "line requests"},
      {"cycles the input waited", "stalls in"},
      {"cycles a result waited", "stalls results"},
      {"cycles a photon waited", "stalls photons"},
      {"reorder packets in", "reordered"},
      {"lines served by the photon memory", "lines served"},
      {"its busy cycles", "memory busy"}};
  std::string line = fmt::format("| {} ... | counters | two words each: ", int{kRegCounters});
  std::vector<std::string> names;
  for (const auto& [words, name] : counters) {
    line += fmt::format("{}{}", names.empty() ? "" : ", ", words);
    names.push_back(name);
  }
  CHECK_THAT(page, ContainsSubstring(line + "; 40 bits count |"));
  const auto listed = link_counter_names();
  CHECK(std::vector<std::string>(listed.begin(), listed.end()) == names);
}

TEST_CASE("a board answers as golden does") {
  const LinkCase c;
  const Scratch scratch;
  const auto board = c.board();
  const Run run =
      run_on(c, {.open = [&] { return std::make_unique<FaultyLink>(*board, Faults{}, 1); },
                 .device = "double",
                 .work_dir = scratch / "work"});
  check_equal(c, run);
  CHECK(board->loaded());
  CHECK(board->asked == c.queries.size());
  CHECK(run.counters.at("packets in") == c.queries.size());
  CHECK(run.counters.at("link frames again") == 0);
  CHECK(scratch.entries() == 1);
  CHECK(std::filesystem::is_empty(scratch / "work"));  // no journal is left
}

TEST_CASE("lines of both maps go where docs/host-link.md has them, compressed ones too") {
  for (const uint64_t further : {0, 25, 700}) {
    INFO("photon.further_percent " << further);
    Plan plan = LinkCase(0).plan;
    plan.bucket = 16;
    plan.photon_bytes = 10;
    plan.photon_lines = further ? PhotonLines::kCompressed : PhotonLines::kPlain;
    plan.further_percent = static_cast<int>(further);
    // The global map's lines as the page counts them: L + ceil(L * P / 100).
    const uint64_t leaves = (203 + 15) / 16, first = leaves + (leaves * further + 99) / 100;
    PhotonGathererImage image;
    image.lines[0].resize(160 * first);
    image.lines[1].resize(160 * 3);
    std::map<uint64_t, uint32_t> due;
    uint64_t at = 0;
    for (std::vector<uint8_t>& bytes : image.lines)
      for (uint8_t& byte : bytes) {
        byte = static_cast<uint8_t>(hash_bits(1, at, 0, 0));
        due[at / 4] |= uint32_t{byte} << (8 * (at % 4));
        ++at;
      }
    BoardDouble double_(plan);
    Board board(std::make_unique<FaultyLink>(double_, Faults{}, 1), 10);
    board.load(plan, image);
    CHECK((double_.lines() == due));
  }
}

TEST_CASE("a board's counters go on behind 2^40, and stalls out are results' and photons'") {
  const LinkCase c;
  const Scratch scratch;
  const auto board = c.board();
  board->counters.fill((uint64_t{1} << 40) - 7);
  board->each_adds = {10, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7};
  const Run run =
      run_on(c, {.open = [&] { return std::make_unique<FaultyLink>(*board, Faults{}, 1); },
                 .device = "double",
                 .work_dir = scratch / "work"});
  check_equal(c, run);
  Counters due{{"queries", 0}, {"nodes", 0}, {"leaves", 0}, {"insertions", 0}};
  for (const GatherResult& r : c.results) {
    due["queries"] += !r.flush;
    due["nodes"] += r.nodes;
    due["leaves"] += r.leaves;
    due["insertions"] += r.insertions;
  }
  const uint64_t n = c.queries.size();
  due.insert({{"busy", 10 * n},
              {"cycles", 10 * n},
              {"line requests", n},
              {"stalls in", 2 * n},
              {"stalls results", 3 * n},
              {"stalls photons", 4 * n},
              {"stalls out", 7 * n},
              {"reordered", 5 * n},
              {"lines served", 6 * n},
              {"memory busy", 7 * n}});
  for (const auto& [name, count] : due) {
    INFO(name);
    CHECK(run.counters.at(name) == count);
  }
}

TEST_CASE("a count that may have carried between its two words is read again") {
  const LinkCase c(1);
  const auto double_ = c.board();
  Board board(std::make_unique<FaultyLink>(*double_, Faults{}, 1), 10);
  constexpr uint64_t kCarry = uint64_t{1} << 32;
  for (const uint64_t at : {kCarry - 3, kCarry - 2, kCarry - 1, kCarry, kCarry + 1}) {
    double_->busy_adds = 0;
    double_->counters.fill(at);
    CHECK(board.state().counters.at("busy") == at);  // it stands still
    double_->busy_adds = 1000;
    const uint64_t busy = board.state().counters.at("busy");
    INFO(at << " became " << busy);
    CHECK(busy >= at);
    CHECK(busy <= at + 1000);
  }
}

TEST_CASE("harmed bytes cost time and no packet") {
  const LinkCase c;
  FaultyLink::Log log;
  const auto run_with = [&](const Faults& faults, uint64_t seed) {
    const Scratch scratch;
    const auto board = c.board();
    board->rx_bytes = seed % 2 ? 600 : 4000;
    board->output_room = seed % 3 ? 60 : 1000;
    log = {};
    const Run run = run_on(c, {.open =
                                   [&] {
                                     auto link = std::make_unique<FaultyLink>(*board, faults, seed);
                                     link->log = &log;
                                     return link;
                                   },
                               .device = "double",
                               .wait = 1000,
                               .work_dir = scratch / "work"});
    check_equal(c, run);
    CHECK(board->asked == c.queries.size());  // each query once, however often it was sent
    return run;
  };
  double clean = 0;  // seconds without a fault
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    run_with({}, seed);
    clean += log.seconds;
  }

  const std::pair<const char*, Faults> kinds[] = {{"byte changed", {300, 0, 0}},
                                                  {"byte lost", {0, 300, 0}},
                                                  {"byte doubled", {0, 0, 300}},
                                                  {"any of these, rarely", {900, 900, 900}},
                                                  {"any of these, often", {400, 400, 400}}};
  uint64_t all_again = 0;
  for (const auto& [kind, faults] : kinds) {
    FaultRow row;
    row.fault = kind;
    row.where = "link, the program's side";
    double seconds = 0;
    uint64_t again = 0;
    for (uint64_t seed = 1; seed <= 6; ++seed) {
      INFO(kind << ", seed " << seed);
      const Run run = run_with(faults, seed);
      again += run.counters.at("link frames again");
      row.injected += log.harmed;
      row.wrong += (run.results != c.results) + (run.photons != c.photons);
      seconds += log.seconds;
    }
    // Several harmed bytes of one frame are one frame again; one at a frame's end may cost none.
    row.detected = std::min(again, row.injected);
    row.harmless = row.injected - row.detected;
    row.recovery = fmt::format("{:.1f} ms a byte harmed, at 10 us a byte",
                               1e3 * (seconds - clean) / static_cast<double>(row.injected));
    report(row);
    all_again += again;
  }
  CHECK(all_again > 500);
}

TEST_CASE("a link that harms a byte in 220 is slow, and not lost") {
  const LinkCase c;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    INFO("seed " << seed);
    FaultyLink::Log log;
    const auto run_with = [&](const Faults& faults) {
      const Scratch scratch;
      const auto board = c.board();
      board->rx_bytes = seed % 2 ? 600 : 4000;
      log = {};
      const Run run = run_on(c, {.open =
                                     [&] {
                                       auto link =
                                           std::make_unique<FaultyLink>(*board, faults, seed);
                                       link->log = &log;
                                       return link;
                                     },
                                 .device = "double",
                                 .work_dir = scratch / "work"});
      check_equal(c, run);
      CHECK(board->asked == c.queries.size());
      CHECK(run.counters.at("link lost") == 0);
      return run;
    };
    run_with({});
    const double clean = log.seconds;
    const Run run = run_with({.corrupt = 500, .drop = 400});
    CHECK(log.seconds < 8 * clean);
    // Each byte that was harmed costs its frame, or what is sent in vain behind it.
    CHECK(run.counters.at("link frames again") < 2 * log.harmed);
  }
}

TEST_CASE("a wire of any slow rate is waited for, not written full") {
  const LinkCase c(60);
  for (const double byte_seconds : {1e-4, 2.6e-4, 5.2e-4, 1e-3, 2.5e-3}) {
    INFO(byte_seconds << " s a byte");
    const Scratch scratch;
    const auto board = c.board();
    board->rx_bytes = 2048;
    const Run run = run_on(c, {.open =
                                   [&] {
                                     auto link = std::make_unique<FaultyLink>(*board, Faults{}, 1);
                                     link->byte_seconds = byte_seconds;
                                     return link;
                                   },
                               .device = "double",
                               .work_dir = scratch / "work"});
    check_equal(c, run);
    CHECK(run.counters.at("link lost") == 0);
    // Until the slowest round trip is known, a few frames are taken for lost.
    CHECK(run.counters.at("link frames again") < 30);
  }
}

TEST_CASE("a board that comes back goes on, with or without its memory") {
  const LinkCase c;
  for (const bool reset : {false, true}) {
    const Scratch scratch;
    const auto board = c.board();
    uint64_t opened = 0;
    std::vector<std::string> told;
    const Run run =
        run_on(c, {.open =
                       [&] {
                         if (opened && reset) board->reset();
                         const uint64_t until_lost = opened == 0 || reset ? 6500 : 1500;
                         ++opened;
                         return std::make_unique<FaultyLink>(*board, Faults{}, 1, until_lost);
                       },
                   .device = "double",
                   .work_dir = scratch / "work",
                   .tell = [&](const std::string& text) { told.push_back(text); }});
    check_equal(c, run);
    CHECK(opened >= 3);
    CHECK(run.counters.at("link lost") == opened - 1);
    REQUIRE(told.size() == 2 * (opened - 1));
    CHECK(told[0] == "double: is gone; waiting 10 seconds for it to come back");
    CHECK(told[1] == "double is back");
    const PhotonGathererImage image = photon_gatherer_image(c.plan, c.global, c.caustic);
    CHECK(board->loads == (reset ? opened : 1) * image.cfg.size());
  }
}

TEST_CASE("a board that is reset while its link stays") {
  const LinkCase c;
  for (uint64_t at = 5600; at < 9000; at += 97) {
    INFO("after " << at << " bytes");
    const Scratch scratch;
    const auto board = c.board();
    uint64_t opened = 0;
    const Run run = run_on(c, {.open =
                                   [&] {
                                     auto link = std::make_unique<FaultyLink>(*board, Faults{}, 1);
                                     if (opened++ == 0) link->reset_board_at = at;
                                     return link;
                                   },
                               .device = "double",
                               .work_dir = scratch / "work"});
    check_equal(c, run);
    CHECK(opened == 2);
  }
}

TEST_CASE("a board that stays away is given up, and the next run goes on") {
  const LinkCase c;
  const Scratch scratch;
  const auto board = c.board();
  bool plugged = true;
  BoardOptions options{.open = [&]() -> std::unique_ptr<ByteLink> {
                         if (!plugged) throw LinkLost("double: cannot be opened");
                         plugged = false;
                         return std::make_unique<FaultyLink>(*board, Faults{}, 1, 9000);
                       },
                       .device = "double",
                       .wait = 0.3,
                       .work_dir = scratch / "work"};
  std::string message;
  try {
    run_on(c, options);
  } catch (const LinkLost& lost) {
    message = lost.what();
  }
  CHECK_THAT(message, ContainsSubstring("double: did not come back within 0.3 seconds; ") &&
                          ContainsSubstring(" answers are kept in ") &&
                          ContainsSubstring(", the same command goes on after them"));
  REQUIRE(std::distance(std::filesystem::directory_iterator(scratch / "work"), {}) == 1);
  const std::string journal = std::filesystem::directory_iterator(scratch / "work")->path();

  const uint64_t asked = board->asked;
  CHECK(asked > 40);
  CHECK(asked < c.queries.size());
  const auto second = [&](bool resume) {
    board->asked = 0;
    board->reset();
    return run_on(c, {.open = [&] { return std::make_unique<FaultyLink>(*board, Faults{}, 1); },
                      .device = "double",
                      .work_dir = scratch / "work",
                      .resume = resume});
  };

  SECTION("from the last answer that came") {
    const Run run = second(true);
    check_equal(c, run);
    const uint64_t resumed = run.counters.at("packets resumed");
    CHECK(resumed > 30);
    CHECK(resumed <= asked);
    CHECK(board->asked == c.queries.size() - resumed);
    CHECK(!std::filesystem::exists(journal));
  }
  SECTION("or from the start") {
    const Run run = second(false);
    check_equal(c, run);
    CHECK(board->asked == c.queries.size());
  }
  SECTION("a journal cut off or damaged anywhere is used up to there") {
    const std::string whole = read_file(journal);
    for (size_t at = 0; at < whole.size(); at += whole.size() / 23) {
      for (const bool cut : {true, false}) {
        std::string harmed = cut ? whole.substr(0, at) : whole;
        if (!cut) harmed[at] = static_cast<char>(harmed[at] ^ 0x40);
        write_file(journal, harmed);
        const Run run = second(true);
        check_equal(c, run);
        CHECK(board->asked >= c.queries.size() - asked);
        CHECK(board->asked == c.queries.size() - run.counters.at("packets resumed"));
      }
    }
  }
  SECTION("a run that asks something else takes only what it asks for") {
    LinkCase other;
    std::swap(other.queries[20], other.queries[21]);
    other.results.clear();
    other.photons.clear();
    const auto golden = make_golden_photon_gatherer(other.plan);
    golden->load(other.global, other.caustic);
    golden->process(other.queries, other.results, other.photons);
    board->asked = 0;
    const Run run =
        run_on(other, {.open = [&] { return std::make_unique<FaultyLink>(*board, Faults{}, 1); },
                       .device = "double",
                       .work_dir = scratch / "work"});
    check_equal(other, run);
    CHECK(run.counters.at("packets resumed") == 20);
    CHECK(board->asked == c.queries.size() - 20);
  }
}

TEST_CASE("a journal keeps answers with as many photons as a plan can have") {
  LinkCase c(20);
  c.plan.k = 256;  // the most
  const Scratch scratch;
  GatherResult result{};
  result.count = 256;
  std::vector<GatherPhoton> photons(256);
  for (size_t i = 0; i < photons.size(); ++i) photons[i].index = static_cast<uint32_t>(i % 200);
  {
    Journal journal(c.plan, "map", scratch / "work", true);
    for (const GatherQuery& q : c.queries) journal.add(q, result, photons);
  }
  Journal journal(c.plan, "map", scratch / "work", true);
  CHECK(journal.kept() == c.queries.size());
  for (const GatherQuery& q : c.queries) {
    GatherResult kept;
    std::vector<GatherPhoton> kept_photons;
    REQUIRE(journal.take(q, kept, kept_photons));
    CHECK((kept == result));
    CHECK((kept_photons == photons));
  }
}

TEST_CASE("what answers must be this plan's bitstream") {
  const LinkCase c(10);
  const auto board = c.board();
  const auto message = [&] {
    try {
      BoardPhotonGatherer unit(
          c.plan, {.open = [&] { return std::make_unique<FaultyLink>(*board, Faults{}, 1); },
                   .device = "double",
                   .wait = 0.1});
      return std::string("accepted");
    } catch (const WrongBoard& wrong) {
      return std::string(wrong.what());
    } catch (const LinkLost& lost) {
      return std::string(lost.what());
    }
  };
  CHECK(message() == "accepted");
  board->hash ^= 0x100;
  CHECK_THAT(message(),
             ContainsSubstring(fmt::format("double: holds the bitstream of plan {:016x}, but this "
                                           "is plan {}; build the bitstream",
                                           board->hash, plan_hash_text(c.plan))));
  board->version = 9;
  CHECK_THAT(message(),
             ContainsSubstring("speaks version 9 of the host link, this program version 1"));
  board->magic = 1;
  CHECK_THAT(message(), ContainsSubstring("this is no Photonloom board"));
  board->mute = true;
  CHECK_THAT(message(), ContainsSubstring("double: no answer for 0.1 seconds"));
}

TEST_CASE("a link on which no frame comes through whole is told as such") {
  const LinkCase c(1);
  const Scratch scratch;
  const auto board = c.board();
  std::string said;
  try {
    run_on(c,
           {.open = [&] { return std::make_unique<FaultyLink>(*board, Faults{.corrupt = 8}, 1); },
            .device = "double",
            .wait = 0.1,
            .work_dir = scratch / "work"});
  } catch (const LinkLost& lost) {
    said = lost.what();
  }
  INFO(said);
  CHECK(std::regex_search(
      said, std::regex("double: no whole answer for 0.1 seconds, [1-9][0-9]* damaged ones?;")));
}

TEST_CASE("a silent board is asked again after a second, and then every two") {
  const LinkCase c(1);
  const auto board = c.board();
  board->mute = true;
  Connection connection(std::make_unique<FaultyLink>(*board, Faults{}, 1), 60);
  CHECK_THROWS_WITH(connection.read(kRegMagic, 1), "double: no answer for 60 seconds");
  CHECK(connection.counts().frames == 1);
  CHECK(connection.counts().repeated == 30);  // after 1, 3, 5 ... 59 seconds
  CHECK(connection.counts().timeouts == 30);
}

TEST_CASE("noise full of frame ends asks once for each frame that is unanswered") {
  // What the host reads first is a burst of small damaged frames.
  constexpr size_t kDamaged = 500;
  class NoisyLink final : public ByteLink {
   public:
    explicit NoisyLink(BoardDouble& board) : wire_(board, Faults{}, 1) {}
    const std::string& name() const override { return wire_.name(); }
    double now() const override { return wire_.now(); }
    void write(std::span<const uint8_t> bytes) override { wire_.write(bytes); }
    size_t read(std::span<uint8_t> to, double seconds) override {
      if (std::exchange(heard_, true)) return wire_.read(to, seconds);
      for (size_t i = 0; i < 2 * kDamaged; ++i) to[i] = i % 2 ? 0xC0 : 0x55;
      return 2 * kDamaged;
    }

   private:
    FaultyLink wire_;
    bool heard_ = false;
  };
  const LinkCase c(1);
  const auto board = c.board();
  Connection connection(std::make_unique<NoisyLink>(*board), 60);
  connection.set_window(1000);
  int answers = 0;
  const Bytes body{kRegMagic, 0, 0, 0, 1};
  for (int i = 0; i < 3; ++i)
    connection.send(LinkCommand::kRead, body, [&](std::span<const uint8_t>) { ++answers; });
  connection.drain();
  CHECK(answers == 3);
  CHECK(connection.counts().bad_answers == kDamaged);
  CHECK(connection.counts().repeated == 3);
}

TEST_CASE("a board that hangs or says too much") {
  const LinkCase c(40);
  const Scratch scratch;
  const auto board = c.board();
  const auto run = [&] {
    return run_on(c, {.open = [&] { return std::make_unique<FaultyLink>(*board, Faults{}, 1); },
                      .device = "double",
                      .wait = 0.2,
                      .work_dir = scratch / "work"});
  };
  SECTION("a packet too many is handed on") {
    board->one_photon_too_many = true;
    CHECK(run().photons != c.photons);
  }
  SECTION("no result is not waited for without end") {
    board->stuck = true;
    CHECK_THROWS_WITH(run(), ContainsSubstring("the board answers, but no result came for 0.2 "
                                               "seconds, after 0 of 5 queries"));
  }
}

TEST_CASE("a replay through the link") {
  const LinkCase c(200);
  const auto double_ = c.board();
  Board board(std::make_unique<FaultyLink>(*double_, Faults{500, 500, 500}, 3), 1000);
  board.start_session(77);
  board.load(c.plan, photon_gatherer_image(c.plan, c.global, c.caustic));
  const Board::Replay one = board.replay(c.plan, c.queries, 1, 0);
  const Board::Replay two = board.replay(c.plan, c.queries, 2, 0);
  CHECK(one.results == c.queries.size());
  CHECK(two.results == 2 * c.queries.size());
  CHECK(one.signature != two.signature);
  CHECK_THROWS_WITH(board.replay(c.plan, {}, 1, 0), ContainsSubstring("holds 1 to 512"));
  // The number behind the greatest is not 0, which starts nothing.
  const uint32_t greatest = 0xffffffff;
  REQUIRE(board.connection().write_status(kRegReplayControl, {&greatest, 1}) == 0);
  CHECK(board.replay(c.plan, c.queries, 3, 0).results == 3 * c.queries.size());
  CHECK(board.connection().read(kRegReplayControl, 1)[0] == 1);
}

TEST_CASE("names of devices") {
  CHECK(parse_device("/dev/ttyUSB0").path == "/dev/ttyUSB0");
  CHECK(parse_device("/dev/ttyUSB0").baud == kDefaultBaud);
  CHECK(parse_device("/dev/ttyUSB0@3000000").baud == 3000000);
  CHECK(parse_device("/dev/ttyUSB0@300").baud == 300);  // the least
  CHECK(parse_device("/dev/a@b@115200").path == "/dev/a@b");
  for (const char* wrong :
       {"", "@115200", "/dev/ttyUSB0@", "/dev/ttyUSB0@fast", "/dev/ttyUSB0@1", "/dev/ttyUSB0@299"})
    CHECK_THROWS_AS(parse_device(wrong), std::runtime_error);
}

TEST_CASE("serial ports") {
  CHECK_THROWS_WITH(open_serial({"/nonexistent/tty", 115200}),
                    ContainsSubstring("/nonexistent/tty: cannot be opened: No such file"));
  CHECK_THROWS_WITH(open_serial({"/dev/null", 115200}),
                    "/dev/null: is no serial port or pseudo-terminal");

  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  REQUIRE(master >= 0);
  REQUIRE(grantpt(master) == 0);
  REQUIRE(unlockpt(master) == 0);
  const std::string name = ptsname(master);
  const auto port = open_serial({name, 3000000});
  CHECK_THROWS_WITH(open_serial({name, 3000000}),
                    ContainsSubstring("is in use by another program"));
  // Every byte passes both ways as it is, those that mean something to a terminal too.
  Bytes all(256);
  for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<uint8_t>(i);
  Bytes got(512);
  port->write(all);
  CHECK(::read(master, got.data(), got.size()) == 256);
  got.resize(256);
  CHECK(got == all);
  REQUIRE(::write(master, all.data(), all.size()) == 256);
  Bytes back;
  while (back.size() < 256) {
    const size_t n = port->read(got, 1);
    REQUIRE(n > 0);
    back.insert(back.end(), got.begin(), got.begin() + static_cast<long>(n));
  }
  CHECK(back == all);
  CHECK(port->read(got, 0.01) == 0);
  close(master);
  CHECK_THROWS_AS(port->read(got, 1), LinkLost);
}

TEST_CASE("a board that takes no bytes is waited for as long as was asked") {
  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  REQUIRE(master >= 0);
  REQUIRE(grantpt(master) == 0);
  REQUIRE(unlockpt(master) == 0);
  const std::string name = ptsname(master);
  const auto port = open_serial({name, 3000000}, 0.2);
  const Bytes much(1 << 20);  // more than a pseudo-terminal holds
  CHECK_THROWS_WITH(port->write(much), name + ": takes no bytes for 0.2 seconds");
  close(master);
}
