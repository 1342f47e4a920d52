// SPDX-License-Identifier: Apache-2.0
// The photon gatherer as an HLS kernel: queries in, the k nearest photons' sum out, and on request
// the photons (docs/photon_gatherer.md). Mirrors search_gather of golden/unit/photon_gatherer.cpp,
// with equal counts of nodes, leaves and insertions.
//
//   in -> search --raw results, in the order of the queries--> finish (reciprocal) -> result
//           |  node memory, line memory                            photons ----------> photon
//
// search is one pipelined loop that serves kContexts queries by turns. A turn takes one step of one
// query: an inner node, kLanes photons of a leaf and the nearest insertion among them, or one stack
// entry. Beside it a turn reads one beat of a leaf line and gives one result or photon of the
// oldest query. Its initiation interval follows from these dependencies:
//
//   a context's own state   read by its next step, kContexts turns later; a step takes kStepLatency
//                           cycles, so the interval is at least kStepLatency / kContexts
//   buffer_, a leaf line    read kLineTurns turns or more after its last beat was asked for
//   store_ and keys_        of a query whose photons leave: its next step is kFreeTurns turns later
//
// A power that falls out of the list is taken off the sum, so a query has its sum with its last
// insertion. The slots of a leaf of several compressed lines are gathered from all of them before
// its first step. A result is written before its photons; whoever reads both has to take a query's
// photons before he waits for the next result, or to have room for k of them.
#pragma once
#include "hls_kernels/photon_gatherer/timing.hpp"
#include "hls_kernels/vocabulary.hpp"

namespace photonloom_hls {

// Maps beside their lines and nodes: index 0 is the global map, 1 the caustic one.
template <class T>
struct GatherMaps {
  typename T::template uint<kLineBits + 1> lines[2];  // 0: no map
  typename T::template uint<kR2Bits> r2_max[2];
};

template <class T>
class PhotonGatherer {
  template <int W>
  using uint = typename T::template uint<W>;
  template <int W>
  using sint = typename T::template sint<W>;
  template <class E>
  using stream = typename T::template stream<E>;
  using Query = GatherQuery<T>;
  using Result = GatherResult<T>;
  using Photon = GatherPhoton<T>;

 public:
  static constexpr int kStepLatency = GathererTiming::kStepLatency;
  static constexpr int kLineTurns = GathererTiming::kLineTurns;
  static constexpr int kFreeTurns = GathererTiming::kFreeTurns;
  // Queries in flight: the plan's, at least kLeastContexts, rounded up to a power of two.
  static constexpr int kContexts =
      1 << clog2(at_least(GathererTiming::kLeastContexts, photonloom_hls::kContexts));
  static constexpr unsigned kInterval = (kStepLatency + kContexts - 1) / kContexts;

  // Node memory: word = {axis, split}; the node of the global map at its number, that of the
  // caustic map kGlobalLines further.
  using Node = uint<kPositionBits + 2>;
  static constexpr int kGlobalLines = (kGlobalPhotons + kBucket - 1) / kBucket;
  static constexpr int kCausticLines = (kCausticPhotons + kBucket - 1) / kBucket;
  static constexpr int kNodeWords = at_least(2, kGlobalLines + kCausticLines);
  // Line memory: the beats of each line one after the other, the caustic map's kGlobalMemoryLines
  // behind the global one's.
  static constexpr int kLineBytes = kBucket * kPhotonBytes;
  static constexpr int kBeats = 8 * kLineBytes / kLineBeatBits;
  using Beat = typename T::template bits<kLineBeatBits>;

  PhotonGatherer() {
    for (int c = 0; c < kContexts; ++c) phase_[c] = kIdle;
  }

