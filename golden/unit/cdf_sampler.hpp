// SPDX-License-Identifier: Apache-2.0
// The sampler's table and the density of what it samples; all defined in docs/cdf_sampler.md.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "golden/numeric/bits.hpp"
#include "golden/numeric/octahedral.hpp"
#include "golden/numeric/shared_exponent.hpp"
#include "golden/packet/packet.hpp"
#include "golden/plan/plan.hpp"

namespace photonloom {

// Proportional to 1 / |o|^4 of a cell centre o of a 2^a x 2^a table: floor(28 * 16^a / |o|^4), 28
// to 252. One |o|^-3 is the solid angle of the cell, the other the length that the cosine's
// unnormalised dot product has too much.
uint32_t cell_jacobian(const IVec3& centre, int a);

// What is the same for every table of a plan: the cells' centres, corners and Jacobians.
class CellGeometry {
 public:
  // Points by coordinate, |x| + |y| + |z| = 2^a; a loop over all of them vectorises.
  struct Points {
    std::vector<int32_t> x, y, z;
    void push_back(const IVec3& p) {
      x.push_back(p[0]);
      y.push_back(p[1]);
      z.push_back(p[2]);
    }
    size_t size() const { return x.size(); }
    IVec3 operator[](size_t i) const { return {x[i], y[i], z[i]}; }
  };

  explicit CellGeometry(int cell_bits);

  size_t edge() const { return edge_; }
  size_t cells() const { return centres_.size(); }
  IVec3 centre(size_t cell) const { return centres_[cell]; }
  const Points& centres() const { return centres_; }
  const Points& corners() const { return corners_; }  // of the grid, row * (edge + 1) + column
  const std::vector<uint32_t>& jacobians() const { return jacobians_; }

 private:
  size_t edge_;
  Points centres_, corners_;
  std::vector<uint32_t> jacobians_;
};

struct SamplerPhoton {
  PowerCode power;
  OctCode direction;  // direction_bits a coordinate
};

// prefix[c] is F(c), the sum of the weights of the cells before c; prefix.back() is W.
struct SampleTable {
  std::vector<uint64_t> prefix;
  uint64_t weight(size_t cell) const { return prefix[cell + 1] - prefix[cell]; }
  uint64_t total() const { return prefix.back(); }
};

// Photons beyond the plan's k are ignored, as by the hardware.
SampleTable build_sample_table(const Plan& plan, const CellGeometry& geometry, OctCode normal,
                               std::span<const SamplerPhoton> photons);

// The cell with F(c) <= t < F(c+1), t = floor(u * W / 2^u_bits).
size_t sample_cell(const Plan& plan, const SampleTable& table, uint64_t u);

// What a sample says to who casts its ray: the code, sample_direction_bits() a coordinate, and the
// probability w / W of its cell.
struct SampledCode {
  double probability = 0;
  OctCode code;
};
SampledCode sampled_code(const Sample& sample);

// The bin of a sampled code: the top direction_bin_bits of both coordinates, the first on top.
size_t direction_bin(const Plan& plan, OctCode code);
inline size_t direction_bins(const Plan& plan) {
  return size_t{1} << (2 * plan.direction_bin_bits);
}

// The direction of a sample, jittered uniformly inside the code's square by (du, dv) in [0, 1)^2;
// not normalised (|x| + |y| + |z| = 1). (0.5, 0.5) is the code's centre.
Vec3 sample_direction(const Plan& plan, const SampledCode& sampled, double du, double dv);

// 1 / the density per solid angle, in sr, with which the sampler picks a direction of this cell, as
// sample_direction returns it: the cell's area 4 / 4^a of the square [-1, 1]^2 and the mapping's
// Jacobian over w / W. Exact for directions placed uniformly in the cell.
double sample_inverse_pdf(const Plan& plan, const SampledCode& sampled, const Vec3& direction);

}  // namespace photonloom
