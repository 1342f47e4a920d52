// SPDX-License-Identifier: Apache-2.0
// The packets that travel between units. Each is listed once, a line a field:
//   FIELD(C++ type, name, elements, bits of an element, unit, meaning)
// `plan` is in scope in the two number columns. From these lists come the structs here, the
// SystemVerilog package, packing for every backend, the text traces, the decoder of the divergence
// report and the tables in docs/. Structs have no default values, so that a producer that forgets a
// new field does not compile. A field of no elements or no bits is absent from the hardware and
// from traces, and is 0.
#pragma once
#include <array>
#include <cstdint>
#include <type_traits>

#include "golden/numeric/vec.hpp"
#include "golden/plan/plan.hpp"

namespace photonloom {

using Pair32 = std::array<uint32_t, 2>;
using Channels32 = std::array<uint32_t, 3>;
using Channels64 = std::array<uint64_t, 3>;
using CacheList = std::array<uint32_t, 8>;

// A question to the photon map: the k nearest photons around a point. Also what the reorder buffer
// holds.
#define PHOTONLOOM_GATHER_QUERY(FIELD)                                                           \
  FIELD(uint32_t, pixel, 1, plan.pixel_bits(), "", "pixel number, row by row from the top left") \
  FIELD(uint32_t, sample, 1, plan.sample_bits(), "", "sample of the pixel")                      \
  FIELD(uint32_t, tag, 1, plan.tag_bits(), "",                                                   \
        "final gather ray of the sample; gather_rays for the camera hit")                        \
  FIELD(uint32_t, map, 1, 1, "", "0 global, 1 caustic")                                          \
  FIELD(uint32_t, flush, 1, 1, "", "1: no query, everything before it leaves first")             \
  FIELD(uint32_t, want_photons, 1, 1, "",                                                        \
        "1: the photons themselves follow as gather_photon packets")                             \
  FIELD(UVec3, position, 3, plan.position_bits, "position unit", "x, y, z")                      \
  FIELD(Pair32, normal, 2, plan.normal_bits, "octahedral cell",                                  \
        "surface normal on the side of the light")

// The answer. A flush is answered by a result with flush = 1 and every number 0 but pixel, sample
// and tag.
#define PHOTONLOOM_GATHER_RESULT(FIELD)                                                         \
  FIELD(uint32_t, pixel, 1, plan.pixel_bits(), "", "as in the query")                           \
  FIELD(uint32_t, sample, 1, plan.sample_bits(), "", "as in the query")                         \
  FIELD(uint32_t, tag, 1, plan.tag_bits(), "", "as in the query")                               \
  FIELD(uint32_t, map, 1, 1, "", "as in the query")                                             \
  FIELD(uint32_t, flush, 1, 1, "", "as in the query")                                           \
  FIELD(uint32_t, count, 1, plan.count_bits(), "photons", "n, how many there are")              \
  FIELD(uint64_t, r2, 1, plan.r2_bits(), "position unit^2",                                     \
        "d^2 of the k-th, or r2_max when n < k")                                                \
  FIELD(Channels64, flux, plan.channels, plan.flux_bits(), "power unit",                        \
        "exact sum over all n, a channel each")                                                 \
  FIELD(uint32_t, reciprocal, 1, plan.reciprocal_bits ? plan.reciprocal_bits + 1 : 0,           \
        "2^-(W+e) / position unit^2", "mantissa of reciprocal(max(r2, r2_floor))")              \
  FIELD(uint32_t, reciprocal_exponent, 1, plan.reciprocal_exponent_bits(), "", "e of the same") \
  FIELD(uint32_t, full, 1, 1, "", "1: n = k")                                                   \
  FIELD(uint32_t, clamped, 1, 1, "", "1: r2 < r2_floor")                                        \
  FIELD(uint32_t, nodes, 1, plan.line_bits() + 1, "nodes", "inner nodes processed")             \
  FIELD(uint32_t, leaves, 1, plan.line_bits() + 1, "lines", "leaves processed")                 \
  FIELD(uint32_t, insertions, 1, plan.index_bits() + 1, "photons",                              \
        "candidates that entered the list")                                                     \
  FIELD(uint32_t, faulty, 1, plan.parity ? 1 : 0, "",                                           \
        "1: a memory gave a wrong word, the numbers are not to be used")

// One of the k nearest photons, in (d2, index) order.
#define PHOTONLOOM_GATHER_PHOTON(FIELD)                                                      \
  FIELD(uint32_t, index, 1, plan.index_bits(), "", "line * bucket + slot")                   \
  FIELD(uint64_t, d2, 1, plan.r2_bits(), "position unit^2", "squared distance to the query") \
  FIELD(Channels32, mantissa, plan.channels, plan.mantissa_bits, "power unit * 2^exponent",  \
        "power, a channel each")                                                             \
  FIELD(uint32_t, exponent, 1, plan.exponent_bits, "", "shared exponent of the power")       \
  FIELD(Pair32, direction, 2, plan.direction_bits, "octahedral cell",                        \
        "to where the light came from")                                                      \
  FIELD(uint32_t, last, 1, 1, "", "1: the last of its query")

// The sampler's one input stream: a header, its photons, its requests, the next header, ...
// A field that a kind does not list is 0. kind 0 header: pixel, sample, normal. kind 1 photon:
// mantissa, exponent, direction. kind 2 request: tag, u, v.
#define PHOTONLOOM_SAMPLER_INPUT(FIELD)                                                     \
  FIELD(uint32_t, kind, 1, 2, "", "0 header, 1 photon, 2 request")                          \
  FIELD(uint32_t, pixel, 1, plan.pixel_bits(), "", "pixel of the table")                    \
  FIELD(uint32_t, sample, 1, plan.sample_bits(), "", "sample of the table")                 \
  FIELD(uint32_t, tag, 1, plan.tag_bits(), "", "final gather ray")                          \
  FIELD(Pair32, normal, 2, plan.normal_bits, "octahedral cell", "surface normal")           \
  FIELD(Channels32, mantissa, plan.channels, plan.mantissa_bits, "power unit * 2^exponent", \
        "photon's power")                                                                   \
  FIELD(uint32_t, exponent, 1, plan.exponent_bits, "", "shared exponent of the power")      \
  FIELD(Pair32, direction, 2, plan.direction_bits, "octahedral cell", "photon's direction") \
  FIELD(uint64_t, u, 1, plan.u_bits, "2^-u_bits", "picks the cell")                         \
  FIELD(Pair32, v, 2, plan.v_bits, "2^-v_bits cell", "places the direction in the cell")

// A sampled direction: an octahedral code of cell_bits + v_bits bits a coordinate, its cell on top.
#define PHOTONLOOM_SAMPLE(FIELD)                                                                \
  FIELD(uint32_t, pixel, 1, plan.pixel_bits(), "", "pixel of the table")                        \
  FIELD(uint32_t, sample, 1, plan.sample_bits(), "", "sample of the table")                     \
  FIELD(uint32_t, tag, 1, plan.tag_bits(), "", "as in the request")                             \
  FIELD(Pair32, direction, 2, plan.sample_direction_bits(), "octahedral cell", "the direction") \
  FIELD(uint32_t, cell_index, 1, plan.cell_index_bits(), "",                                    \
        "row * 2^a + column, column from u, row from v coordinate")                             \
  FIELD(uint32_t, weight, 1, plan.probability_bits, "", "w of the cell")                        \
  FIELD(uint64_t, total, 1, plan.total_bits(), "", "W of the table")

// A question to the irradiance cache: which records of the tile cover this point.
#define PHOTONLOOM_CACHE_LOOKUP(FIELD)                                                     \
  FIELD(uint32_t, pixel, 1, plan.pixel_bits(), "", "pixel of the sample")                  \
  FIELD(uint32_t, sample, 1, plan.sample_bits(), "", "sample of the pixel")                \
  FIELD(uint32_t, clear, 1, 1, "", "1: a new tile, all records are forgotten first")       \
  FIELD(uint32_t, insert, 1, 1, "", "1: where no record covers the point it becomes one")  \
  FIELD(UVec3, position, 3, plan.position_bits, "position unit", "x, y, z")                \
  FIELD(UVec3, normal, 3, plan.normal_bits, "2^(1-normal_bits)",                           \
        "shading normal plus (1, 1, 1), rounded down")                                     \
  FIELD(uint32_t, falloff, 1, plan.cache_falloff_bits() + 1, "2^-(W+e) / position unit^2", \
        "mantissa of reciprocal(reach^2) of the point as a record")                        \
  FIELD(uint32_t, falloff_exponent, 1, plan.cache_falloff_exponent_bits(), "", "e of the same")

// The answer: the heaviest records that cover the point, by weight, then number.
#define PHOTONLOOM_CACHE_RESULT(FIELD)                                                          \
  FIELD(uint32_t, pixel, 1, plan.pixel_bits(), "", "as in the lookup")                          \
  FIELD(uint32_t, sample, 1, plan.sample_bits(), "", "as in the lookup")                        \
  FIELD(uint32_t, count, 1, plan.cache_hit_bits(), "records", "how many follow")                \
  FIELD(CacheList, record, plan.cache_hits, plan.cache_record_bits(), "", "number in the tile") \
  FIELD(CacheList, weight, plan.cache_hits, plan.cache_weight_bits + 1, "2^-weight_bits",       \
        "its weight; 0 behind the last")                                                        \
  FIELD(uint32_t, inserted, 1, 1, "", "1: the point became a record")                           \
  FIELD(uint32_t, full, 1, 1, "", "1: it would have, but the tile holds cache.records")         \
  FIELD(uint32_t, number, 1, plan.cache_record_bits(), "", "of the record that it became")

// What is known of a field beside its value.
struct FieldInfo {
  const char* name;
  int elements;  // with this plan
  int bits;      // of one element, with this plan
  const char* unit;
  const char* meaning;
};

#define PHOTONLOOM_MEMBER(type, name, elements, bits, unit, meaning) type name;
#define PHOTONLOOM_VISIT(type, name, elements, bits, unit, meaning) \
  visitor(&Packet::name, FieldInfo{#name, (elements), (bits), unit, meaning});

// fields(plan, visitor) calls visitor(pointer to member, FieldInfo) for every field, first to last.
#define PHOTONLOOM_PACKET(Name, snake_name, LIST)             \
  struct Name {                                               \
    LIST(PHOTONLOOM_MEMBER)                                   \
    static constexpr const char* kName = snake_name;          \
    bool operator==(const Name&) const = default;             \
    template <class Visitor>                                  \
    static void fields(const Plan& plan, Visitor&& visitor) { \
      using Packet = Name;                                    \
      LIST(PHOTONLOOM_VISIT)                                  \
    }                                                         \
  };

PHOTONLOOM_PACKET(GatherQuery, "gather_query", PHOTONLOOM_GATHER_QUERY)
PHOTONLOOM_PACKET(GatherResult, "gather_result", PHOTONLOOM_GATHER_RESULT)
PHOTONLOOM_PACKET(GatherPhoton, "gather_photon", PHOTONLOOM_GATHER_PHOTON)
PHOTONLOOM_PACKET(SamplerInput, "sampler_input", PHOTONLOOM_SAMPLER_INPUT)
PHOTONLOOM_PACKET(Sample, "sample", PHOTONLOOM_SAMPLE)
PHOTONLOOM_PACKET(CacheLookup, "cache_lookup", PHOTONLOOM_CACHE_LOOKUP)
PHOTONLOOM_PACKET(CacheResult, "cache_result", PHOTONLOOM_CACHE_RESULT)

// Calls f with a value-less tag of each packet type: for whatever is generated for all of them.
template <class F>
void for_each_packet(F&& f) {
  f(std::type_identity<GatherQuery>{});
  f(std::type_identity<GatherResult>{});
  f(std::type_identity<GatherPhoton>{});
  f(std::type_identity<SamplerInput>{});
  f(std::type_identity<Sample>{});
  f(std::type_identity<CacheLookup>{});
  f(std::type_identity<CacheResult>{});
}

}  // namespace photonloom
