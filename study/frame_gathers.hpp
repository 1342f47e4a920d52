// SPDX-License-Identifier: Apache-2.0
// The final gathers of a frame and the lines that each reads, in the orders in which the frame can
// make them. What a query reads depends on neither order nor cache, so it is searched once.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "golden/packet/packet.hpp"
#include "study/cache_model.hpp"
#include "study/measures.hpp"

namespace photonloom {

struct FrameGathers {
  std::vector<GatherQuery> queries;  // in tile order
  LineVisits visits;                 // by number
};

// Shared by all points whose frames ask the same.
std::shared_ptr<const FrameGathers> frame_gathers(PointRun& run);
// Numbers of its queries in the order in which the plan's frame makes them.
std::shared_ptr<const std::vector<uint32_t>> frame_order(PointRun& run);

// What the plan's reorder buffer makes of it; its pool may be larger than a plan's.
std::vector<uint32_t> buffered_order(const Plan& plan, std::span<const GatherQuery> queries,
                                     std::span<const uint32_t> order);

// Windows of `packets` queries, each sorted by the Hilbert index of the whole position (ties by
// place in `order`). As many as there are: the image's order.
std::vector<uint32_t> sorted_windows(const Plan& plan, const FrameGathers& gathers,
                                     std::span<const uint32_t> order, size_t packets);

}  // namespace photonloom