  // Takes `packets` queries and gives all their results and photons.
  void run(stream<Query>& in, stream<Result>& result, stream<Photon>& photon, const Node* nodes,
           const Beat* lines, const GatherMaps<T>& maps, const uint<32>& packets) {
    HLS_DATAFLOW;
    HLS_STREAM(T, Raw, raw_results, kPlaces);
    HLS_PROCESS(search, search(in, raw_results, photon, nodes, lines, maps, packets));
    HLS_PROCESS(finish, finish(raw_results, result, packets));
    HLS_DATAFLOW_END;
  }

 private:
  static constexpr int kMaps = kCausticPresent == 1 ? 2 : 1;
  static constexpr int kNodeBits = kLineBits + 1;
  static constexpr int kDepth = kLineBits + 1;  // of the stack
  static constexpr int kContextBits = clog2(kContexts);
  static constexpr int kSlots = 1 << (kContextBits + 1);  // results that wait for older ones
  static constexpr int kParts = kBucket / kLanes;
  static constexpr int kMostLines = kLinesCompressed == 1 ? kBucket : 1;  // of a leaf
  static constexpr int kPlaces = 2;                                       // of raw_results

  using Context = uint<kContextBits>;
  using Ticket = uint<32>;
  using Coordinate = uint<kPositionBits>;
  using Distance = uint<kR2Bits>;
  using Index = uint<kIndexBits>;
  using Line = uint<kLineAddressBits>;
  using Place = uint<at_least(1, clog2(kK))>;
  using Count = uint<kCountBits>;
  using Flux = uint<kFluxBits>;
  using Normal = Direction<T, kNormalBits>;

  // Where a context is.
  static constexpr int kIdle = 0, kDescend = 1, kWait = 2, kLeaf = 3, kPop = 4, kFinish = 5,
                       kLeave = 6;

  // What is stored of a photon beside its position.
  struct Load {
    uint<kMantissaBits> mantissa[kChannels];
    uint<kExponentBits> exponent;
    uint<kDirectionBits> direction[2];
  };
  struct StoredPhoton {
    Coordinate position[3];
    Load load;
  };
  struct Key {
    Distance d2;
    Index index;
    Place place;  // of its load
  };
  struct Subtree {
    uint<kNodeBits> node;
    Coordinate offset[3];  // from the query to its region
  };
  struct Raw {
    Query query;
    Count count;
    Distance r2;
    Flux flux[kChannels];
    uint<kLineBits + 1> nodes, leaves;
    uint<kIndexBits + 1> insertions;
    Context context;
  };

 public:
  // What its stream holds.
  struct StreamPlaces {
    Raw raw_results[kPlaces];
  };

 private:
  // A context, or none.
  struct Token {
    bool valid;
    Context context;
  };
  struct LineRequest {
    Context context;
    uint<1> map;
    Line line;
  };

  // ---- search ----

