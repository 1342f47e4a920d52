// SPDX-License-Identifier: Apache-2.0
// The CDF sampler as an HLS kernel: headers, photons and requests in, directions with their
// probability out (docs/cdf_sampler.md). Mirrors golden/unit/cdf_sampler.cpp.
//
//   collect --powers, power total------> weigh --prefix sums--> search --> samples
//      |  |----normal--> cosine --cosines, cosine total--^         ^
//      +----------------------tables, requests---------------------+
//
// Each process is one pipelined loop with an initiation interval of 1. The dependencies that allow
// it: power_, read-add-write over 2 turns, with the last block's sum forwarded; the running sum of
// weights, one addition; the search, a memory for each level, so that requests follow each other.
// What weigh needs first, the cosines' total, comes after the last cosine: `cosines` holds a table.
#pragma once
#include "hls_kernels/cdf_sampler/timing.hpp"
#include "hls_kernels/vocabulary.hpp"

namespace photonloom_hls {

// floor(28 * 16^a / |o|^4) of each cell's centre o: constants, a read-only memory.
struct CellJacobians {
  unsigned char value[1 << 2 * kCellBits];
  constexpr CellJacobians() : value() {
    const long long m = 1ll << kCellBits;
    for (int cell = 0; cell < 1 << 2 * kCellBits; ++cell) {
      long long x = 2 * (cell % m) + 1 - m, y = 2 * (cell / m) + 1 - m;
      const long long ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
      const long long z = m - ax - ay;
      if (z < 0) {
        x = m - ay;
        y = m - ax;
      }
      const long long r2 = x * x + y * y + z * z;
      value[cell] = static_cast<unsigned char>((28ll << 4 * kCellBits) / (r2 * r2));
    }
  }
};

// One level of the search: the sums that split the table into 2^(Level + 1) parts, and the levels
// above it. A level is a memory of its own.
template <class T, int Level>
struct SearchLevels {
  using Total = typename T::template uint<kTotalBits>;
  using Part = typename T::template uint<Level + 1>;
  static constexpr int kShift = kCellIndexBits - 1 - Level;

  // `sum` stands before cell `cell`, 0 < cell < 4^a.
  void load(const typename T::template uint<kCellIndexBits>& cell, const Total& sum) {
    const unsigned below = index(cell) & ((1u << (kShift + 1)) - 1);
    if (below == 1u << kShift)
      split_[index(cell) >> (kShift + 1)] = sum;
    else
      above_.load(cell, sum);
  }
  // The part of the table that holds t, and the sums at its two ends.
  Part find(const Total& t, Total& low, Total& high) const {
    const auto part = above_.find(t, low, high);
    const Total split = split_[index(part)];
    Part result = part;
    result = result << 1;
    if (t >= split) {
      low = split;
      result = result | Part(1);
    } else {
      high = split;
    }
    return result;
  }

 private:
  SearchLevels<T, Level - 1> above_;
  Total split_[1 << Level];
};
template <class T>
struct SearchLevels<T, -1> {
  using Total = typename T::template uint<kTotalBits>;
  void load(const typename T::template uint<kCellIndexBits>&, const Total&) {}
  typename T::template uint<1> find(const Total&, Total&, Total&) const { return 0; }
};

constexpr int kCellPowerBits = kPowerBits + clog2(kChannels) + clog2(kK);
// Of Q(c), the power spread over cells and blocks of cells.
constexpr int kSpreadPowerBits = kCellPowerBits + 2 * (kLevels - 1) + clog2(kLevels);

// What a level of blocks is: a memory, all cells together, or no level of this plan.
constexpr int kBlocks = 0, kWhole = 1, kBeyond = 2;
constexpr int kind_of_level(int level) {
  return level >= kLevels ? kBeyond : level == kCellBits ? kWhole : kBlocks;
}

// The power of the blocks of 2^Level x 2^Level cells, and of the levels above.
template <class T, int Level, int kKind = kind_of_level(Level)>
struct PowerLevels {
  static constexpr int kSide = kCellBits - Level;
  using Cell = typename T::template uint<kCellIndexBits>;
  using Power = typename T::template uint<kCellPowerBits>;
  using Spread = typename T::template uint<kSpreadPowerBits>;

