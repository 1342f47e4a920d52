// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/generate/schedule.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "golden/unit/reorder_buffer.hpp"
#include "hls_kernels/cdf_sampler/timing.hpp"
#include "hls_kernels/irradiance_cache/timing.hpp"
#include "hls_kernels/photon_gatherer/timing.hpp"
#include "hls_kernels/reorder_buffer/timing.hpp"

namespace photonloom {

namespace {

using photonloom_hls::CacheTiming;
using photonloom_hls::GathererTiming;
using photonloom_hls::ReorderTiming;
using photonloom_hls::SamplerTiming;

int ceil_of(int a, int b) { return (a + b - 1) / b; }

double parts_of(const Plan& plan) { return static_cast<double>(plan.bucket) / plan.lanes; }
// The share of insertions that take a step of their own: about half the lanes of a part face the
// query, so many insertions come in one part, whose first is in the part's own step.
double further_insertions(const Plan& plan) { return 1 - 1 / std::max(1.0, plan.lanes / 2.0); }

// Whether a query ended at the plan's bound on leaves, with subtrees that nobody looked at.
bool ends_early(uint32_t leaf_limit, const GatherResult& r) {
  return leaf_limit > 0 && r.leaves == leaf_limit;
}
// Subtrees that were taken off the stack: each one, or those that led to a leaf.
double unstacked(uint32_t leaf_limit, const GatherResult& r) {
  return ends_early(leaf_limit, r) ? r.leaves - 1.0 : r.nodes;
}

// The turns of the gatherer's loop `search`, played out from each query's counts: whose turn it is
// takes a step, the line port gives a beat, the oldest query that is done leaves. Where the steps
// of a query stand between its leaves is not known, so they are spread evenly.
class SearchTurns {
 public:
  SearchTurns(const Plan& plan, std::span<const GatherQuery> in, std::span<const GatherResult> out,
              const LinesALeaf& lines)
      : contexts_(static_cast<size_t>(kernel_contexts(plan))),
        beats_{lines.global * 8.0 * plan.line_bytes() / plan.beat_bits,
               lines.caustic * 8.0 * plan.line_bytes() / plan.beat_bits},
        leaf_limit_(plan.leaf_limit),
        parts_(parts_of(plan)),
        further_(further_insertions(plan)),
        in_(in),
        out_(out),
        ready_(out.size(), false),
        context_of_(out.size()) {}

  uint64_t play() {
    for (turn_ = 0; given_ < out_.size(); ++turn_) {
      step(turn_ % contexts_.size());
      leave();
    }
    return turn_;
  }

 private:
  enum class State { kIdle, kWalk, kWait, kLeaf, kLast, kLeave };
  struct Context {
    State state = State::kIdle;
    size_t query = 0;
    uint64_t leaf = 0;   // that it is on its way to, or in
    uint64_t steps = 1;  // left of this state
    uint64_t wake = 0;   // turn from which on it can go on
  };

  const GatherResult& result(const Context& c) const { return out_[c.query]; }
  // What falls to part `i` where `all` are spread over `parts`.
  static uint64_t share(double all, uint64_t i, uint64_t parts) {
    const double each = all / static_cast<double>(parts);
    return static_cast<uint64_t>(each * static_cast<double>(i + 1)) -
           static_cast<uint64_t>(each * static_cast<double>(i));
  }
  bool gives_photons(size_t query) const {
    return in_[query].want_photons && !in_[query].flush && out_[query].count > 0;
  }

  void step(size_t number) {
    Context& c = contexts_[number];
    if (turn_ < c.wake) return;
    if (c.state == State::kWait) {
      c.state = State::kLeaf;
      const GatherResult& r = result(c);
      c.steps = std::max<uint64_t>(
          1, share(r.leaves * parts_ + r.insertions * further_, c.leaf, r.leaves));
    }
    if (c.state == State::kLeave) c.state = State::kIdle;
    if (c.state == State::kIdle) {
      if (started_ == out_.size() || started_ - given_ >= 2 * contexts_.size()) return;
      c = {};
      c.query = started_++;
      context_of_[c.query] = number;
      if (result(c).leaves == 0)
        c.state = State::kLast;
      else
        walk(c);
      return;
    }
    if (--c.steps > 0) return;
    if (c.state == State::kWalk) {
      ask(c);
    } else if (c.state == State::kLeaf) {
      if (++c.leaf < result(c).leaves) {
        walk(c);
      } else {
        c.state = State::kLast;  // no subtree is left; the result
        c.steps = ends_early(leaf_limit_, result(c)) ? 1 : 2;
      }
    } else {
      ready_[c.query] = true;
      c.state = State::kIdle;
      if (gives_photons(c.query)) {
        c.state = State::kLeave;
        c.wake = ~uint64_t{0};
      }
    }
  }