  void search(stream<Query>& in, stream<Raw>& raw_results, stream<Photon>& photons,
              const Node* nodes, const Beat* lines, const GatherMaps<T>& maps,
              const uint<32>& packets) {
    HLS_PARTITION(keys_, 2);
    HLS_PARTITION(buffer_, 2);
    // A query visits each line once at most, a stack entry and an inner node each.
    constexpr unsigned long long kMostSteps =
        (kGlobalLines + kCausticLines + 1ull) *
            (3 + kBucket + (kBeats * kContexts + kLineTurns) * kMostLines) +
        kK + kFreeTurns + 8;
    Ticket started = 0, given = 0;
    uint<kSlots> ready = 0;  // results, by slot
    uint<kContexts> line_here = 0, freed = 0;
    Context context = 0;
    // of the line port
    LineRequest queue[kContexts];
    uint<kContextBits + 1> queued = 0;
    Context queue_first = 0;
    uint<at_least(1, clog2(kBeats + 1))> beat = 0;
    typename T::template bits<8 * kLineBytes> line_bits;
    bool further = false;  // not the first line of its leaf
    Delay<Token, kLineTurns> arriving;
    Delay<Token, kFreeTurns> freeing;
    arriving.fill(Token{false, 0});
    freeing.fill(Token{false, 0});
    // of the output
    bool giving = false;
    Count place = 0;

    for (uint<64> turn = 0;
         turn < uint<32>(packets + 1) * uint<32>(kContexts) * uint<48>(kMostSteps); ++turn) {
      HLS_PIPELINE(kInterval);
      HLS_DISTANCE(buffer_, kLineTurns);
      HLS_DISTANCE(keys_, kContexts);
      HLS_DISTANCE(store_, kContexts);
      if (given == packets) break;

      // A step of the context whose turn it is.
      const unsigned c = index(context);
      if (phase_[c] == kWait && line_here[c]) phase_[c] = kLeaf;
      if (phase_[c] == kLeave && freed[c]) phase_[c] = kIdle;
      bool ask = false;
      if (phase_[c] == kIdle) {
        if (started != packets && Ticket(started - given) < kSlots) {
          start(c, in.read(), started, maps, ask);
          started += 1;
        }
      } else if (phase_[c] == kDescend) {
        descend(c, nodes, maps, ask);
      } else if (phase_[c] == kLeaf) {
        leaf(c, maps);
      } else if (phase_[c] == kPop) {
        pop(c, maps, ask);
      } else if (phase_[c] == kFinish) {
        const unsigned slot = index(ticket_[c]) % kSlots;
        slots_[slot] = raw_result(c, maps);
        ready = with_bit(ready, slot, true);
        phase_[c] = kIdle;
        if (query_[c].want_photons == 1 && count_[c] != 0) {
          phase_[c] = kLeave;
          freed = with_bit(freed, c, false);
        }
      }
      if (ask) {
        line_here = with_bit(line_here, c, false);
        part_[c] = 0;
        lane_[c] = 0;
        LineRequest request;
        request.context = context;
        request.map = map_of(query_[c]);
        request.line = node_[c] - maps.lines[map_of(query_[c])];
        const Context behind = queue_first + queued;
        queue[index(behind)] = request;
        queued += 1;
      }

      // A beat of the oldest line that was asked for.
      Token arrived{false, 0};
      if (queued != 0) {
        const LineRequest& request = queue[index(queue_first)];
        unsigned line = index(request.line);
        if (request.map == 1) line += kGlobalMemoryLines;
        T::set_slice(line_bits, index(beat) * kLineBeatBits, lines[line * kBeats + index(beat)]);
        beat += 1;
        if (beat == kBeats) {
          Line next = 0;
          further = unpack_line(line_bits, further, buffer_[index(request.context)], next);
          beat = 0;
          if (further) {
            queue[index(queue_first)].line = next;
          } else {
            arrived = Token{true, request.context};
            queued -= 1;
            queue_first += 1;
          }
        }
      }
      const Token here = arriving.push(arrived);
      if (here.valid) line_here = with_bit(line_here, index(here.context), true);

      // A result, or a photon of the query whose result left last.
      Token leaving{false, 0};
      const unsigned slot = index(given) % kSlots;
      if (giving) {
        const unsigned from = index(slots_[slot].context);
        place += 1;
        photons.write(photon_of(from, place));
        if (place == slots_[slot].count) {
          giving = false;
          leaving = Token{true, slots_[slot].context};
        }
      } else if (ready[slot]) {
        raw_results.write(slots_[slot]);
        ready = with_bit(ready, slot, false);
        giving = slots_[slot].query.want_photons == 1 && slots_[slot].count != 0;
        place = 0;
        if (!giving) given += 1;
      }
      if (leaving.valid) given += 1;
      const Token free = freeing.push(leaving);
      if (free.valid) freed = with_bit(freed, index(free.context), true);

      context += 1;
    }
    // A context that waited for its photons to leave is free with the last of them.
    for (int c = 0; c < kContexts; ++c) phase_[c] = kIdle;
  }

