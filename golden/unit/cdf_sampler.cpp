// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/cdf_sampler.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>

#include "golden/plan/plan_file.hpp"
#include "golden/unit/backend.hpp"

namespace photonloom {
namespace {

constexpr size_t kMostCells = size_t{1} << 12;

// A corner of the grid: as oct_decode, of an even point of the unfolded square.
IVec3 decode_corner(size_t column, size_t row, int a) {
  const int32_t m = int32_t{1} << a;
  const int32_t x = static_cast<int32_t>(2 * column) - m, y = static_cast<int32_t>(2 * row) - m;
  const int32_t ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
  const int32_t z = m - ax - ay;
  if (z >= 0) return {x, y, z};
  return {x < 0 ? -(m - ay) : m - ay, y < 0 ? -(m - ax) : m - ax, z};
}

}  // namespace

uint32_t cell_jacobian(const IVec3& o, int a) {
  const auto r2 = static_cast<uint64_t>(oct_dot(o, o));
  return static_cast<uint32_t>((uint64_t{28} << (4 * a)) / (r2 * r2));
}

CellGeometry::CellGeometry(int cell_bits) : edge_(size_t{1} << cell_bits) {
  for (uint32_t row = 0; row < edge_; ++row)
    for (uint32_t column = 0; column < edge_; ++column) {
      const IVec3 centre = oct_decode({column, row}, cell_bits);
      centres_.push_back(centre);
      jacobians_.push_back(cell_jacobian(centre, cell_bits));
    }
  for (size_t row = 0; row <= edge_; ++row)
    for (size_t column = 0; column <= edge_; ++column)
      corners_.push_back(decode_corner(column, row, cell_bits));
}

namespace {

// dots[i] = points[i] . n: at most 2^(6 + 14) in magnitude, so 32 bits hold it.
void dot_all(const CellGeometry::Points& points, const IVec3& n, int32_t* dots) {
  const int32_t *x = points.x.data(), *y = points.y.data(), *z = points.z.data();
  for (size_t i = 0; i < points.size(); ++i) dots[i] = x[i] * n[0] + y[i] * n[1] + z[i] * n[2];
}

// Q(c) = sum of 4^(L - 1 - l) P_l(c): P of the cell and of the blocks of 2, 4, ... cells that it
// lies in.
void add_levels(int cell_bits, int levels, uint64_t* power) {
  const size_t edge = size_t{1} << cell_bits;
  std::array<uint64_t, kMostCells> block;
  std::copy_n(power, edge * edge, block.begin());
  for (size_t c = 0; c < edge * edge; ++c) power[c] <<= 2 * (levels - 1);
  for (int l = 1; l < levels; ++l) {
    // The blocks of this level, in place: row by row of the next coarser grid.
    const size_t blocks = edge >> l;
    for (size_t row = 0; row < blocks; ++row)
      for (size_t column = 0; column < blocks; ++column) {
        const uint64_t* upper = &block[2 * row * 2 * blocks + 2 * column];
        const uint64_t* lower = upper + 2 * blocks;
        block[row * blocks + column] = upper[0] + upper[1] + lower[0] + lower[1];
      }
    for (size_t row = 0; row < edge; ++row)
      for (size_t column = 0; column < edge; ++column)
        power[row * edge + column] += block[(row >> l) * blocks + (column >> l)]
                                      << 2 * (levels - 1 - l);
  }
}

// The exact weight S(c) from Q(c) and B(c).
struct Factors {
  uint64_t power = 0, cosine = 0;
  bool product = false;
};

// The prefix sums of the narrowed weights; Exact holds the largest exact weight.
template <class Exact>
void sum_weights(const CellGeometry& geometry, const int32_t* above, const uint64_t* power,
                 const uint32_t* cosine, const Factors& factors, int narrow, uint64_t* prefix) {
  const size_t edge = geometry.edge();
  prefix[0] = 0;
  for (size_t row = 0, c = 0; row < edge; ++row)
    for (size_t column = 0; column < edge; ++column, ++c) {
      const int32_t* corner = above + row * (edge + 1) + column;
      uint64_t weight = 0;
      if (corner[0] > 0 || corner[1] > 0 || corner[edge + 1] > 0 || corner[edge + 2] > 0) {
        const Exact exact =
            factors.product ? Exact{power[c]} * cosine[c]
                            : Exact{power[c]} * factors.power + Exact{cosine[c]} * factors.cosine;
        weight = std::max<uint64_t>(1, static_cast<uint64_t>(exact >> narrow));
      }
      prefix[c + 1] = prefix[c] + weight;
    }
}

}  // namespace

SampleTable build_sample_table(const Plan& plan, const CellGeometry& geometry, OctCode normal,
                               std::span<const SamplerPhoton> photons) {
  constexpr size_t kMostCorners = 65 * 65;  // cell_bits <= 6
  const size_t cells = geometry.cells();
  const IVec3 n = oct_decode(normal, plan.normal_bits);

  std::array<uint64_t, kMostCells> power;
  std::fill_n(power.begin(), cells, 0);
  uint64_t power_total = 0;
  const int shift = plan.direction_bits - plan.cell_bits;
  photons = photons.first(std::min(photons.size(), size_t(plan.k)));
  for (const SamplerPhoton& p : photons) {
    const uint64_t value = uint64_t{p.power.mantissa[0] + p.power.mantissa[1] + p.power.mantissa[2]}
                           << p.power.exponent;
    const size_t column = p.direction.u >> shift, row = p.direction.v >> shift;
    power[(row << plan.cell_bits) + column] += value;
    power_total += value;
  }

  std::array<int32_t, kMostCells> dots;
  std::array<uint32_t, kMostCells> cosine;
  std::fill_n(dots.begin(), cells,
              0);  // as every cell has a centre it is written twice; GCC 14 insists
  dot_all(geometry.centres(), n, dots.data());
  uint64_t cosine_total = 0;
  for (size_t c = 0; c < cells; ++c) {
    cosine[c] = static_cast<uint32_t>(std::max(dots[c], 0)) * geometry.jacobians()[c];
    cosine_total += cosine[c];
  }
  std::array<int32_t, kMostCorners> above;
  dot_all(geometry.corners(), n, above.data());

  // Without power only the cosine is left.
  const TableCombine combine = plan.combine == TableCombine::kPhotons && power_total == 0
                                   ? TableCombine::kCosine
                                   : plan.combine;
  const uint64_t power_weight = std::max<uint64_t>(power_total, 1) * plan.photon_spread();
  const auto width = [](uint64_t x) { return static_cast<int>(std::bit_width(x)); };
  Factors factors;
  int bits = 0;  // of an upper bound of the sum of S
  switch (combine) {
    case TableCombine::kSum:
      factors = {cosine_total, power_weight};
      bits = width(power_weight) + width(cosine_total) + 1;
      break;
    case TableCombine::kWeighted: {
      const auto samples = static_cast<uint64_t>(plan.cosine_samples);
      factors = {photons.size() * cosine_total, samples * power_weight};
      bits = width(power_weight) + width(cosine_total) + width(photons.size() + samples);
      break;
    }
    case TableCombine::kProduct:
      factors.product = true;
      bits = width(power_weight) + plan.cell_bits + plan.normal_bits + 8;
      if (power_total == 0) std::fill_n(power.begin(), cells, 1);
      break;
    case TableCombine::kPhotons:
      factors = {1, 0};
      bits = width(power_weight);
      break;
    case TableCombine::kCosine:
      factors = {0, 1};
      bits = width(cosine_total);
      break;
  }
  const int narrow = std::max(0, bits - plan.probability_bits);
  add_levels(plan.cell_bits, plan.levels, power.data());

  SampleTable table;
  table.prefix.resize(cells + 1);
  const auto sum = bits <= 64 ? sum_weights<uint64_t> : sum_weights<UInt128>;
  sum(geometry, above.data(), power.data(), cosine.data(), factors, narrow, table.prefix.data());
  return table;
}

size_t sample_cell(const Plan& plan, const SampleTable& table, uint64_t u) {
  const auto t = static_cast<uint64_t>((UInt128{u} * table.total()) >> plan.u_bits);
  const auto after = std::upper_bound(table.prefix.begin() + 1, table.prefix.end(), t);
  return static_cast<size_t>(after - table.prefix.begin()) - 1;
}

SampledCode sampled_code(const Sample& sample) {
  return {static_cast<double>(sample.weight) / static_cast<double>(sample.total),
          {sample.direction[0], sample.direction[1]}};
}

size_t direction_bin(const Plan& plan, OctCode code) {
  const int shift = plan.sample_direction_bits() - plan.direction_bin_bits;
  return (size_t{code.u >> shift} << plan.direction_bin_bits) | (code.v >> shift);
}

Vec3 sample_direction(const Plan& plan, const SampledCode& sampled, double du, double dv) {
  const double step = std::ldexp(2.0, -plan.sample_direction_bits());
  return oct_unfold((sampled.code.u + du) * step - 1, (sampled.code.v + dv) * step - 1);
}

double sample_inverse_pdf(const Plan& plan, const SampledCode& sampled, const Vec3& direction) {
  return std::ldexp(4.0, -2 * plan.cell_bits) / sampled.probability * oct_jacobian(direction);
}

namespace {

// Collects whole tables, then builds and samples them side by side: a table's samples depend on
// nothing but its own packets.
class GoldenCdfSampler final : public CdfSampler {
 public:
  explicit GoldenCdfSampler(const Plan& plan) : plan_(plan), geometry_(plan.cell_bits) {}