  // Each inner node once down and, its other child, once up.
  void walk(Context& c) {
    c.state = State::kWalk;
    const GatherResult& r = result(c);
    c.steps = share(r.nodes + unstacked(leaf_limit_, r), c.leaf, r.leaves);
    if (c.steps == 0 && c.leaf > 0) c.steps = 1;
    if (c.steps == 0) ask(c);
  }

  void ask(Context& c) {
    c.state = State::kWait;
    port_ = std::max(port_, static_cast<double>(turn_)) + beats_[in_[c.query].map];
    c.wake = static_cast<uint64_t>(std::ceil(port_)) + GathererTiming::kLineTurns;
  }

  // A result or a photon of the oldest query.
  void leave() {
    if (giving_ == 0) {
      if (!ready_[given_]) return;
      if (gives_photons(given_))
        giving_ = out_[given_].count;
      else
        ++given_;
    } else if (--giving_ == 0) {
      contexts_[context_of_[given_]].wake = turn_ + GathererTiming::kFreeTurns;
      ++given_;
    }
  }

  std::vector<Context> contexts_;
  std::array<double, 2> beats_;  // of a leaf of each map
  uint32_t leaf_limit_;
  double parts_, further_;
  std::span<const GatherQuery> in_;
  std::span<const GatherResult> out_;
  std::vector<bool> ready_;
  std::vector<size_t> context_of_;
  size_t started_ = 0, given_ = 0;
  uint64_t turn_ = 0, giving_ = 0;
  double port_ = 0;  // turn in which the line port is free
};

}  // namespace

int KernelLoop::interval() const {
  int least = 1;
  for (const LoopDependency& d : dependencies)
    least = std::max(least, ceil_of(d.latency, d.distance));
  return least;
}

int kernel_contexts(const Plan& plan) {
  return static_cast<int>(std::bit_ceil(
      static_cast<unsigned>(std::max(GathererTiming::kLeastContexts, plan.contexts))));
}

std::vector<KernelLoop> kernel_loops(std::type_identity<PhotonGatherer>, const Plan& plan) {
  return {
      {"search",
       {{"state of a context", GathererTiming::kStepLatency, kernel_contexts(plan),
         "a step reads what the context's last step wrote; the others take their steps between"},
        {"buffer_", GathererTiming::kStepLatency, GathererTiming::kLineTurns,
         "a leaf line, read that many turns after its last "
         "beat was asked for"},
        {"store_, keys_ of a query that leaves", GathererTiming::kStepLatency,
         GathererTiming::kFreeTurns, "the context starts again that many turns later"}}},
      {"finish", {{"none", 1, 1, "a result needs nothing of the one before"}}}};
}

std::vector<KernelLoop> kernel_loops(std::type_identity<ReorderBuffer>, const Plan& plan) {
  if (plan.reorder_key == ReorderKey::kNone)
    return {{"run", {{"none", 1, 1, "packets pass through"}}}};
  return {{"run",
           {{"length_", ReorderTiming::kLengthLatency, 1,
             "whether the current bin is empty decides the bin (read 1, choose 1) whose length is "
             "changed (read 1, write 1)"},
            {"head_", ReorderTiming::kHeadLatency, 1,
             "head_ to next_ to head_: read 1, read 1, write 1"}}}};
}

std::vector<KernelLoop> kernel_loops(std::type_identity<CdfSampler>, const Plan&) {
  return {{"collect",
           {{"power_", SamplerTiming::kPowerLatency, SamplerTiming::kPowerTurns,
             "read-add-write over two turns, the last sum forwarded"}}},
          {"cosine", {{"total", 1, 1, "one addition"}}},
          {"weigh", {{"sum", 1, 1, "one addition, after the weight is known"}}},
          {"search", {{"none", 1, 1, "a memory for each level: requests follow each other"}}}};
}

std::vector<KernelLoop> kernel_loops(std::type_identity<IrradianceCache>, const Plan&) {
  return {{"run",
           {{"weights_", 1, 1, "a comparison with each of the heaviest"},
            {"records_, records_count_", CacheTiming::kDecideLatency, CacheTiming::kDecideTurns,
             "whether the point becomes a record is known when its last weight is"}}}};
}

TripCounts trip_counts(const Plan& plan, std::span<const GatherQuery> in,
                       std::span<const GatherResult> out, const LinesALeaf& lines) {
  const auto turns = static_cast<double>(SearchTurns(plan, in, out, lines).play());
  double nodes = 0, subtrees = 0, leaves = 0, insertions = 0;
  for (const GatherResult& r : out) {
    nodes += r.nodes;
    subtrees +=
        unstacked(plan.leaf_limit, r) + (r.leaves > 0 && !ends_early(plan.leaf_limit, r) ? 1 : 0);
    leaves += r.leaves;
    insertions += r.insertions;
  }
  const auto packets = static_cast<double>(out.size());
  std::vector<TurnTerm> terms = {
      {"start and end", 2 * packets},
      {"inner nodes", nodes},
      {"stacked subtrees", subtrees},
      {"parts of leaves", leaves * parts_of(plan)},
      {"further insertions of a part", insertions * further_insertions(plan)}};
  double steps = 0;
  for (const TurnTerm& t : terms) steps += t.turns;
  terms.push_back({"contexts that wait", turns - steps});
  return {{turns, packets}, 0, terms};
}

TripCounts trip_counts(const Plan& plan, std::span<const GatherQuery> in) {
  const bool fullest = plan.reorder_drain == ReorderDrain::kFullest;
  const auto packets = static_cast<double>(in.size());
  if (plan.reorder_key == ReorderKey::kNone) return {{packets}, 0, {{"packets", packets}}};
  const auto capacity = static_cast<size_t>(plan.reorder_packets);
  double flushed = 0, looks = 0;  // how often the fullest bin is looked for
  std::vector<size_t> length(static_cast<size_t>(plan.reorder_bins), 0);
  size_t held = 0, current = 0, fixed = 0;
  const auto leave = [&] {
    if (fixed == 0) {
      ++looks;
      const auto fullest_bin = std::max_element(length.begin(), length.end());
      current = static_cast<size_t>(fullest_bin - length.begin());
      fixed = *fullest_bin;
    }
    --length[current];
    --fixed;
    --held;
  };
  for (const GatherQuery& q : in) {
    if (q.flush) {
      flushed += static_cast<double>(held);  // one of them leaves in the flush's own turn
      while (held > 0) leave();
      fixed = 0;
    } else {
      ++length[reorder_bin(plan, q.position)];
      if (++held == capacity) leave();
    }
  }
  // 8 bins a turn; the packet that was to leave does so a turn later.
  const double look = std::max(1, plan.reorder_bins / ReorderTiming::kBinsALook) + 1;
  const double looking = fullest ? looks * look : 0;
  return {{packets + flushed + looking},
          0,
          {{"packets", packets},
           {"packets before a flush", flushed},
           {"looking for the fullest bin", looking}}};
}

TripCounts trip_counts(const Plan& plan, std::span<const SamplerInput> in) {
  const double cells = std::size_t{1} << (2 * plan.cell_bits);
  const auto packets = static_cast<double>(in.size());
  double tables = 0, requests = 0, cleared = 0;
  bool open = false, closed = false, photons = false;
  for (const SamplerInput& p : in) {
    if (p.kind == 0) {
      if (open && !closed && photons) cleared += 1;  // a table that nobody asked is cleared
      open = true;
      closed = photons = false;
    } else if (p.kind == 1) {
      photons = true;
    } else if (open) {
      requests += 1;
      if (!closed) tables += 1;
      closed = true;
    }
  }
  const std::vector<TurnTerm> terms = {{"packets", packets},
                                       {"cells", (tables + cleared) * cells},
                                       {"requests that wait for their table", tables}};
  const double collect = packets + (tables + cleared) * cells + tables;
  // The last table's weights follow its cosines.
  return {{collect, tables * (cells + 1), tables * (cells + 1), tables * (cells + 1) + requests},
          cells,
          terms};
}

// A turn a record, and those of the decision, of reading and of answering. How many records a tile
// has by then golden says.
TripCounts trip_counts(const Plan& plan, std::span<const CacheLookup> in) {
  std::vector<CacheResult> out;
  make_golden_irradiance_cache(plan)->process(in, out);
  double compared = 0, records = 0;
  for (size_t i = 0; i < in.size(); ++i) {
    if (in[i].clear) records = 0;
    compared += records;
    records += out[i].inserted;
  }
  const auto packets = static_cast<double>(in.size());
  const double decided = packets * CacheTiming::kDecideTurns;
  return {{2 * packets + compared + decided},
          0,
          {{"lookups and answers", 2 * packets}, {"records", compared}, {"decisions", decided}}};
}

double modelled_cycles(const std::vector<KernelLoop>& loops, const TripCounts& trips) {
  double most = 0;
  for (size_t i = 0; i < loops.size(); ++i)
    most = std::max(most, trips.turns.at(i) * loops[i].interval());
  return most + trips.fill;
}

}  // namespace photonloom