  static unsigned map_of(const Query& query) { return kMaps == 2 ? index(query.map) : 0; }

  void start(unsigned c, const Query& query, const Ticket& ticket, const GatherMaps<T>& maps,
             bool& ask) {
    query_[c] = query;
    if (query.flush == 1) query_[c].want_photons = 0;
    normal_[c] = Normal::decode(query.normal[0], query.normal[1]);
    ticket_[c] = ticket;
    count_[c] = 0;
    nodes_[c] = 0;
    leaves_[c] = 0;
    insertions_[c] = 0;
    height_[c] = 0;
    node_[c] = 1;
    for (int axis = 0; axis < 3; ++axis) {
      HLS_UNROLL
      offset_[c][axis] = 0;
    }
    for (int channel = 0; channel < kChannels; ++channel) {
      HLS_UNROLL
      flux_[c][channel] = 0;
    }
    const uint<kLineBits + 1> lines = lines_of_map(query, maps);
    phase_[c] = kDescend;
    if (lines == 1) {
      phase_[c] = kWait;
      ask = true;
    }
    if (lines == 0 || query.flush == 1) {
      phase_[c] = kFinish;
      ask = false;
    }
  }

  static uint<kLineBits + 1> lines_of_map(const Query& query, const GatherMaps<T>& maps) {
    if (kMaps == 1 && query.map == 1) return 0;
    return maps.lines[map_of(query)];
  }
  static Distance r2_max_of(const Query& query, const GatherMaps<T>& maps) {
    return maps.r2_max[index(query.map)];
  }

  // An inner node: the far child is stacked, the near one is next.
  void descend(unsigned c, const Node* nodes, const GatherMaps<T>& maps, bool& ask) {
    unsigned address = index(node_[c]);
    if (map_of(query_[c]) == 1) address += kGlobalLines;
    const Node node = nodes[address];
    const Coordinate split = T::template slice<kPositionBits>(node, 0);
    const unsigned axis = index(T::template slice<2>(node, kPositionBits));
    const sint<kPositionBits + 1> away = query_[c].position[axis] - split;
    const bool right = away >= 0;
    Coordinate size = away;
    if (!right) size = 0 - away;
    Subtree far;
    far.node = node_[c] << 1 | uint<1>(!right);
    for (int i = 0; i < 3; ++i) {
      HLS_UNROLL
      far.offset[i] = offset_[c][i];
      if (static_cast<unsigned>(i) == axis) far.offset[i] = size;
    }
    stack_[c][index(height_[c])] = far;
    height_[c] += 1;
    nodes_[c] += 1;
    node_[c] = node_[c] << 1 | uint<1>(right);
    go_on(c, maps, ask);
  }

  // From node_: on down, or into a leaf.
  void go_on(unsigned c, const GatherMaps<T>& maps, bool& ask) {
    const bool is_leaf = node_[c] >= lines_of_map(query_[c], maps);
    phase_[c] = kDescend;
    if (is_leaf) phase_[c] = kWait;
    ask = is_leaf;
  }

  // The subtree stacked last, unless it is too far.
  void pop(unsigned c, const GatherMaps<T>& maps, bool& ask) {
    if (height_[c] == 0) {
      phase_[c] = kFinish;
      return;
    }
    height_[c] -= 1;
    const Subtree next = stack_[c][index(height_[c])];
    Distance d2 = 0;
    for (int axis = 0; axis < 3; ++axis) {
      HLS_UNROLL
      d2 = d2 + next.offset[axis] * next.offset[axis];
    }
    const uint<16> factor = kEpsilonFactor;
    const uint<kR2Bits + 16> far = d2 * factor;
    const uint<kR2Bits + 16> near = uint<kR2Bits + 16>(bound(c, maps)) << kEpsilonShift;
    if (far > near) return;
    node_[c] = next.node;
    for (int axis = 0; axis < 3; ++axis) {
      HLS_UNROLL
      offset_[c][axis] = next.offset[axis];
    }
    go_on(c, maps, ask);
  }

