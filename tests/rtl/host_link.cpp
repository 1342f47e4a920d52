// SPDX-License-Identifier: Apache-2.0
// The board's side of docs/host-link.md, byte by byte on the UART's wires.
#include "tests/rtl/link_bench.hpp"

using namespace photonloom;
using namespace photonloom::test;

TEST_CASE("host link: registers and what no address holds") {
  Bench bench;
  CHECK((bench.board().leds() & 0x80) == 0);
  const uint64_t hash = plan_hash(bench.plan());
  const Words all = bench.read(0, 64);
  REQUIRE(all.size() == 64);
  CHECK(all[0] == 0x4D4C4850);
  CHECK(all[1] == 1);
  CHECK(all[2] == static_cast<uint32_t>(hash));
  CHECK(all[3] == static_cast<uint32_t>(hash >> 32));
  CHECK(all[4] == 0);
  CHECK(all[5] == 2);
  CHECK(all[6] >= 2 * 2 * 272);
  CHECK(all[7] >= 64);
  for (const size_t zero : {8, 9, 10, 11, 13, 14, 15, 16, 19, 20, 26, 31, 56, 63})
    CHECK(all[zero] == 0);
  CHECK(all[12] == 2);  // nothing inside, memory there
  bench.run(4);
  CHECK((bench.board().leds() & 0x80) != 0);
  for (const uint32_t address : {64u, 0x0fffffffu, kCfg, kLines, kQueries, 0xffffffffu})
    CHECK(bench.reg(address) == 0);

  CHECK(bench.write(0, {1}) == 1);
  CHECK(bench.write(5, {1}) == 1);
  CHECK(bench.write(20, {1}) == 1);
  CHECK(bench.write(64, {1}) == 1);
  CHECK(bench.write(0x40000000, {1}) == 1);
  CHECK(bench.write(kSession, {77}) == 0);
  CHECK(bench.reg(kSession) == 77);
  CHECK(bench.write(17, {0}) == 1);
  CHECK(bench.write(17, {65}) == 1);
  CHECK(bench.write(17, {64, 3, 2}) == 0);
  CHECK(bench.read(16, 4) == Words{0, 64, 3, 2});
  CHECK(bench.write(18, {0}) == 1);
  CHECK(bench.reg(18) == 3);
  const auto words_of_lines =
      static_cast<uint32_t>((75 + 23) * static_cast<uint32_t>(bench.plan().line_bytes()) / 4);
  CHECK(bench.write(kLines + words_of_lines - 1, {1}) == 0);
  CHECK(bench.write(kLines + words_of_lines - 1, {1, 2}) == 1);
  CHECK(bench.write(kCfg + 2 * (75 + 23), {1, 2}) == 1);
  CHECK(bench.write(kCfg + 2 * 0x800000, {0, 0}) == 0);
  CHECK(bench.write(kCfg + 2 * 0x800005, {0, 0}) == 1);
  CHECK(bench.write(kCfg + 2 * 3 + 1, {1}) == 1);  // half a pair
  CHECK(bench.write(kCfg + 2 * 3, {1, 2, 3}) == 1);
  CHECK(bench.write(kQueries + 4 * 64, {1}) == 1);
  CHECK(bench.reg(13) == 0);
}

