// SPDX-License-Identifier: Apache-2.0
// The CDF sampler at its ends.
#include <algorithm>
#include <cmath>

#include "golden/numeric/octahedral.hpp"
#include "golden/numeric/random.hpp"
#include "tests/extremes/suite/suite.hpp"

namespace photonloom::extremes {
namespace {

using In = std::vector<SamplerInput>;
using Out = std::vector<Sample>;

Plan usual_sampler() { return Plan{}; }

// Every width at its least; 16 bits of u can all be tried.
Plan least_sampler() {
  Plan plan;
  plan.cell_bits = 1;
  plan.direction_bits = plan.normal_bits = 2;
  plan.mantissa_bits = 2;
  plan.exponent_bits = 1;
  plan.channels = 1;
  plan.photon_bytes = 8;
  plan.k = 1;
  plan.probability_bits = 4;
  plan.u_bits = 16;
  plan.v_bits = 1;
  return plan;
}

Plan greatest_sampler() {
  Plan plan;
  plan.cell_bits = 6;
  plan.direction_bits = plan.normal_bits = 14;
  plan.mantissa_bits = 16;
  plan.photon_bytes = 32;
  plan.k = 256;
  plan.probability_bits = 24;
  plan.u_bits = 48;
  plan.v_bits = 12;
  return plan;
}

// Few cells of all weights, u of 16 bits: the inversion can be looked at code by code.
Plan all_codes(TableCombine combine) {
  Plan plan;
  plan.cell_bits = 2;
  plan.probability_bits = 4;
  plan.u_bits = 16;
  plan.k = 16;
  plan.combine = combine;
  if (combine == TableCombine::kProduct) plan.probability_bits = 4;
  return plan;
}

SamplerInput header(const Plan& plan, const Vec3& normal) {
  SamplerInput p{};
  const OctCode code = oct_encode(normal, plan.normal_bits);
  p.normal = {code.u, code.v};
  return p;
}

SamplerInput photon(const Plan& plan, const Vec3& direction, uint32_t mantissa = 1,
                    uint32_t exponent = 0) {
  SamplerInput p{};
  p.kind = 1;
  const OctCode code = oct_encode(direction, plan.direction_bits);
  p.direction = {code.u, code.v};
  for (int c = 0; c < plan.channels; ++c) p.mantissa[static_cast<size_t>(c)] = mantissa;
  p.exponent = exponent;
  return p;
}

SamplerInput request(uint64_t u, Pair32 v = {0, 0}, uint32_t tag = 0) {
  SamplerInput p{};
  p.kind = 2;
  p.u = u;
  p.v = v;
  p.tag = tag;
  return p;
}

// n requests at even steps, from u = 0 to all ones.
void add_requests(In& in, const Plan& plan, uint64_t n) {
  const uint64_t top = ones(plan.u_bits);
  for (uint64_t i = 0; i < n; ++i)
    in.push_back(request(i + 1 == n ? top : static_cast<uint64_t>(UInt128{top} * i / (n - 1))));
}

// The table as docs/cdf_sampler.md has it, in double and 128-bit integers, cell by cell, for L = 1
// and the sum, the product, photons or the cosine alone.
struct Table {
  std::vector<uint64_t> weight;
  std::vector<double> exact;  // S(c), before it is narrowed, over its sum
  uint64_t total = 0;
};
Table by_the_page(const Plan& plan, const SamplerInput& head,
                  std::span<const SamplerInput> photons) {
  const int m = 1 << plan.cell_bits;
  const auto unfold = [](double column, double row, double cells) {
    return oct_unfold(2 * column / cells - 1, 2 * row / cells - 1) * cells;
  };
  const double normals = std::ldexp(1.0, plan.normal_bits);
  const Vec3 n = unfold(head.normal[0] + 0.5, head.normal[1] + 0.5, normals);
  std::vector<UInt128> power(static_cast<size_t>(m * m)), cosine(power.size());
  UInt128 power_total = 0, cosine_total = 0;
  for (const SamplerInput& p : photons.first(std::min(photons.size(), size_t(plan.k)))) {
    const UInt128 value = UInt128{p.mantissa[0]} + p.mantissa[1] + p.mantissa[2];
    const int shift = plan.direction_bits - plan.cell_bits;
    power[(p.direction[1] >> shift) * static_cast<uint32_t>(m) + (p.direction[0] >> shift)] +=
        value << p.exponent;
    power_total += value << p.exponent;
  }
  std::vector<bool> above(power.size());
  for (int row = 0; row < m; ++row)
    for (int column = 0; column < m; ++column) {
      const size_t c = static_cast<size_t>(row * m + column);
      const Vec3 o = unfold(column + 0.5, row + 0.5, m);
      const double square = glm::dot(o, o);  // an integer
      const auto j = static_cast<uint64_t>(std::floor(28 * std::pow(m, 4) / (square * square)));
      const double dot = glm::dot(o, n);
      cosine[c] = dot > 0 ? static_cast<UInt128>(dot) * j : 0;
      cosine_total += cosine[c];
      for (const int dr : {0, 1})
        for (const int dc : {0, 1})
          if (glm::dot(unfold(column + dc, row + dr, m), n) > 0) above[c] = true;
    }
  const bool dark = power_total == 0;
  const auto bits = [](UInt128 x) {
    int b = 0;
    for (; x > 0; x >>= 1) ++b;
    return b;
  };
  const UInt128 tp = dark ? 1 : power_total;
  TableCombine combine = plan.combine;
  if (combine == TableCombine::kPhotons && dark) combine = TableCombine::kCosine;
  int bound = 0;
  std::vector<UInt128> exact(power.size());
  for (size_t c = 0; c < power.size(); ++c) switch (combine) {
      case TableCombine::kSum:
        bound = bits(tp) + bits(cosine_total) + 1;
        exact[c] = power[c] * cosine_total + cosine[c] * tp;
        break;
      case TableCombine::kProduct:
        bound = bits(tp) + plan.cell_bits + plan.normal_bits + 8;
        exact[c] = (dark ? 1 : power[c]) * cosine[c];
        break;
      case TableCombine::kPhotons:
        bound = bits(tp);
        exact[c] = power[c];
        break;
      default:
        bound = bits(cosine_total);
        exact[c] = cosine[c];
    }
  const int narrow = std::max(0, bound - plan.probability_bits);
  Table table;
  double sum = 0;
  for (size_t c = 0; c < power.size(); ++c) {
    const auto w = static_cast<uint64_t>(exact[c] >> narrow);
    table.weight.push_back(above[c] ? std::max<uint64_t>(1, w) : 0);
    table.total += table.weight.back();
    table.exact.push_back(static_cast<double>(exact[c]));
    sum += table.exact.back();
  }
  for (double& x : table.exact) x /= sum;
  return table;
}

// The cell that t = floor(u W / 2^n) falls into, by adding weights up.
size_t cell_of(const Plan& plan, const Table& table, uint64_t u) {
  const auto t = static_cast<uint64_t>(UInt128{u} * table.total >> plan.u_bits);
  uint64_t sum = 0;
  for (size_t c = 0;; ++c) {
    sum += table.weight[c];
    if (t < sum) return c;
  }
}

// One table; its samples beside the page's.
Out check_table(Run& run, const Plan& plan, const In& in) {
  const Out out = run.process<CdfSampler>(plan, in);
  size_t photons = 1;
  while (photons < in.size() && in[photons].kind == 1) ++photons;
  const Table table = by_the_page(plan, in[0], std::span(in).subspan(1, photons - 1));
  std::vector<uint64_t> due, got;
  size_t sample = 0;
  for (size_t i = photons; i < in.size(); ++i) {
    if (in[i].kind != 2) continue;
    const size_t cell = cell_of(plan, table, in[i].u);
    due.insert(due.end(), {cell, table.weight[cell], table.total});
    if (sample < out.size())
      got.insert(got.end(), {out[sample].cell_index, out[sample].weight, out[sample].total});
    ++sample;
  }
  run.same("cells, weights, totals", due, got);
  uint64_t backwards = 0;
  for (size_t i = 1; i < out.size(); ++i) backwards += out[i].cell_index < out[i - 1].cell_index;
  run.exact("steps back", 0, backwards);
  return out;
}

// Photons in all directions with powers over the whole range.
In table_of(const Plan& plan, const Vec3& normal, int photons) {
  In in{header(plan, normal)};
  for (int i = 0; i < photons; ++i) {
    const auto h = [&](uint64_t d) { return to_unit(hash_bits(3, uint64_t(i), 0, d)) - 0.5; };
    in.push_back(photon(
        plan, Vec3(h(0), h(1), h(2)),
        1 + static_cast<uint32_t>(hash_bits(3, uint64_t(i), 1, 0) % ones(plan.mantissa_bits)),
        static_cast<uint32_t>(hash_bits(3, uint64_t(i), 1, 1) & ones(plan.exponent_bits))));
  }
  return in;
}

// Every code of u: each cell gets its share of the codes, to within one.
Case every_code(const char* name, TableCombine combine, int photons) {
  return {name, Known::kClosedForm,
          "a cell of weight w is taken by ceil(F' 2^16 / W) - ceil(F 2^16 / W) of the 2^16 codes, "
          "cells never go back as u grows",
          [combine, photons](Run& run) {
            const Plan plan = all_codes(combine);
            In in = table_of(plan, Vec3(0.3, -0.2, 0.9), photons);
            const size_t first = in.size();
            for (uint64_t u = 0; u < 65536; ++u) in.push_back(request(u));
            const Out out = check_table(run, plan, in);
            const Table table = by_the_page(plan, in[0], std::span(in).subspan(1, first - 1));
            std::vector<uint64_t> due, got(table.weight.size());
            uint64_t sum = 0;
            const auto codes = [&](uint64_t f) {
              return ((f << 16) + table.total - 1) / table.total;
            };
            for (const uint64_t w : table.weight) {
              due.push_back(codes(sum + w) - codes(sum));
              sum += w;
            }
            for (const Sample& s : out) ++got[s.cell_index];
            run.same("codes of each cell", due, got);
          }};
}

Case normal_case(const char* name, const Vec3& normal) {
  return {
      name, Known::kDefinition,
      "cells with a corner above the surface have weight 1 and more, the others none: by the page, "
      "cell by cell",
      [normal](Run& run) {
        const Plan plan = usual_sampler();
        In in = table_of(plan, normal, 50);
        add_requests(in, plan, 600);
        check_table(run, plan, in);
      }};
}

}  // namespace

Group sampler_cases() {
  std::vector<Case> cases{
      {"no photons", Known::kClosedForm,
       "the cosine alone: by the page; with the normal near +z the sum of the probabilities in the "
       "upper half is 1",
       [](Run& run) {
         const Plan plan = usual_sampler();
         In in{header(plan, Vec3(0, 0, 1))};
         add_requests(in, plan, 500);
         check_table(run, plan, in);
       }},
      {"photons without power", Known::kClosedForm, "as no photons: the same samples, bit by bit",
       [](Run& run) {
         const Plan plan = usual_sampler();
         In none{header(plan, Vec3(0, 0, 1))}, dark = none;
         for (int i = 0; i < 50; ++i) dark.push_back(photon(plan, Vec3(i, 3, 4), 0));
         add_requests(none, plan, 300);
         add_requests(dark, plan, 300);
         run.same("samples", run.process<CdfSampler>(plan, none), check_table(run, plan, dark));
       }},
      {"all power in one cell", Known::kClosedForm,
       "photons and cosine have half of the probability each: that cell's is 1/2 plus its cosine's "
       "half",
       [](Run& run) {
         const Plan plan = usual_sampler();
         In in{header(plan, Vec3(0, 0, 1))};
         for (int i = 0; i < 50; ++i) in.push_back(photon(plan, Vec3(0.5, 0.4, 0.8), 511, 31));
         add_requests(in, plan, 1000);
         const Out out = check_table(run, plan, in);
         uint32_t most = 0;
         double total = 1;
         for (const Sample& s : out)
           if (s.weight > most) {
             most = s.weight;
             total = static_cast<double>(s.total);
           }
         const Table table = by_the_page(plan, in[0], std::span(in).subspan(1, 50));
         // 2^16 codes of weight over at least half of them in W; 256 floors.
         run.near("probability", *std::max_element(table.exact.begin(), table.exact.end()),
                  most / total, 2 * (256.0 + 1) / 32768);
       }},
      {"one photon 2^31 times all others", Known::kClosedForm,
       "the others' cells keep the cosine and the floor: no cell above the surface is lost",
       [](Run& run) {
         const Plan plan = usual_sampler();
         In in{header(plan, Vec3(0, 0, 1))};
         in.push_back(photon(plan, Vec3(0.5, 0.4, 0.8), 256, 31));
         for (int i = 1; i < 50; ++i) in.push_back(photon(plan, Vec3(i - 25, 10, 30), 1, 0));
         add_requests(in, plan, 1000);
         check_table(run, plan, in);
       }},
      {"least weights", Known::kDefinition,
       "with 4 bits of probability nearly every cell is at the floor of 1; none above is 0, none "
       "below is not",
       [](Run& run) {
         const Plan plan = all_codes(TableCombine::kSum);
         In in{header(plan, Vec3(0.1, 0.2, 1))};
         in.push_back(photon(plan, Vec3(1, 1, 1), 511, 31));
         add_requests(in, plan, 5000);
         const Out out = check_table(run, plan, in);
         run.holds("a weight of 1", std::any_of(out.begin(), out.end(),
                                                [](const Sample& s) { return s.weight == 1; }));
       }},
      {"largest powers, k of them", Known::kClosedForm,
       "50 * 3 * 511 * 2^31 in one cell and one unit in another: by the page in 128 bits, no sum "
       "wraps",
       [](Run& run) {
         const Plan plan = usual_sampler();
         In in{header(plan, Vec3(0, 0, 1))};
         for (int i = 0; i < 49; ++i) in.push_back(photon(plan, Vec3(1, 0.2, 0.8), 511, 31));
         in.push_back(photon(plan, Vec3(-1, 0.2, 0.8), 1, 0));
         add_requests(in, plan, 500);
         check_table(run, plan, in);
       }},
      {"u = 0 and u all ones", Known::kClosedForm,
       "the first and the last cell with a weight, whatever the table",
       [](Run& run) {
         const Plan plan = usual_sampler();
         for (const Vec3& n : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)}) {
           In in = table_of(plan, n, 20);
           in.push_back(request(0));
           in.push_back(request(ones(32)));
           const Out out = check_table(run, plan, in);
           const Table table = by_the_page(plan, in[0], std::span(in).subspan(1, 20));
           size_t first = 0, last = table.weight.size() - 1;
           while (table.weight[first] == 0) ++first;
           while (table.weight[last] == 0) --last;
           run.exact("first", first, out.at(0).cell_index);
           run.exact("last", last, out.at(1).cell_index);
         }
       }},
      {"v = 0 and v all ones", Known::kClosedForm,
       "the direction is the cell's first and last code: cell << 8 and cell << 8 | 255",
       [](Run& run) {
         const Plan plan = usual_sampler();
         In in = table_of(plan, Vec3(0, 0, 1), 20);
         in.push_back(request(ones(31), {0, 0}));
         in.push_back(request(ones(31), {255, 255}));
         const Out out = run.process<CdfSampler>(plan, in);
         const uint32_t column = out.at(0).cell_index % 16, row = out.at(0).cell_index / 16;
         run.exact("u", column << 8, out.at(0).direction[0]);
         run.exact("v", row << 8, out.at(0).direction[1]);
         run.exact("u", column << 8 | 255, out.at(1).direction[0]);
         run.exact("v", row << 8 | 255, out.at(1).direction[1]);
       }},
      every_code("every code of u, sum", TableCombine::kSum, 12),
      every_code("every code of u, product", TableCombine::kProduct, 12),
      every_code("every code of u, photons", TableCombine::kPhotons, 3),
      every_code("every code of u, no photons", TableCombine::kSum, 0),
      normal_case("normal +x", Vec3(1, 0, 0)),
      normal_case("normal -x", Vec3(-1, 0, 0)),
      normal_case("normal +y", Vec3(0, 1, 0)),
      normal_case("normal -y", Vec3(0, -1, 0)),
      normal_case("normal +z", Vec3(0, 0, 1)),
      normal_case("normal -z", Vec3(0, 0, -1)),
      normal_case("normal on a seam", Vec3(1, 1, 0)),
      normal_case("normal below a seam", Vec3(1, -1, -0.01)),
      normal_case("normal at a face's centre", Vec3(1, 1, -1)),
      {"more photons than k", Known::kDefinition, "those beyond the k-th are ignored",
       [](Run& run) {
         const Plan plan = usual_sampler();
         In in = table_of(plan, Vec3(0, 0, 1), 50), more = in;
         for (int i = 0; i < 9; ++i) more.push_back(photon(plan, Vec3(1, 0, 1), 511, 31));
         add_requests(in, plan, 100);
         add_requests(more, plan, 100);
         run.same("samples", run.process<CdfSampler>(plan, in),
                  run.process<CdfSampler>(plan, more));
       }},
      {"a photon after a request", Known::kDefinition, "it belongs to no table any more",
       [](Run& run) {
         const Plan plan = usual_sampler();
         In in = table_of(plan, Vec3(0, 0, 1), 5);
         in.push_back(request(1u << 30));
         In late = in;
         late.push_back(photon(plan, Vec3(1, 0, 1), 511, 31));
         for (In* list : {&in, &late}) list->push_back(request(3u << 30));
         run.same("samples", run.process<CdfSampler>(plan, in),
                  run.process<CdfSampler>(plan, late));
       }},
      {"packets before the first header", Known::kDefinition, "they are ignored",
       [](Run& run) {
         const Plan plan = usual_sampler();
         In in{photon(plan, Vec3(0, 0, 1), 9), request(5)};
         run.exact("samples", 0, run.process<CdfSampler>(plan, in).size());
       }},
      {"tables without requests", Known::kDefinition,
       "20 headers in a row: the last one's samples only",
       [](Run& run) {
         const Plan plan = usual_sampler();
         In in;
         for (int i = 0; i < 20; ++i) {
           const In table = table_of(plan, Vec3(i - 10, 3, 5), i);
           in.insert(in.end(), table.begin(), table.end());
         }
         in.push_back(request(77));
         run.exact("samples", 1, run.process<CdfSampler>(plan, in).size());
       }},
      {"10,000 requests to one table", Known::kClosedForm, "by the page, in order",
       [](Run& run) {
         const Plan plan = usual_sampler();
         In in = table_of(plan, Vec3(0.2, 0.1, 1), 50);
         add_requests(in, plan, 10000);
         check_table(run, plan, in);
       }},
      {"cell_bits = 1, direction_bits = 2, normal_bits = 2, k = 1, probability_bits = 4, v_bits = "
       "1",
       Known::kClosedForm, "4 cells, every code of u: by the page",
       [](Run& run) {
         const Plan plan = least_sampler();
         for (uint32_t n = 0; n < 16; n += 5) {
           In in{header(plan, Vec3(0, 0, 1)), photon(plan, Vec3(1, 1, 1), 3, 1)};
           in[0].normal = {n % 4, n / 4};
           for (uint64_t u = 0; u < 65536; u += 7) in.push_back(request(u));
           in.push_back(request(65535));
           check_table(run, plan, in);
         }
       }},
      {"cell_bits = 6, direction_bits = 14, normal_bits = 14, k = 256, probability_bits = 24, "
       "u_bits = 48",
       Known::kClosedForm, "4,096 cells of 24 bits, powers of 16 + 5 bits: by the page in 128 bits",
       [](Run& run) {
         const Plan plan = greatest_sampler();
         In in = table_of(plan, Vec3(0.1, -0.7, 0.2), 256);
         add_requests(in, plan, 2000);
         check_table(run, plan, in);
       }},
      {"greatest widths, all power in one direction", Known::kClosedForm,
       "256 * 3 * 65535 * 2^31 in a cell: the weights narrowed once, by the page",
       [](Run& run) {
         const Plan plan = greatest_sampler();
         In in{header(plan, Vec3(0, 0, 1))};
         for (int i = 0; i < 256; ++i) in.push_back(photon(plan, Vec3(0.1, 0.2, 0.9), 65535, 31));
         add_requests(in, plan, 500);
         check_table(run, plan, in);
       }},
      {"u_bits too few", Known::kRefusal,
       "u with less than 8 bits more than the total would make cells of least weight unlikely",
       [](Run& run) {
         Plan plan = usual_sampler();
         plan.u_bits = plan.total_bits() + 7;
         run.refused("sampler.u_bits is 31, expected at least 8 bits more",
                     [&] { run.process<CdfSampler>(plan, {}); });
       }},
      {"more cells than directions", Known::kRefusal,
       "a photon's cell is the top bits of its direction",
       [](Run& run) {
         Plan plan = usual_sampler();
         plan.direction_bits = 3;
         run.refused("sampler.cell_bits is 4", [&] { run.process<CdfSampler>(plan, {}); });
       }},
      {"levels beyond the cells", Known::kRefusal, "2 x 2 cells have two block sizes",
       [](Run& run) {
         Plan plan = usual_sampler();
         plan.cell_bits = 1;
         plan.levels = 3;
         run.refused("sampler.levels is 3", [&] { run.process<CdfSampler>(plan, {}); });
       }},
  };
  return {"cdf_sampler",
          "Plans: the usual one; 16 cells with 16 bits of u by sum, product and photons; every "
          "width at "
          "its least; every width at its greatest.",
          std::move(cases)};
}

}  // namespace photonloom::extremes