  Distance bound(unsigned c, const GatherMaps<T>& maps) const {
    if (count_[c] == kK) return keys_[c][kK - 1].d2;
    return r2_max_of(query_[c], maps);
  }

  // kLanes photons of the leaf: the first that enters the list does; if another one would, the rest
  // waits for the next step.
  void leaf(unsigned c, const GatherMaps<T>& maps) {
    const Distance r2_max = r2_max_of(query_[c], maps);
    const Key last = keys_[c][kK - 1];
    const bool full = count_[c] == kK;
    bool found = false, more = false;
    unsigned lane = 0;
    Key candidate;
    candidate.d2 = 0;
    candidate.index = 0;
    for (int l = kLanes - 1; l >= 0; --l) {
      HLS_UNROLL
      const unsigned slot = index(part_[c]) * kLanes + static_cast<unsigned>(l);
      const StoredPhoton& photon = buffer_[c][slot];
      const Distance d2 = distance(photon, query_[c]);
      const Index number =
          Index(node_[c] - maps.lines[map_of(query_[c])]) << clog2(kBucket) | Index(slot);
      const bool nearer = !full || d2 < last.d2 || (d2 == last.d2 && number < last.index);
      if (l >= static_cast<int>(index(lane_[c])) && used(photon.load) && d2 <= r2_max && nearer &&
          faces(photon.load, c)) {
        more = found;
        found = true;
        lane = static_cast<unsigned>(l);
        candidate.d2 = d2;
        candidate.index = number;
      }
    }
    if (found) insert(c, candidate, buffer_[c][index(part_[c]) * kLanes + lane].load);
    if (more) {
      lane_[c] = lane + 1;
      return;
    }
    lane_[c] = 0;
    part_[c] += 1;
    if (part_[c] != kParts) return;
    leaves_[c] += 1;
    phase_[c] = kPop;
    if (kLeafLimit != 0 && leaves_[c] == kLeafLimit) phase_[c] = kFinish;
  }

  static Distance distance(const StoredPhoton& photon, const Query& query) {
    Distance d2 = 0;
    for (int axis = 0; axis < 3; ++axis) {
      HLS_UNROLL
      const sint<kPositionBits + 1> d = photon.position[axis] - query.position[axis];
      d2 = d2 + d * d;
    }
    return d2;
  }
  // An unused slot has the one code that no photon has.
  static bool used(const Load& load) {
    bool zero = true;
    for (int channel = 0; channel < kChannels; ++channel) {
      HLS_UNROLL
      if (load.mantissa[channel] != 0) zero = false;
    }
    return !zero || load.exponent != (1 << kExponentBits) - 1;
  }
  bool faces(const Load& load, unsigned c) const {
    const Direction<T, kDirectionBits> from =
        Direction<T, kDirectionBits>::decode(load.direction[0], load.direction[1]);
    return dot<T, kDirectionBits, kNormalBits>(from, normal_[c]) > 0;
  }

  // Puts a candidate that belongs into the list in its place; a full list's last one falls out.
  void insert(unsigned c, const Key& candidate, const Load& load) {
    const bool full = count_[c] == kK;
    Place place = count_[c];
    if (full) place = keys_[c][kK - 1].place;
    const Load old = store_[c][index(place)];
    for (int channel = 0; channel < kChannels; ++channel) {
      HLS_UNROLL
      Flux flux = flux_[c][channel];
      if (full) flux = flux - (Flux(old.mantissa[channel]) << index(old.exponent));
      flux_[c][channel] = flux + (Flux(load.mantissa[channel]) << index(load.exponent));
    }
    store_[c][index(place)] = load;
    Key placed = candidate;
    placed.place = place;
    for (int i = kK - 1; i >= 0; --i) {
      HLS_UNROLL
      const bool here_after =
          i >= static_cast<int>(index(count_[c])) || !before(keys_[c][i], candidate);
      bool above_after = false;
      if (i > 0)
        above_after = i - 1 >= static_cast<int>(index(count_[c])) ||
                      !before(keys_[c][at_least(0, i - 1)], candidate);
      if (above_after)
        keys_[c][i] = keys_[c][at_least(0, i - 1)];
      else if (here_after)
        keys_[c][i] = placed;
    }
    if (!full) count_[c] += 1;
    insertions_[c] += 1;
  }
  static bool before(const Key& a, const Key& b) {
    return a.d2 < b.d2 || (a.d2 == b.d2 && a.index < b.index);
  }