TEST_CASE("host link: no damaged frame is obeyed, and the link goes on behind it") {
  Bench bench;
  Bytes body;
  append(body, 1);
  body.push_back(2);
  const Bytes good = frame(9, kRead, body);
  uint32_t bad = 0;
  const auto probe = [&] {
    CHECK(bench.read(1, 1) == Words{1});
    CHECK(bench.reg(13) == bad);
  };
  const auto refused = [&](const Bytes& wire, const char* what) {
    INFO(what);
    bench.send(wire);
    const std::vector<Answer> answers = bench.settle();
    REQUIRE(answers.size() == 1);
    CHECK(answers[0].bad());
    ++bad;
    probe();
  };
  const auto content = [](Bytes c) {  // with its CRC
    append(c, crc32(c));
    return stuffed(c);
  };

  // Every byte between the ENDs altered, left out and doubled.
  const Answer right = [&] {
    bench.send(good);
    return bench.next();
  }();
  CHECK(right.words().size() == 2);
  RoleRandom random(1, "damage");
  for (size_t at = 1; at + 1 < good.size(); ++at) {
    Bytes wire = good;
    do wire[at] = static_cast<uint8_t>(good[at] ^ (1 + random.below(255)));
    while (wire[at] == 0xC0 || wire[at] == 0xDB);
    refused(wire, "altered");
    wire = good;
    wire.erase(wire.begin() + static_cast<ptrdiff_t>(at));
    if (good[at] != good[at - 1] && good[at] != good[at + 1]) refused(wire, "left out");
    Bytes doubled(good.size() + 1);
    for (size_t i = 0; i < doubled.size(); ++i) doubled[i] = good[i <= at ? i : i - 1];
    refused(doubled, "doubled");
  }

  refused(stuffed({}) == Bytes{0xC0, 0xC0} ? stuffed({1}) : Bytes{}, "one byte");
  refused(stuffed({1, 1, 2, 3, 4}), "five bytes");
  refused(content({}), "four bytes, a CRC of nothing");
  refused(content({7}), "no command");
  refused(content({7, kRead}), "no body");
  refused(content({7, kRead, 0, 0, 0, 0, 0}), "n = 0");
  refused(content({7, kRead, 0, 0, 0, 0, 65}), "n = 65");
  refused(content({7, kRead, 0, 0, 0, 0, 1, 0}), "a byte more");
  refused(content({7, kWrite, 4, 0, 0, 0}), "no word");
  refused(content({7, kWrite, 4, 0, 0, 0, 1, 2, 3}), "three quarters of a word");
  refused(content({7, kPull, 0, 0, 0, 0, 0, 0, 0, 0, 0}), "PULL, n = 0");
  refused(content({7, kPull, 0, 0, 0, 0, 1}), "PULL without keep");
  for (const int command : {0, 5, 0x7f, 0x81, 0xff})
    refused(content({7, static_cast<uint8_t>(command), 0, 0, 0, 0, 1}), "unknown command");
  for (const size_t words : {size_t{65}, size_t{66}, size_t{128}, size_t{400}}) {
    Bytes big{7, kWrite, 4, 0, 0, 0};
    for (size_t i = 0; i < words; ++i) append(big, static_cast<uint32_t>(i));
    refused(content(big), "too long");
  }
  Bytes escape = good;
  escape.insert(escape.begin() + 3, 0xDB);
  refused(escape, "an escape before what needs none");
  escape = good;
  escape.insert(escape.end() - 1, 0xDB);
  refused(escape, "an escape before END");
  CHECK(bench.reg(kSession) == 0);

  // Ends: more of them are nothing, a missing one costs the frames that it joins.
  Bytes ends = good;
  ends.insert(ends.begin(), 5, 0xC0);
  ends.insert(ends.end(), 3, 0xC0);
  bench.send(ends);
  std::vector<Answer> answers = bench.settle();
  REQUIRE(answers.size() == 1);
  CHECK(answers[0].words() == right.words());
  Bytes joined(good.begin(), good.end() - 1);
  joined.insert(joined.end(), good.begin(), good.end());
  bench.send(joined);  // one END between two frames
  CHECK(bench.settle().size() == 2);
  joined.assign(good.begin(), good.end() - 1);
  joined.insert(joined.end(), good.begin() + 1, good.end());
  bench.send(joined);  // none
  answers = bench.settle();
  REQUIRE(answers.size() == 1);
  CHECK(answers[0].bad());
  ++bad;
  probe();

  // Frames behind one another are answered in order; noise between them is one bad frame.
  bench.send(frame(1, kRead, body));
  bench.send({0x55, 0xAA, 0xDB, 0x00});
  bench.send(frame(2, kRead, body));
  bench.send(frame(3, kRead, body));
  answers = bench.settle();
  REQUIRE(answers.size() == 4);
  CHECK(answers[0].id == 1);
  CHECK(answers[1].bad());
  CHECK(answers[2].id == 2);
  CHECK(answers[3].id == 3);
  ++bad;
  probe();
  CHECK((bench.board().leds() & 0x40) != 0);
}