  void process(std::span<const SamplerInput> in, std::vector<Sample>& out) override {
    std::vector<Job> jobs;
    if (open_) jobs.push_back(std::move(current_));
    size_t samples = out.size();
    for (const SamplerInput& p : in) {
      if (p.kind == kHeader) {
        ++tables_;
        open_ = true;
        jobs.push_back(Job{});
        jobs.back().header = p;
        continue;
      }
      if (!open_) continue;  // before the first header
      Job& job = jobs.back();
      if (p.kind == kPhoton) {
        if (!job.closed)
          job.photons.push_back({{p.mantissa, p.exponent}, {p.direction[0], p.direction[1]}});
      } else if (p.kind == kRequest) {
        if (job.requests.empty()) job.first_sample = samples;
        job.closed = true;
        job.requests.push_back(p);
        ++samples;
      }
    }
    samples_ += samples - out.size();
    out.resize(samples);
    tbb::parallel_for(size_t{0}, jobs.size(), [&](size_t i) { run(jobs[i], out); });
    if (open_) {
      current_ = std::move(jobs.back());
      current_.requests.clear();
    }
  }

  Counters counters() const override { return {{"tables", tables_}, {"samples", samples_}}; }

 private:
  static constexpr uint32_t kHeader = 0, kPhoton = 1, kRequest = 2;