  Raw raw_result(unsigned c, const GatherMaps<T>& maps) const {
    Raw raw;
    raw.query = query_[c];
    raw.count = count_[c];
    raw.r2 = bound(c, maps);
    for (int channel = 0; channel < kChannels; ++channel) {
      HLS_UNROLL
      raw.flux[channel] = flux_[c][channel];
    }
    raw.nodes = nodes_[c];
    raw.leaves = leaves_[c];
    raw.insertions = insertions_[c];
    raw.context = c;
    return raw;
  }

  // The photon at place number - 1 of a context's list.
  Photon photon_of(unsigned c, const Count& number) const {
    const Key& key = keys_[c][index(number) - 1];
    const Load& load = store_[c][index(key.place)];
    Photon photon;
    photon.zero();
    photon.index = key.index;
    photon.d2 = key.d2;
    for (int channel = 0; channel < kChannels; ++channel) {
      HLS_UNROLL
      photon.mantissa[channel] = load.mantissa[channel];
    }
    photon.exponent = load.exponent;
    photon.direction[0] = load.direction[0];
    photon.direction[1] = load.direction[1];
    photon.last = number == count_[c];
    return photon;
  }

  // Fields from bit 0: position, direction, mantissas, exponent; slots kPhotonBytes apart.
  // The slots of a line; whether its leaf has another one, `next`.
  static bool unpack_line(const typename T::template bits<8 * kLineBytes>& line, bool further,
                          StoredPhoton (&photons)[kBucket], Line& next) {
    if constexpr (kLinesCompressed == 1) {
      return unpack_compressed(line, further, photons, next);
    } else {
      unpack_plain(line, photons);
      return false;
    }
  }

