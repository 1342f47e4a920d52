// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/generate/schedule.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace photonloom {

namespace {

// As in the gatherer's kernel.
constexpr int kStepLatency = 12, kLineTurns = 32, kFreeTurns = 12;
// As in the irradiance cache's kernel.
constexpr int kDecideLatency = 14, kDecideTurns = 16;

int ceil_of(int a, int b) { return (a + b - 1) / b; }

// Visits a turn to a server that takes `service` turns for each, by `customers` who are `beside`
// turns elsewhere between two visits: mean value analysis (Reiser, Lavenberg 1980), where who finds
// the server busy waits for half a service of the one before him.
double closed_throughput(int customers, double beside, double service) {
  double waiting = 0, throughput = 0;
  for (int n = 1; n <= customers; ++n) {
    const double busy = throughput * service;
    const double visit = service * (1 + waiting - busy / 2);
    throughput = n / (beside + visit);
    waiting = throughput * visit;
  }
  return throughput;
}

}  // namespace

int KernelLoop::interval() const {
  int least = 1;
  for (const LoopDependency& d : dependencies)
    least = std::max(least, ceil_of(d.latency, d.distance));
  return least;
}

int kernel_contexts(const Plan& plan) {
  return static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(4, plan.contexts))));
}

std::vector<KernelLoop> kernel_loops(std::type_identity<PhotonGatherer>, const Plan& plan) {
  return {
      {"search",
       {{"state of a context", kStepLatency, kernel_contexts(plan),
         "a step reads what the context's last step wrote; the others take their steps between"},
        {"buffer_", kStepLatency, kLineTurns,
         "a leaf line, read that many turns after its last "
         "beat was asked for"},
        {"store_, keys_ of a query that leaves", kStepLatency, kFreeTurns,
         "the context starts again that many turns later"}}},
      {"finish", {{"none", 1, 1, "a result needs nothing of the one before"}}}};
}

std::vector<KernelLoop> kernel_loops(std::type_identity<ReorderBuffer>, const Plan& plan) {
  if (plan.reorder_key == ReorderKey::kNone)
    return {{"run", {{"none", 1, 1, "packets pass through"}}}};
  return {{"run",
           {{"length_", 4, 1,
             "whether the current bin is empty decides the bin (read 1, choose 1) whose length is "
             "changed (read 1, write 1)"},
            {"head_", 3, 1, "head_ to next_ to head_: read 1, read 1, write 1"}}}};
}

std::vector<KernelLoop> kernel_loops(std::type_identity<CdfSampler>, const Plan&) {
  return {{"collect", {{"power_", 2, 2, "read-add-write over two turns, the last sum forwarded"}}},
          {"cosine", {{"total", 1, 1, "one addition"}}},
          {"weigh", {{"sum", 1, 1, "one addition, after the weight is known"}}},
          {"search", {{"none", 1, 1, "a memory for each level: requests follow each other"}}}};
}

std::vector<KernelLoop> kernel_loops(std::type_identity<IrradianceCache>, const Plan&) {
  return {{"run",
           {{"weights_", 1, 1, "a comparison with each of the heaviest"},
            {"records_, records_count_", kDecideLatency, kDecideTurns,
             "whether the point becomes a record is known when its last weight is"}}}};
}