TEST_CASE("host link: RxBytes wait, what comes beyond is lost and counted") {
  Bench bench;
  const uint32_t room = bench.reg(6);
  // Requests are shorter than their answers, so they pile up.
  Bytes body;
  append(body, 0);
  body.push_back(20);
  Bytes window;
  size_t frames = 0;
  for (;; ++frames) {
    const Bytes f = frame(static_cast<uint8_t>(frames + 1), kRead, body);
    if (window.size() + f.size() > room) break;
    window.insert(window.end(), f.begin(), f.end());
  }
  bench.send(window);
  std::vector<Answer> answers = bench.settle();
  REQUIRE(answers.size() == frames);
  for (size_t i = 0; i < frames; ++i) CHECK(answers[i].id == i + 1);
  CHECK(bench.reg(14) == 0);

  Bytes twice = window;
  for (int i = 0; i < 2; ++i) twice.insert(twice.end(), window.begin(), window.end());
  bench.send(twice);
  answers = bench.settle();
  CHECK(answers.size() > frames);
  CHECK(answers.size() < 3 * frames);
  size_t whole = 0;  // bytes
  for (const Answer& a : answers)
    if (!a.bad()) whole += frame(a.id, kRead, body).size();
  bench.send({0xC0});  // ends what the lost bytes left open
  answers = bench.settle();
  CHECK((answers.empty() || (answers.size() == 1 && answers[0].bad())));
  // What was taken is the frames that were answered, and of others a part.
  const uint32_t lost = bench.reg(14), unanswered = static_cast<uint32_t>(twice.size() - whole);
  CHECK(lost > 0);
  CHECK(lost <= unanswered);
  CHECK(2 * lost > unanswered);
  CHECK(bench.reg(1) == 1);
}

TEST_CASE("host link: LEDs 1 and 2 tell of bytes received and bytes sent") {
  Bench bench;
  const auto lit = [&] { return bench.board().leds() & 0x06; };
  bench.run(5000);  // a tenth of a second and more, as the LEDs count without a clock's frequency
  CHECK(lit() == 0);
  bench.send({0x55});  // a frame without its end, which is not answered
  bench.run(100);
  CHECK(lit() == 0x02);
  bench.run(5000);
  CHECK(lit() == 0);
  // The answer takes longer than the LED of what was received is lit.
  Bytes body;
  append(body, 0);
  body.push_back(64);
  bench.send({0xC0});
  bench.next();
  bench.run(5000);
  bench.send(frame(1, kRead, body));
  bool both = false, sent = false;
  for (int i = 0; i < 300; ++i) {
    bench.run(50);
    both |= lit() == 0x06;
    sent |= lit() == 0x04;
  }
  CHECK(both);
  CHECK(sent);
  CHECK(lit() == 0);
}