  // A slot that none of the leaf's lines has is marked by the largest exponent.
  static bool unpack_compressed(const typename T::template bits<8 * kLineBytes>& line, bool further,
                                StoredPhoton (&photons)[kBucket], Line& next) {
    constexpr unsigned kSlot = 8u * kPhotonBytes;
    constexpr unsigned kSharedAt = 2 * kOtherOffsetBits + kAxisOffsetBits;
    constexpr unsigned kExponentAt = kSharedAt + 4 + 2 * kDirectionBits;
    typename T::template bits<kBucket * kSlotHeaderBits> header;
    for (unsigned slot = 0; slot < kBucket; ++slot) {
      HLS_UNROLL
      T::set_slice(header, kSlotHeaderBits * slot,
                   T::template slice<kSlotHeaderBits>(line, kSlot * slot + kRecordBits));
    }
    const uint<2> split = T::template slice<2>(header, 0), axis = T::template slice<2>(header, 2);
    const uint<1> more = T::template slice<1>(header, 4);
    const uint<kExponentBits> base = T::template slice<kExponentBits>(header, 5);
    next = T::template slice<kLineAddressBits>(line, kSlot * (kBucket - 1));

    for (unsigned slot = 0; slot < kBucket; ++slot) {
      HLS_UNROLL
      const unsigned at = kSlot * slot;
      uint<kOtherOffsetBits + 2> first = T::template slice<kOtherOffsetBits>(line, at);
      uint<kOtherOffsetBits + 2> second =
          T::template slice<kOtherOffsetBits>(line, at + kOtherOffsetBits);
      uint<kAxisOffsetBits + 4> own =
          T::template slice<kAxisOffsetBits>(line, at + 2 * kOtherOffsetBits);
      const uint<4> shared = T::template slice<4>(line, at + kSharedAt);
      uint<4> exponent = T::template slice<2>(line, at + kExponentAt);
      StoredPhoton photon;
      bool dark = true;
      for (int channel = 0; channel < kChannels; ++channel) {
        HLS_UNROLL
        photon.load.mantissa[channel] =
            T::template slice<kMantissaBits>(line, at + kExponentAt + 2 + kMantissaBits * channel);
        if (photon.load.mantissa[channel] != 0) dark = false;
      }
      const bool used = !(dark && exponent == 3);
      for (int i = 0; i < 2; ++i) {
        HLS_UNROLL
        photon.load.direction[i] =
            T::template slice<kDirectionBits>(line, at + kSharedAt + 4 + kDirectionBits * i);
      }
      // What the shared bits are, by split.
      const bool bits[4] = {shared[0], shared[1], shared[2], shared[3]};
      const bool even = axis == 3;
      for (int i = 0; i < 3; ++i) {
        HLS_UNROLL
        if (split == 0 || even) own = with_bit(own, kAxisOffsetBits + i, bits[i]);
      }
      if (even) {
        if (split == 1)
          first = with_bit(first, kOtherOffsetBits, bits[3]);
        else if (split == 2)
          second = with_bit(second, kOtherOffsetBits, bits[3]);
        else
          own = with_bit(own, kAxisOffsetBits + 3, bits[3]);
      } else {
        if (split == 1) own = with_bit(own, kAxisOffsetBits, bits[0]);
        if (split == 2) exponent = with_bit(exponent, 3, bits[0]);
        if (split != 3) exponent = with_bit(exponent, 2, bits[3]);
        if (split == 3) first = with_bit(first, kOtherOffsetBits + 1, bits[0]);
        if (split == 3) second = with_bit(second, kOtherOffsetBits + 1, bits[3]);
        if (split != 0) first = with_bit(first, kOtherOffsetBits, bits[1]);
        if (split != 0) second = with_bit(second, kOtherOffsetBits, bits[2]);
      }
      Coordinate offset[3] = {Coordinate(first), Coordinate(second), Coordinate(own)};
      if (axis == 0) {
        offset[0] = own;
        offset[1] = first;
        offset[2] = second;
      } else if (axis == 1) {
        offset[1] = own;
        offset[2] = second;
      }
      for (int c = 0; c < 3; ++c) {
        HLS_UNROLL
        const Coordinate corner =
            T::template slice<kCornerBits>(header, 5 + kExponentBits + kCornerBits * c);
        photon.position[c] = (corner << (kPositionBits - kCornerBits)) + offset[c];
      }
      photon.load.exponent = base + exponent;
      if (!used) photon.load.exponent = (1 << kExponentBits) - 1;
      if (used || !further) photons[slot] = photon;
    }
    return more == 1;
  }

  static void unpack_plain(const typename T::template bits<8 * kLineBytes>& line,
                           StoredPhoton (&photons)[kBucket]) {
    for (int slot = 0; slot < kBucket; ++slot) {
      HLS_UNROLL
      unsigned at = 8u * kPhotonBytes * static_cast<unsigned>(slot);
      StoredPhoton& photon = photons[slot];
      for (int axis = 0; axis < 3; ++axis) {
        HLS_UNROLL
        photon.position[axis] = T::template slice<kPositionBits>(line, at);
        at += kPositionBits;
      }
      for (int i = 0; i < 2; ++i) {
        HLS_UNROLL
        photon.load.direction[i] = T::template slice<kDirectionBits>(line, at);
        at += kDirectionBits;
      }
      for (int channel = 0; channel < kChannels; ++channel) {
        HLS_UNROLL
        photon.load.mantissa[channel] = T::template slice<kMantissaBits>(line, at);
        at += kMantissaBits;
      }
      photon.load.exponent = T::template slice<kExponentBits>(line, at);
    }
  }