  void clear() {
    for (int block = 0; block < 1 << 2 * kSide; ++block) power_[block] = 0;
    above_.clear();
  }
  void add(const Cell& cell, const Power& value) {
    HLS_DISTANCE(power_, SamplerTiming::kPowerTurns);
    const Cell at = block_of(cell);
    Power power = power_[index(at)];
    if (forward_ && at == last_) power = last_power_;
    last_power_ = power + value;
    last_ = at;
    forward_ = true;
    power_[index(at)] = last_power_;
    above_.add(cell, value);
  }
  // Q of a cell, of these levels; a block is 0 again when its last cell was read.
  Spread read(const Cell& cell, const Power& total) {
    const Cell at = block_of(cell);
    Power power = power_[index(at)];
    if (forward_ && at == last_) power = last_power_;
    forward_ = false;  // a turn later the memory has the last photon too
    if (is_last(cell)) power_[index(at)] = 0;
    Spread result = power;
    result = result << 2 * (kLevels - 1 - Level);
    return result + above_.read(cell, total);
  }

 private:
  static Cell block_of(const Cell& cell) {
    const Cell column = T::template slice<kSide>(cell, Level);
    const Cell row = T::template slice<kSide>(cell, kCellBits + Level);
    return row << kSide | column;
  }
  static bool is_last(const Cell& cell) {
    constexpr unsigned kInside = (1u << Level) - 1;
    return (index(cell) & (kInside << kCellBits | kInside)) == (kInside << kCellBits | kInside);
  }

  Power power_[1 << 2 * kSide];
  Power last_power_ = 0;
  Cell last_ = 0;
  bool forward_ = false;  // last_power_ is newer than the memory
  PowerLevels<T, Level + 1> above_;
};
template <class T, int Level>
struct PowerLevels<T, Level, kWhole> {
  void clear() {}
  void add(const typename T::template uint<kCellIndexBits>&,
           const typename T::template uint<kCellPowerBits>&) {}
  typename T::template uint<kSpreadPowerBits> read(
      const typename T::template uint<kCellIndexBits>&,
      const typename T::template uint<kCellPowerBits>& total) {
    return total;
  }
};
template <class T, int Level>
struct PowerLevels<T, Level, kBeyond> {
  void clear() {}
  void add(const typename T::template uint<kCellIndexBits>&,
           const typename T::template uint<kCellPowerBits>&) {}
  typename T::template uint<kSpreadPowerBits> read(
      const typename T::template uint<kCellIndexBits>&,
      const typename T::template uint<kCellPowerBits>&) {
    return 0;
  }
};

template <class T>
class CdfSampler {
  template <int W>
  using uint = typename T::template uint<W>;
  template <int W>
  using sint = typename T::template sint<W>;
  template <class E>
  using stream = typename T::template stream<E>;
  using Input = SamplerInput<T>;
  using Output = Sample<T>;

  static constexpr int kEdge = 1 << kCellBits;
  static constexpr int kCells = 1 << 2 * kCellBits;
  static constexpr bool kProduct = kCombine == 1, kWeighted = kCombine == 2;
  static constexpr bool kPhotonsAlone = kCombine == 3, kCosineAlone = kCombine == 4;
  static constexpr int kCosineBits = kCellBits + kNormalBits + 8;
  static constexpr int kCosineTotalBits = 2 * kCellBits + kCosineBits;
  // Photons and N_B together.
  static constexpr int kShareBits = kWeighted ? clog2(kK + kCosineSamples + 1) : 1;
  static constexpr int kExactBits =
      kProduct ? kSpreadPowerBits + kCosineBits : kSpreadPowerBits + kCosineTotalBits + kShareBits;

  using Cell = uint<kCellIndexBits>;
  using Power = uint<kCellPowerBits>;  // of a cell, and of all cells
  using Spread = uint<kSpreadPowerBits>;
  using Total = uint<kTotalBits>;
  struct Normal {
    uint<1> last;  // 1: no normal, the call ends
    uint<kNormalBits> u, v;
  };
  struct PowerTotal {
    uint<1> last;
    Power power;
    uint<kCountBits> photons;
  };
  struct Cosine {
    uint<kCosineBits> value;
    uint<1> touches;  // the cell touches the open upper hemisphere
  };
  static constexpr int kTable = 0, kRequest = 1, kEnd = 2;
  struct Command {
    uint<2> kind;
    uint<kPixelBits> pixel;
    uint<kSampleBits> sample;
    uint<kTagBits> tag;
    uint<kUBits> u;
    uint<kVBits> v[2];
  };