  struct Job {
    SamplerInput header;
    std::vector<SamplerPhoton> photons;
    bool closed = false;  // a request has come: no photon belongs to the table any more
    SampleTable table;    // built with the first request
    std::vector<SamplerInput> requests;
    size_t first_sample = 0;
  };

  void run(Job& job, std::vector<Sample>& out) const {
    if (job.requests.empty()) return;
    if (job.table.prefix.empty())
      job.table = build_sample_table(plan_, geometry_, {job.header.normal[0], job.header.normal[1]},
                                     job.photons);
    const uint32_t mask = static_cast<uint32_t>(ones(plan_.cell_bits));
    for (size_t i = 0; i < job.requests.size(); ++i) {
      const SamplerInput& request = job.requests[i];
      const size_t cell = sample_cell(plan_, job.table, request.u);
      const auto column = static_cast<uint32_t>(cell) & mask;
      const auto row = static_cast<uint32_t>(cell) >> plan_.cell_bits;
      out[job.first_sample + i] = Sample{
          .pixel = job.header.pixel,
          .sample = job.header.sample,
          .tag = request.tag,
          .direction = {column << plan_.v_bits | request.v[0], row << plan_.v_bits | request.v[1]},
          .cell_index = static_cast<uint32_t>(cell),
          .weight = static_cast<uint32_t>(job.table.weight(cell)),
          .total = job.table.total()};
    }
  }

  const Plan plan_;
  const CellGeometry geometry_;
  bool open_ = false;  // a header has come
  Job current_;        // the table under way at the end of a call
  uint64_t tables_ = 0, samples_ = 0;
};

}  // namespace

std::unique_ptr<CdfSampler> make_golden_cdf_sampler(const Plan& plan) {
  check_plan(plan);
  return std::make_unique<GoldenCdfSampler>(plan);
}

}  // namespace photonloom