  // ---- finish ----

  void finish(stream<Raw>& raw_results, stream<Result>& results, const uint<32>& packets) {
    for (uint<32> i = 0; i < packets; ++i) {
      HLS_PIPELINE(1);
      results.write(result_of(raw_results.read()));
    }
  }

  static Result result_of(const Raw& raw) {
    Result result;
    result.zero();
    result.pixel = raw.query.pixel;
    result.sample = raw.query.sample;
    result.tag = raw.query.tag;
    if (raw.query.flush == 1) {
      result.flush = 1;
      return result;
    }
    const Distance floor = kR2Floor;
    result.map = raw.query.map;
    result.count = raw.count;
    result.full = raw.count == kK;
    result.r2 = raw.r2;
    result.clamped = raw.r2 < floor;
    for (int channel = 0; channel < kChannels; ++channel) {
      HLS_UNROLL
      result.flux[channel] = raw.flux[channel];
    }
    result.nodes = raw.nodes;
    result.leaves = raw.leaves;
    result.insertions = raw.insertions;
    if constexpr (kReciprocalBits != 0) {
      Distance r2 = raw.r2;
      if (raw.r2 < floor) r2 = floor;
      reciprocal(r2, result);
    }
    return result;
  }

  // The named operation reciprocal(r2), W bits (golden/numeric/reciprocal.hpp): r2 with its highest
  // set bit e brought to the top and rounded half up to W + 1 bits, then floor(2^(2W) / m) bit by
  // bit.
  template <class R>
  static void reciprocal(const Distance& r2, R& result) {
    constexpr int kW = kReciprocalBits;
    constexpr int kN = at_least(kW + 2, kR2Bits);
    uint<kReciprocalExponentBits> exponent = bit_width<T, kR2Bits>(r2) - 1;
    const uint<kN> top = uint<kN>(r2) << (kN - 1 - index(exponent));
    uint<kW + 2> m = T::template slice<kW + 1>(top, kN - 1 - kW);
    if (top[kN - 2 - kW]) m += 1;
    if (m[kW + 1]) {
      m = 1 << kW;
      exponent += 1;
    }
    uint<kW + 3> rest = 1 << kW;
    uint<kW + 1> quotient = 0;
    for (int i = 0; i <= kW; ++i) {
      HLS_UNROLL
      quotient = quotient << 1;
      if (rest >= m) {
        rest = rest - m;
        quotient = quotient | uint<1>(1);
      }
      rest = rest << 1;
    }
    result.reciprocal = quotient;
    result.reciprocal_exponent = exponent;
  }

  // By context.
  uint<3> phase_[kContexts];
  Query query_[kContexts];
  Normal normal_[kContexts];
  Ticket ticket_[kContexts];
  uint<kNodeBits> node_[kContexts];  // it is at, of the leaf too
  Coordinate offset_[kContexts][3];  // of that node
  Subtree stack_[kContexts][kDepth];
  uint<clog2(kDepth + 1)> height_[kContexts];
  StoredPhoton buffer_[kContexts][kBucket];
  uint<clog2(kParts + 1) + 1> part_[kContexts];
  uint<clog2(kLanes + 1)> lane_[kContexts];  // the first of the part that was not looked at yet
  Key keys_[kContexts][kK];
  Load store_[kContexts][kK];
  Count count_[kContexts];
  Flux flux_[kContexts][kChannels];
  uint<kLineBits + 1> nodes_[kContexts], leaves_[kContexts];
  uint<kIndexBits + 1> insertions_[kContexts];
  // By ticket.
  Raw slots_[kSlots];
};

}  // namespace photonloom_hls