TEST_CASE("host link: queries in any pieces, results in any windows") {
  Bench bench;
  const Plan& plan = bench.plan();
  const uint64_t seed = 11;
  INFO("seed " << seed);
  RoleRandom random(seed, "windows");
  bench.load(seed);
  REQUIRE(bench.write(kSession, {5}) == 0);
  const std::vector<GatherQuery> list = queries(plan, 400, seed, true);
  const Words in = packed(plan, list);
  const Streams golden = golden_records(bench, list);
  size_t whole = golden.results.size() * (1 + golden.results[0].size());
  whole += golden.photons.size() * (1 + golden.photons[0].size());

  Words out;
  uint32_t next = 0, kept = 0;
  bool gap = false, again = false, full = false, late = false, early = false;
  for (int rounds = 0; out.size() < whole; ++rounds) {
    REQUIRE(rounds < 20000);
    if (next < in.size()) {
      // From before, at or after the next word.
      const auto back = static_cast<uint32_t>(random.below(4) == 0 ? random.below(70) : 0);
      const auto ahead = static_cast<uint32_t>(random.below(8) == 0 ? 1 + random.below(3) : 0);
      const uint32_t from = next - std::min(back, next) + ahead;
      const size_t n =
          std::min<size_t>(1 + random.below(64), in.size() - std::min<size_t>(from, in.size() - 1));
      if (from >= in.size()) continue;
      const auto begin = in.begin() + from;
      const Bench::Pushed answer =
          bench.push(from, Words(begin, begin + static_cast<ptrdiff_t>(n)));
      if (from > next) {
        CHECK(answer.next == next);
        gap = true;
      } else if (from + n <= next) {
        CHECK(answer.next == next);
        again = true;
      } else {
        CHECK(answer.next >= next);
        CHECK(answer.next <= from + n);
        if (answer.next < from + n) full = true;
      }
      next = answer.next;
      // Nothing is taken out for a while, so that both streams fill.
      if (next > 60 && next < in.size() && !full) continue;
    }
    const auto position = static_cast<uint32_t>(out.size());
    const auto n = static_cast<uint8_t>(1 + random.below(64));
    const uint64_t kind = random.below(10);
    if (kind == 0) {  // after the end
      const Bench::Pulled got = bench.pull(position + 100000, n, kept);
      CHECK(got.words.empty());
      CHECK(got.position == got.end);
      late = true;
    } else if (kind == 1 && kept > 0) {  // forgotten
      const Bench::Pulled got = bench.pull(kept - 1, n, 0);
      CHECK(got.words.empty());
      CHECK(got.position == kept);
      early = true;
    } else {
      // `keep` anywhere among what is here: the words from there on can be asked for again.
      const uint32_t keep =
          position - std::min(position - kept, static_cast<uint32_t>(random.below(30)));
      const Bench::Pulled got = bench.pull(position, n, keep);
      kept = keep;
      REQUIRE(got.position == position);
      CHECK(got.words.size() == std::min<size_t>(n, got.end - position));
      out.insert(out.end(), got.words.begin(), got.words.end());
      if (keep < out.size()) {
        const Bench::Pulled same = bench.pull(keep, 1, keep);
        REQUIRE(same.words.size() == 1);
        CHECK(same.words[0] == out[keep]);
      }
    }
  }
  CHECK(gap);
  CHECK(again);
  CHECK(full);
  CHECK(late);
  CHECK(early);
  CHECK(bench.reg(8) == in.size());
  CHECK(bench.reg(10) == out.size());
  const Streams got = records(plan, out);
  CHECK(got.results == golden.results);
  CHECK(got.photons == golden.photons);
  CHECK(bench.reg(kFlags) == 2);
  const Words counted = bench.read(32, 24);
  const Counters due = bench.golden().counters();
  size_t at = 2;
  for (const char* name : {"queries", "nodes", "leaves", "insertions"}) {
    INFO(name);
    CHECK(counted[at] == due.at(name));
    CHECK(counted[at + 1] == 0);
    at += 2;
  }
}