 public:
  static constexpr unsigned kInterval = 1;

  static constexpr int kPlaces = 2, kCommands = 64;  // of its streams
  // What its streams hold.
  struct StreamPlaces {
    Normal normals[kPlaces];
    PowerTotal power_totals[kPlaces];
    Spread powers[kCells];
    uint<kCosineTotalBits> cosine_totals[kPlaces];
    Cosine cosines[kCells];
    Total sums[kPlaces];
    Command commands[kCommands];
  };

  // As after reset.
  CdfSampler() {
    power_.clear();
    total_ = 0;
  }

  // Takes `packets` packets and gives a sample for each request among them.
  void run(stream<Input>& in, stream<Output>& out, const uint<32>& packets) {
    HLS_DATAFLOW;
    HLS_STREAM(T, Normal, normals, kPlaces);
    HLS_STREAM(T, PowerTotal, power_totals, kPlaces);
    HLS_STREAM(T, Spread, powers, kCells);
    HLS_STREAM(T, uint<kCosineTotalBits>, cosine_totals, kPlaces);
    HLS_STREAM(T, Cosine, cosines, kCells);
    HLS_STREAM(T, Total, sums, kPlaces);
    HLS_STREAM(T, Command, commands, kCommands);
    HLS_PROCESS(collect, collect(in, normals, power_totals, powers, commands, packets));
    HLS_PROCESS(cosine, cosine(normals, cosines, cosine_totals, packets));
    HLS_PROCESS(weigh, weigh(power_totals, powers, cosine_totals, cosines, sums, packets));
    HLS_PROCESS(search, search(commands, sums, out, packets));
    HLS_DATAFLOW_END;
  }

 private:
  // Adds photons up by cell. The first request of a table sends it on its way, a cell a turn, which
  // clears it.
  void collect(stream<Input>& in, stream<Normal>& normals, stream<PowerTotal>& power_totals,
               stream<Spread>& powers, stream<Command>& commands, const uint<32>& packets) {
    uint<32> taken = 0;
    bool sending = false, clearing = false, waiting = false;
    Input request;
    Cell cell = 0;
    for (uint<48> turn = 0; turn < (packets + 1) * (kCells + 2); ++turn) {
      HLS_PIPELINE(kInterval);
      if (sending || clearing) {
        const Spread power = power_.read(cell, total_);
        if (sending) powers.write(power);
        if (cell == kCells - 1) {
          sending = false;
          clearing = false;
          total_ = 0;
        }
        cell += 1;
      } else if (waiting) {
        send_request(request, commands);
        waiting = false;
      } else if (taken == packets) {
        break;
      } else {
        const Input p = in.read();
        taken += 1;
        if (p.kind == 0) {
          open_ = true;
          closed_ = false;
          header_ = p;
          clearing = photons_ != 0;  // of a table that nobody asked
          photons_ = 0;
          cell = 0;
        } else if (p.kind == 1 && open_ && !closed_ && photons_ < kK) {
          uint<kMantissaBits + 2> mantissa = 0;
          for (int c = 0; c < kChannels; ++c) {
            HLS_UNROLL
            mantissa = mantissa + p.mantissa[c];
          }
          const Power value = Power(mantissa) << index(p.exponent);
          const Cell row = T::template slice<kCellBits>(p.direction[1], kDirectionBits - kCellBits);
          const Cell column =
              T::template slice<kCellBits>(p.direction[0], kDirectionBits - kCellBits);
          power_.add(row << kCellBits | column, value);
          total_ = total_ + value;
          photons_ += 1;
        } else if (p.kind == 2 && open_) {
          if (closed_) {
            send_request(p, commands);
          } else {
            normals.write(Normal{0, header_.normal[0], header_.normal[1]});
            power_totals.write(PowerTotal{0, total_, photons_});
            Command table = {};
            table.kind = kTable;
            commands.write(table);
            request = p;
            waiting = true;
            sending = true;
            closed_ = true;
            photons_ = 0;
            cell = 0;
          }
        }
      }
    }
    normals.write(Normal{1, 0, 0});
    power_totals.write(PowerTotal{1, 0, 0});
    Command end = {};
    end.kind = kEnd;
    commands.write(end);
  }

