// SPDX-License-Identifier: Apache-2.0
// The law: what makes packets come earlier, later or in another order never changes the image. One
// combination of reordering, sizes, latency and stalls, all units of its plan as RTL, against the
// golden image of a plan with none of them.
#pragma once
#include <fmt/core.h>

#include <string>
#include <vector>

#include "golden/pipeline/prepare.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "verilator_tb/unit/backends.hpp"
#include "verilator_tb/unit/compare_units.hpp"

namespace photonloom::test {

// Counts queries that a leaf limit would cut short.
class LeafCounter final : public PhotonGatherer {
 public:
  LeafCounter(const Plan& plan, uint32_t limit)
      : golden_(make_golden_photon_gatherer(plan)), limit_(limit) {}
  void load(const PhotonMap& global, const PhotonMap& caustic) override {
    golden_->load(global, caustic);
  }
  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override {
    const size_t first = results.size();
    golden_->process(in, results, photons);
    for (size_t i = first; i < results.size(); ++i) {
      queries += !results[i].flush;
      cut += results[i].leaves > limit_;
    }
  }
  Counters counters() const override { return golden_->counters(); }
  uint64_t queries = 0, cut = 0;

 private:
  std::unique_ptr<PhotonGatherer> golden_;
  uint32_t limit_;
};

// A small frame with mirror and glass; `approximate`: with epsilon and a leaf limit that bites.
class LawFrame {
 public:
  explicit LawFrame(bool approximate) {
    FrameRequest request;
    request.scene_file = source("scenes/cornell_balls.xml");
    request.size = {14, 14};
    request.spp = 1;
    request.gather_rays = 8;
    request.photons = 4000;
    request.caustic_photons = 1500;
    request.k = 12;
    frame_ = prepare_frame(request, Arithmetic::kGolden, nullptr);
    if (approximate) {
      frame_.plan.epsilon_factor = 5;
      frame_.plan.epsilon_shift = 2;
      constexpr uint32_t kLimit = 5;
      FrameUnits units = make_golden_units(frame_.plan);
      auto counter = std::make_unique<LeafCounter>(frame_.plan, kLimit);
      const LeafCounter& counts = *counter;
      units.photon_gatherer = std::move(counter);
      FrameCounts own;
      render_frame(frame_.input(Arithmetic::kGolden), units, own);
      INFO(counts.cut << " of " << counts.queries << " queries are cut by the leaf limit");
      CHECK(10 * counts.cut >= counts.queries);
      frame_.plan.leaf_limit = kLimit;
    }
    frame_.plan.reorder_key = ReorderKey::kNone;
    FrameUnits units = make_golden_units(frame_.plan);
    FrameCounts counts;
    image_ = render_frame(frame_.input(Arithmetic::kGolden), units, counts);
    CHECK(counts.final_gathers > 500);
    CHECK(counts.caustic_queries > 100);
  }

  // Combination `number` of the space, drawn with its number as seed; the rig's options follow from
  // it too.
  void check(uint64_t number) {
    BenchDraw draw{RoleRandom(number, "same image")};
    Plan plan = frame_.plan;
    plan.reorder_key = draw.of({ReorderKey::kNone, ReorderKey::kHash, ReorderKey::kHilbert});
    plan.reorder_drain =
        plan.reorder_key == ReorderKey::kHash ? ReorderDrain::kFullest : ReorderDrain::kSweep;
    plan.reorder_packets = draw.of({1, 7, 64, 512});
    plan.reorder_bins = draw.of({1, 16, 256});
    const int line = plan.line_bytes();
    plan.cache_ways = draw.of({1, 2});
    plan.cache_bytes = line * plan.cache_ways * draw.of({0, 1, 8, 64});
    plan.cache_misses = draw.of({1, 8});
    plan.contexts = draw.of({1, 4, 16});
    plan.lanes = draw.of({1, 4, 8});
    plan.nodes_per_cycle = plan.candidates_per_cycle = plan.powers_per_cycle =
        plan.contexts > 1 ? draw.of({1, 2}) : 1;
    RunOptions options;
    options.seed = number;
    options.initial_seed = number;
    options.random_latency = draw.random.below(3) == 0;
    options.latency = options.random_latency ? 40 : draw.of({1, 60});
    const char* stall = draw.of({"none", "bernoulli:0.5", "bursts", "adversary"});
    options.stall_in = options.stall_out = options.stall_memory = StallPolicy::parse(stall);
    options.work_dir = "cosim";
    run(plan, options, fmt::format("combination {}, stall {}", number, stall));
  }

  // All at its smallest, under the adversary.
  void check_smallest() {
    Plan plan = frame_.plan;
    plan.reorder_key = ReorderKey::kHilbert;
    plan.reorder_packets = plan.reorder_bins = 1;
    plan.cache_ways = plan.cache_misses = plan.contexts = plan.lanes = 1;
    plan.cache_bytes = plan.line_bytes();
    RunOptions options;
    options.stall_in = options.stall_out = options.stall_memory = StallPolicy::parse("adversary");
    options.random_latency = true;
    options.work_dir = "cosim";
    run(plan, options, "smallest of all");
  }

 private:
  struct BenchDraw {
    RoleRandom random;
    template <class T>
    T of(std::initializer_list<T> list) {
      return *(list.begin() + random.below(list.size()));
    }
  };

  void run(const Plan& plan, const RunOptions& options, const std::string& name) {
    INFO(name << ": key " << static_cast<int>(plan.reorder_key) << ", drain "
              << static_cast<int>(plan.reorder_drain) << ", pool " << plan.reorder_packets
              << ", bins " << plan.reorder_bins << ", cache " << plan.cache_bytes << "/"
              << plan.cache_ways << "/" << plan.cache_misses << ", contexts " << plan.contexts
              << ", lanes " << plan.lanes << ", widths " << plan.nodes_per_cycle << ", latency "
              << options.latency << (options.random_latency ? " random" : ""));
    if (const auto problem = find_problem(plan)) FAIL(problem->line << " " << problem->what);
    CompareContext context;
    context.plan = name;
    const FrameUnits golden = make_golden_units(plan);
    const auto gatherer = make_rtl_photon_gatherer(plan, options);
    const auto reorder = make_rtl_reorder_buffer(plan, options);
    const auto sampler = make_rtl_cdf_sampler(plan, options);
    FrameUnits units;
    units.photon_gatherer = compare_units(plan, context, *golden.photon_gatherer, *gatherer);
    units.reorder_buffer = compare_units(plan, context, *golden.reorder_buffer, *reorder);
    units.cdf_sampler = compare_units(plan, context, *golden.cdf_sampler, *sampler);
    FrameInput input = frame_.input(Arithmetic::kGolden);
    const FrameInput with_plan{.world = input.world,
                               .caster = input.caster,
                               .plan = plan,
                               .global = input.global,
                               .caustic = input.caustic,
                               .seed = input.seed,
                               .arithmetic = Arithmetic::kGolden};
    FrameCounts counts;
    const Image image = render_frame(with_plan, units, counts);
    CHECK(counts.unmatched == 0);
    CHECK(counts.unanswered == 0);
    bool same = image.channels.size() == image_.channels.size();
    for (size_t i = 0; same && i < image.channels.size(); ++i)
      same = image.channels[i].pixels == image_.channels[i].pixels;
    CHECK(same);
  }

  PreparedFrame frame_;
  Image image_;
};

}  // namespace photonloom::test