TEST_CASE("host link: each counter stands where its page has it") {
  Plan plan = small_plan();
  plan.photon_memory = PhotonMemory::kSdram;
  plan.beat_bits = 8 * plan.photon_bytes;
  plan.board_cache_bytes = 8 * plan.line_bytes();
  Bench bench(plan);
  bench.load(12);
  REQUIRE(bench.write(kSession, {5}) == 0);
  const auto counted = [&] {
    const Words words = bench.read(32, 24);
    std::vector<uint64_t> counts;
    for (size_t i = 0; i < words.size(); i += 2)
      counts.push_back(words[i] | uint64_t{words[i + 1]} << 32);
    return counts;
  };
  enum {
    kBusy,
    kAsked,
    kNodes,
    kLeaves,
    kInsertions,
    kRequests,
    kIn,
    kResults,
    kPhotons,
    kReordered,
    kServed,
    kMemoryBusy
  };
  // Queries until the board is full of what nobody takes out; then all of it.
  uint32_t next = 0, taken = 0;
  const auto fill = [&](const std::vector<GatherQuery>& list) {
    const Words in = packed(plan, list);
    const uint32_t first = next;
    const auto push = [&] {
      const auto from = in.begin() + (next - first);
      const auto n = std::min<ptrdiff_t>(60, in.end() - from);
      const uint32_t before = next;
      next = bench.push(next, Words(from, from + n)).next;
      return next != before;
    };
    for (int idle = 0; idle < 4;) {
      idle = push() ? 0 : idle + 1;
      bench.run(4000);
    }
    REQUIRE(next - first < in.size());
    const std::vector<uint64_t> full = counted();
    for (int silent = 0; silent < 8 || next - first < in.size();) {
      if (next - first < in.size()) push();
      const Bench::Pulled got = bench.pull(taken, 64, taken);
      taken += static_cast<uint32_t>(got.words.size());
      silent = got.words.empty() ? silent + 1 : 0;
      bench.run(1000);
    }
    REQUIRE(bench.reg(kFlags) == 2);
    return full;
  };

  std::vector<GatherQuery> list = queries(plan, 400, 12, false);
  for (GatherQuery& q : list) q.flush = 0;
  golden_records(bench, list);
  const std::vector<uint64_t> results = fill(list);
  CHECK(results[kIn] > 10000);
  CHECK(results[kResults] > 10000);
  CHECK(results[kPhotons] == 0);
  const std::vector<uint64_t> now = counted();
  const Counters due = bench.golden().counters();
  CHECK(now[kAsked] == due.at("queries"));
  CHECK(now[kNodes] == due.at("nodes"));
  CHECK(now[kLeaves] == due.at("leaves"));
  CHECK(now[kInsertions] == due.at("insertions"));
  // Of the leaves some lines are in a gatherer's cache, of the rest some in the board's; an SDRAM
  // takes more cycles for a line than there are halfwords in it.
  CHECK(now[kRequests] < now[kLeaves]);
  CHECK(now[kServed] < now[kRequests]);
  CHECK(now[kServed] > 100);
  CHECK(now[kMemoryBusy] > now[kServed] * static_cast<uint64_t>(plan.line_bytes()) / 4);
  CHECK(now[kBusy] > now[kResults]);
  CHECK(now[kReordered] == 0);

  for (GatherQuery& q : list) q.want_photons = 1;
  const std::vector<uint64_t> photons = fill(list);
  CHECK(photons[kPhotons] > 10000);

  const uint32_t replayed = 20;
  list[replayed - 1].flush = 1;  // else they stay in the reorder buffer
  Words words;
  for (uint32_t i = 0; i < replayed; ++i) {
    Words one = packed(plan, list[i]);
    one.resize(std::bit_ceil(one.size()));
    words.insert(words.end(), one.begin(), one.end());
  }
  REQUIRE(bench.write(kQueries, words) == 0);
  REQUIRE(bench.write(17, {replayed, 1, 1}) == 0);
  REQUIRE(bench.write(kControl, {1}) == 0);
  for (int i = 0; bench.reg(kFlags) != 2; ++i) REQUIRE(i < 1000);
  CHECK(counted()[kReordered] == replayed);
}