  void send_request(const Input& p, stream<Command>& commands) const {
    Command command;
    command.kind = kRequest;
    command.pixel = header_.pixel;
    command.sample = header_.sample;
    command.tag = p.tag;
    command.u = p.u;
    command.v[0] = p.v[0];
    command.v[1] = p.v[1];
    commands.write(command);
  }

  // B(c) of every cell, and whether it touches the upper hemisphere; then their sum.
  void cosine(stream<Normal>& normals, stream<Cosine>& cosines,
              stream<uint<kCosineTotalBits>>& totals, const uint<32>& packets) {
    Direction<T, kNormalBits> n = Direction<T, kNormalBits>::decode(0, 0);
    uint<kCosineTotalBits> total = 0;
    uint<kCellIndexBits + 1> cell = kCells;  // kCells: between two tables
    for (uint<48> turn = 0; turn < (packets + 1) * (kCells + 1); ++turn) {
      HLS_PIPELINE(kInterval);
      if (cell == kCells) {
        const Normal normal = normals.read();
        if (normal.last == 1) break;
        n = Direction<T, kNormalBits>::decode(normal.u, normal.v);
        total = 0;
        cell = 0;
      } else {
        const Cosine cosine = cosine_of(cell, n);
        cosines.write(cosine);
        total = total + cosine.value;
        if (cell == kCells - 1) totals.write(total);
        cell += 1;
      }
    }
  }

  static Cosine cosine_of(const Cell& cell, const Direction<T, kNormalBits>& n) {
    static constexpr CellJacobians kJacobians{};
    using Side = sint<kNormalBits + 4>;
    const uint<kCellBits> column = T::template slice<kCellBits>(cell, 0);
    const uint<kCellBits> row = T::template slice<kCellBits>(cell, kCellBits);
    const Direction<T, kCellBits> centre = Direction<T, kCellBits>::decode(column, row);
    const sint<kCellBits + kNormalBits + 2> above = dot<T, kCellBits, kNormalBits>(centre, n);
    // How far the highest corner lies above the centre: a cell is flat, or folds over the equator.
    Side a = n.x, b = n.y;
    if (centre.x < 0) a = 0 - a;
    if (centre.y < 0) b = 0 - b;
    Side margin = 0;
    if (centre.z > 0) {
      margin = size(a - n.z) + size(b - n.z);
    } else if (centre.z < 0) {
      margin = size(a + n.z) + size(b + n.z);
    } else {
      margin = size(a - b);
      const Side z = size(n.z);
      const Side fold = z + z - a - b;
      if (fold > margin) margin = fold;
    }
    Cosine result;
    result.touches = above + margin > 0;
    result.value = 0;
    if (above > 0) {
      const uint<kCellBits + kNormalBits + 1> height = above;
      const uint<8> jacobian = kJacobians.value[index(cell)];
      result.value = height * jacobian;
    }
    return result;
  }

  static sint<kNormalBits + 4> size(const sint<kNormalBits + 4>& x) {
    sint<kNormalBits + 4> result = x;
    if (x < 0) result = 0 - x;
    return result;
  }