TripCounts trip_counts(const Plan& plan, std::span<const GatherQuery> in,
                       std::span<const GatherResult> out) {
  const int contexts = kernel_contexts(plan);
  const double parts = static_cast<double>(plan.bucket) / plan.lanes;
  // About half the lanes of a part face the query: so many insertions come in one part, each a
  // step, of which the part itself counts one.
  const double together = std::max(1.0, plan.lanes / 2.0);
  double steps = 0, lines = 0, given = 0, longest = 0, held_turns = 0;
  for (size_t i = 0; i < out.size(); ++i) {
    double own = 2;  // start and finish
    if (out[i].leaves > 0) {
      own += out[i].nodes;      // down
      own += out[i].nodes + 1;  // up: what was stacked, and that nothing is left
      own += out[i].leaves * parts + out[i].insertions * (1 - 1 / together);
    }
    given += 1;
    if (in[i].want_photons && !in[i].flush && out[i].count > 0) {
      // Its photons leave once all older queries have left.
      held_turns += out[i].count + kFreeTurns;
      given += out[i].count;
    }
    steps += own;
    lines += out[i].leaves;
    longest = std::max(longest, own);
  }
  // The contexts go round between two stations: their own steps, and the line port, which serves
  // one line after the other. A line is looked for at the context's own turns, so half a round
  // late.
  const double beats = 8.0 * plan.line_bytes() / plan.beat_bits;
  double turns = steps;
  if (lines > 0) {
    const double beside = contexts * (steps / lines + 0.5) + kLineTurns + held_turns / lines;
    turns = lines / closed_throughput(contexts, beside, beats);
  }
  // At the end contexts run dry one by one: half of the longest query goes on alone.
  return {{std::max(turns, given), static_cast<double>(out.size())}, longest * contexts / 2};
}

TripCounts trip_counts(const Plan& plan, std::span<const GatherQuery> in) {
  const bool fullest = plan.reorder_drain == ReorderDrain::kFullest;
  if (plan.reorder_key == ReorderKey::kNone) return {{static_cast<double>(in.size())}, 0};
  const auto capacity = static_cast<size_t>(plan.reorder_packets);
  const double bins = plan.reorder_bins;
  double turns = 0, looks = 0;  // how often the fullest bin is looked for
  size_t held = 0;
  for (const GatherQuery& q : in) {
    turns += 1;
    if (q.flush) {
      turns += static_cast<double>(held);  // one of them leaves in the flush's own turn
      looks += bins * (1 - std::exp(-static_cast<double>(held) / bins));  // bins that hold any
      held = 0;
    } else if (held + 1 == capacity) {
      looks +=
          1 / std::max(1.0, 2 * static_cast<double>(capacity) / bins);  // twice the mean length
    } else {
      ++held;
    }
  }
  // 8 bins a turn; the packet that was to leave does so a turn later.
  const double look = std::max(1, plan.reorder_bins / 8) + 1;
  return {{turns + (fullest ? looks * look : 0)}, 0};
}

TripCounts trip_counts(const Plan& plan, std::span<const SamplerInput> in) {
  const double cells = std::size_t{1} << (2 * plan.cell_bits);
  double tables = 0, requests = 0, collect = 0;
  bool open = false, closed = false, photons = false;
  for (const SamplerInput& p : in) {
    collect += 1;
    if (p.kind == 0) {
      if (open && !closed && photons) collect += cells;  // a table that nobody asked is cleared
      open = true;
      closed = photons = false;
    } else if (p.kind == 1) {
      photons = true;
    } else if (open) {
      requests += 1;
      if (!closed) {
        tables += 1;
        collect += cells + 1;
      }
      closed = true;
    }
  }
  // The last table's weights follow its cosines.
  return {{collect, tables * (cells + 1), tables * (cells + 1), tables * (cells + 1) + requests},
          cells};
}

// A turn a record, and those of the decision, of reading and of answering. How many records a tile
// has by then golden says.
TripCounts trip_counts(const Plan& plan, std::span<const CacheLookup> in) {
  std::vector<CacheResult> out;
  make_golden_irradiance_cache(plan)->process(in, out);
  double turns = 0, records = 0;
  for (size_t i = 0; i < in.size(); ++i) {
    if (in[i].clear) records = 0;
    turns += records + kDecideTurns + 2;
    records += out[i].inserted;
  }
  return {{turns}, 0};
}

double modelled_cycles(const std::vector<KernelLoop>& loops, const TripCounts& trips) {
  double most = 0;
  for (size_t i = 0; i < loops.size(); ++i)
    most = std::max(most, trips.turns.at(i) * loops[i].interval());
  return most + trips.fill;
}

}  // namespace photonloom