TEST_CASE("host link: queries are dealt in turn, also where all gatherers are idle") {
  Bench bench;
  bench.load(61);
  REQUIRE(bench.write(kSession, {1}) == 0);
  const Words query = packed(bench.plan(), queries(bench.plan(), 1, 61, false));
  // Each gatherer that is asked for the first time fetches the lines into its own cache.
  std::vector<uint32_t> fetched;
  for (uint32_t i = 0; i < 4; ++i) {
    const uint32_t before = bench.reg(42);
    bench.push(i * static_cast<uint32_t>(query.size()), query);
    bench.settle(3000);
    REQUIRE(bench.reg(kFlags) == 2);
    fetched.push_back(bench.reg(42) - before);
  }
  CHECK(fetched[0] > 0);
  CHECK(fetched == std::vector<uint32_t>{fetched[0], fetched[0], 0, 0});
}

TEST_CASE(
    "host link: a full output stalls the gatherers, not the link; a new session empties both") {
  Bench bench;
  const Plan& plan = bench.plan();
  bench.load(21);
  const std::vector<GatherQuery> list = queries(plan, 400, 21, true);
  const Words in = packed(plan, list);
  for (const uint32_t session : {3u, 4u}) {
    REQUIRE(bench.write(kSession, {session}) == 0);
    CHECK(bench.read(8, 3) == Words{0, 0, 0});
    uint32_t next = 0, room = 1;
    for (int i = 0; room > 0; ++i) {
      REQUIRE(i < 200);
      const auto begin = in.begin() + next;
      const size_t n = std::min<size_t>(64, in.size() - next);
      const Bench::Pushed answer =
          bench.push(next, Words(begin, begin + static_cast<ptrdiff_t>(n)));
      next = answer.next;
      room = answer.room;
    }
    CHECK(bench.reg(kFlags) == 3);
    CHECK((bench.board().leds() & 0x08) != 0);
    const uint32_t end = bench.reg(10);
    CHECK(end > 900);
    bench.run(20000);
    CHECK(bench.reg(10) == end);
    // What may not be written while queries are inside.
    CHECK(bench.write(kCfg, {0, 0}) == 2);
    CHECK(bench.write(kLines, {0}) == 2);
    CHECK(bench.write(kQueries, {0}) == 2);
    CHECK(bench.write(17, {1}) == 2);
    CHECK(bench.write(kControl, {9}) == 1 + 1);
    CHECK(bench.write(kControl, {0}) == 0);
    CHECK(bench.write(kSession, {session}) == 0);  // the same: nothing happens
    CHECK(bench.read(8, 3) == Words{next, 0, end});
  }
  // Half a query of the old session is not part of the first of the new one.
  REQUIRE(bench.write(kSession, {6}) == 0);
  bench.push(0, {in[0]});
  CHECK(bench.reg(kFlags) == 3);
  REQUIRE(bench.write(kSession, {7}) == 0);
  CHECK(bench.reg(kFlags) == 2);
  const std::vector<GatherQuery> few(list.begin(), list.begin() + 20);
  bench.push(0, packed(plan, few));
  bench.settle();
  const Streams golden = golden_records(bench, few);
  Words out;
  for (uint32_t end = 1; out.size() < end;) {
    const Bench::Pulled got =
        bench.pull(static_cast<uint32_t>(out.size()), 64, static_cast<uint32_t>(out.size()));
    end = got.end;
    out.insert(out.end(), got.words.begin(), got.words.end());
  }
  const Streams got = records(plan, out);
  CHECK(got.results == golden.results);
  CHECK(got.photons == golden.photons);
}