  // The narrowed weights, added up from the first cell on: F(c + 1) for each cell c.
  void weigh(stream<PowerTotal>& power_totals, stream<Spread>& powers,
             stream<uint<kCosineTotalBits>>& cosine_totals, stream<Cosine>& cosines,
             stream<Total>& sums, const uint<32>& packets) {
    bool no_power = false;
    uint<kCosineTotalBits + kCountBits> power_factor = 0;
    uint<kSpreadPowerBits + 8> cosine_factor = 0;
    uint<8> narrow = 0;
    Total sum = 0;
    uint<kCellIndexBits + 1> cell = kCells;
    for (uint<48> turn = 0; turn < (packets + 1) * (kCells + 1); ++turn) {
      HLS_PIPELINE(kInterval);
      if (cell == kCells) {
        const PowerTotal next = power_totals.read();
        if (next.last == 1) break;
        const uint<kCosineTotalBits> cosine_total = cosine_totals.read();
        no_power = next.power == 0;
        Power power_weight = next.power;
        if (no_power) power_weight = 1;
        // What a photon counts in all cells together.
        const uint<3> levels = kLevels;
        Spread spread_weight = power_weight * levels;
        spread_weight = spread_weight << 2 * (kLevels - 1);
        const uint<8> power_width = bit_width<T, kSpreadPowerBits>(spread_weight);
        const uint<8> cosine_width = bit_width<T, kCosineTotalBits>(cosine_total);
        power_factor = cosine_total;
        cosine_factor = spread_weight;
        uint<8> bits = power_width + cosine_width + 1;
        if (kWeighted) {
          const uint<8> samples = kCosineSamples;
          power_factor = cosine_total * next.photons;
          cosine_factor = spread_weight * samples;
          const uint<kShareBits> share = next.photons + samples;
          bits = power_width + cosine_width + bit_width<T, kShareBits>(share);
        } else if (kProduct) {
          bits = power_width + kCellBits + kNormalBits + 8;
        } else if (kPhotonsAlone && !no_power) {
          bits = power_width;
        } else if (kPhotonsAlone || kCosineAlone) {
          bits = cosine_width;
        }
        narrow = 0;
        if (bits > kProbabilityBits) narrow = bits - kProbabilityBits;
        sum = 0;
        cell = 0;
      } else {
        const Spread power = powers.read();
        const Cosine cosine = cosines.read();
        uint<kExactBits> exact = 0;
        if (kProduct && no_power) {
          exact = cosine.value * cosine_factor;
        } else if (kProduct) {
          exact = cosine.value * power;
        } else if (kPhotonsAlone && !no_power) {
          exact = power;
        } else if (kPhotonsAlone || kCosineAlone) {
          exact = cosine.value;
        } else {
          exact = power * power_factor + cosine.value * cosine_factor;
        }
        uint<kProbabilityBits> weight = exact >> index(narrow);
        if (weight == 0) weight = 1;
        if (cosine.touches == 0) weight = 0;
        sum = sum + weight;
        sums.write(sum);
        cell += 1;
      }
    }
  }

  // Answers requests from the last table that came.
  void search(stream<Command>& commands, stream<Total>& sums, stream<Output>& out,
              const uint<32>& packets) {
    uint<kCellIndexBits + 1> cell = kCells;  // kCells: no table is being loaded
    for (uint<48> turn = 0; turn < (packets + 1) * (kCells + 2); ++turn) {
      HLS_PIPELINE(kInterval);
      if (cell != kCells) {
        const Total sum = sums.read();
        cell += 1;
        if (cell == kCells)
          table_total_ = sum;
        else
          levels_.load(cell, sum);
      } else {
        const Command command = commands.read();
        if (command.kind == kEnd) break;
        if (command.kind == kTable)
          cell = 0;
        else
          out.write(answer(command));
      }
    }
  }

  Output answer(const Command& request) const {
    const uint<kUBits + kTotalBits> scaled = request.u * table_total_;
    const Total t = T::template slice<kTotalBits>(scaled, kUBits);
    Total low = 0, high = table_total_;
    const Cell cell = levels_.find(t, low, high);
    const uint<kCellBits> column = T::template slice<kCellBits>(cell, 0);
    const uint<kCellBits> row = T::template slice<kCellBits>(cell, kCellBits);
    Output sample;
    sample.zero();
    sample.pixel = request.pixel;
    sample.sample = request.sample;
    sample.tag = request.tag;
    sample.direction[0] = uint<kSampleDirectionBits>(column) << kVBits | request.v[0];
    sample.direction[1] = uint<kSampleDirectionBits>(row) << kVBits | request.v[1];
    sample.cell_index = cell;
    sample.weight = high - low;
    sample.total = table_total_;
    return sample;
  }

  // of collect
  PowerLevels<T, 0> power_;
  Power total_;
  Input header_;
  bool open_ = false, closed_ = false;  // a header has come; a request of its table too
  uint<kCountBits> photons_ = 0;
  // of search
  SearchLevels<T, kCellIndexBits - 1> levels_;
  Total table_total_ = 0;
};

}  // namespace photonloom_hls