TEST_CASE("host link: the replayer's results are golden's, straight and reordered") {
  Bench bench;
  const Plan& plan = bench.plan();
  bench.load(31);
  std::vector<GatherQuery> list = queries(plan, 64, 31, true);  // want_photons is taken as 0
  for (GatherQuery& q : list) q.flush = false;
  list.back().flush = true;
  std::vector<GatherQuery> plain = list;
  for (GatherQuery& q : plain) q.want_photons = false;
  const size_t words = PacketLayout::of<GatherQuery>(plan).words();
  size_t stride = 1;
  while (stride < words) stride *= 2;
  Words memory;
  for (const GatherQuery& q : list) {
    Words one = packed(plan, q);
    one.resize(stride, 0xffffffff);
    memory.insert(memory.end(), one.begin(), one.end());
  }
  REQUIRE(bench.write(kQueries, memory) == 0);
  CHECK(bench.write(kControl, {1}) == 1);  // not without queries and passes

  const auto signature = [&](const std::vector<GatherQuery>& order, uint32_t passes) {
    ResultSignature s(plan);
    std::vector<GatherResult> results;
    std::vector<GatherPhoton> photons;
    for (uint32_t i = 0; i < passes; ++i) bench.golden().process(order, results, photons);
    for (const GatherResult& r : results) s.add(r);
    return s.value();
  };
  uint32_t control = 0;
  const auto finish = [&] {
    for (int i = 0; bench.reg(kFlags) != 2; ++i) REQUIRE(i < 2000);
    const Words r = bench.read(20, 6);
    return std::array<uint64_t, 3>{r[0] | uint64_t{r[1]} << 32, r[2] | uint64_t{r[3]} << 32,
                                   r[4] | uint64_t{r[5]} << 32};
  };
  for (const uint32_t mode : {0u, 2u, 1u, 3u})
    for (const uint32_t passes : {1u, 3u}) {
      INFO("mode " << mode << ", passes " << passes);
      REQUIRE(bench.write(17, {64, passes, mode}) == 0);
      REQUIRE(bench.write(kControl, {++control}) == 0);
      REQUIRE(bench.write(kControl, {control}) == 0);  // once more: nothing
      const auto [cycles, sum, results] = finish();
      std::vector<GatherQuery> order = plain;
      if (mode & 1) {
        order.clear();
        make_golden_reorder_buffer(plan)->process(plain, order);
        CHECK(order.size() == plain.size());
      }
      CHECK(results == 64 * passes);
      CHECK(sum == signature(order, passes));
      CHECK(cycles > results);
    }

  // One query again and again is soon in the caches, until they forget.
  std::vector<uint32_t> lines;
  for (const uint32_t mode : {0u, 0u, 2u}) {
    const uint32_t before = bench.reg(42);
    REQUIRE(bench.write(17, {1, 8, mode}) == 0);
    REQUIRE(bench.write(kControl, {++control}) == 0);
    CHECK(finish()[2] == 8);
    lines.push_back(bench.reg(42) - before);
  }
  CHECK(lines[1] < lines[2]);

  // One query alone: the cycles go on until its result, as those with a packet inside do.
  REQUIRE(bench.write(17, {1, 1, 0}) == 0);
  const uint32_t before = bench.reg(32);
  REQUIRE(bench.write(kControl, {++control}) == 0);
  const auto [cycles, sum, results] = finish();
  const uint32_t inside = bench.reg(32) - before;
  CHECK(results == 1);
  CHECK(sum == signature({plain[0]}, 1));
  CHECK(inside > 20);
  CHECK(cycles >= inside);
  CHECK(cycles <= inside + 2);

  // A replay that would take for ever is stopped, its buffer emptied.
  for (const uint32_t mode : {0u, 1u}) {
    REQUIRE(bench.write(17, {20, 0xffffffff, mode}) == 0);
    REQUIRE(bench.write(kControl, {++control}) == 0);
    CHECK(bench.write(kControl, {control + 100}) == 2);
    CHECK(bench.write(kCfg, {0, 0}) == 2);
    // What can never be written is told before what only has to wait, wherever it stands.
    CHECK(bench.write(kControl - 1, {0, control + 100}) == 1);
    CHECK(bench.write(19, {0, 0}) == 1);
    CHECK((bench.reg(kFlags) & 4) != 0);
    CHECK((bench.board().leds() & 0x10) != 0);
    if (mode == 0)
      REQUIRE(bench.write(kControl, {0}) == 0);
    else
      REQUIRE(bench.write(kSession, {control}) == 0);
    CHECK(finish()[2] > 20);
    CHECK(bench.reg(kControl) == 0);
  }
  REQUIRE(bench.write(17, {64, 1, 1}) == 0);
  REQUIRE(bench.write(kControl, {++control}) == 0);
  std::vector<GatherQuery> order;
  make_golden_reorder_buffer(plan)->process(plain, order);
  CHECK(finish()[1] == signature(order, 1));

  // Queries pushed meanwhile wait, and come out as ever.
  REQUIRE(bench.write(kSession, {99}) == 0);
  const std::vector<GatherQuery> few(list.begin(), list.begin() + 10);
  REQUIRE(bench.write(17, {64, 20, 1}) == 0);
  REQUIRE(bench.write(kControl, {++control}) == 0);
  bench.push(0, packed(plan, few));
  CHECK((bench.reg(kFlags) & 4) != 0);
  finish();
  bench.settle();
  const Streams golden = golden_records(bench, few);
  Words out;
  for (uint32_t end = 1; out.size() < end;) {
    const Bench::Pulled got =
        bench.pull(static_cast<uint32_t>(out.size()), 64, static_cast<uint32_t>(out.size()));
    end = got.end;
    out.insert(out.end(), got.words.begin(), got.words.end());
  }
  CHECK(records(plan, out).results == golden.results);
  CHECK(records(plan, out).photons == golden.photons);
}

TEST_CASE("host link: other divisors, and a far end whose clock is 2 % off") {
  // Of the link alone, whose model is small; every address reads as what the test puts there.
  for (const int divisor : {4, 5, 17, 217})
    for (const double off : {0.98, 1.0, 1.02}) {
      INFO("divisor " << divisor << ", far end's bit " << off);
      BoardRun run;
      run.work_dir = "cosim";
      run.module = "host_link";
      run.clocks_per_bit = divisor;
      run.wire_clocks = off * divisor;
      Bench bench(small_plan(), run);
      RoleRandom random(static_cast<uint64_t>(divisor), "words");
      for (int round = 0; round < 3; ++round) {
        const auto word = static_cast<uint32_t>(random.bits());
        bench.board().set("read_word_i", word);
        const auto n = static_cast<uint8_t>(divisor > 100 ? 2 : 40);
        CHECK(bench.read(0, n) == Words(n, word));
      }
      CHECK(bench.board().wire().framing_errors() == 0);
    }
}

TEST_CASE("host link: a start bit that is none and a byte without its stop bit are no bytes") {
  BoardRun run;
  run.work_dir = "cosim";
  run.module = "host_link";
  run.clocks_per_bit = 17;
  Bench bench(small_plan(), run);
  bench.board().set("read_word_i", 0x12345678);
  uint64_t received = 0;
  const auto count = [&](uint64_t cycles) {
    for (uint64_t i = 0; i < cycles; ++i) {
      bench.board().cycle();
      received += bench.board().get("byte_received_o");
    }
  };
  for (const double bits : {0.1, 0.2, 0.3, 0.4, 9.8, 12.0, 50.0}) {
    INFO("line 0 for " << bits << " bits");
    bench.board().wire().hold_low(bits);
    count(60 * 17);
    CHECK(received == 0);
    CHECK(bench.read(0, 1) == Words{0x12345678});
  }
  bench.board().wire().hold_low(0.7);  // as a byte of ones
  count(20 * 17);
  CHECK(received == 1);
}

TEST_CASE("host link: with every second frame damaged all packets are golden's") {
  soak({.work_dir = "cosim"}, small_plan(), 41, 60);
}
