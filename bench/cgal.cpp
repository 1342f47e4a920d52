// SPDX-License-Identifier: Apache-2.0
#include <CGAL/Kd_tree.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <algorithm>
#include <boost/tuple/tuple.hpp>

#include "bench/contender.hpp"

namespace photonloom::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<float>;
using Numbered = boost::tuple<Kernel::Point_3, uint32_t>;
using Traits = CGAL::Search_traits_adapter<Numbered, CGAL::Nth_of_tuple_property_map<0, Numbered>,
                                           CGAL::Search_traits_3<Kernel>>;
using Splitter = CGAL::Sliding_midpoint<Traits>;
using Distance = CGAL::Distance_adapter<Numbered, CGAL::Nth_of_tuple_property_map<0, Numbered>,
                                        CGAL::Euclidean_distance<CGAL::Search_traits_3<Kernel>>>;

// `Cached`: the tree keeps a copy of the coordinates in the order of its leaves.
template <class Cached>
class Cgal final : public Contender {
  using Tree = CGAL::Kd_tree<Traits, Splitter, CGAL::Tag_true, Cached>;
  using Search = CGAL::Orthogonal_k_neighbor_search<Traits, Distance, Splitter, Tree>;

 public:
  Cgal(const std::vector<UVec3>& points, int leaf) : points_(points.size()), leaf_(leaf) {
    std::vector<Numbered> numbered;
    for (uint32_t i = 0; i < points.size(); ++i)
      numbered.emplace_back(
          Kernel::Point_3(static_cast<float>(points[i][0]), static_cast<float>(points[i][1]),
                          static_cast<float>(points[i][2])),
          i);
    const double heap_before = heap_bytes(), start = now();
    tree_ = std::make_unique<Tree>(numbered.begin(), numbered.end(),
                                   Splitter(static_cast<unsigned>(leaf)));
    tree_->build();
    seconds_ = now() - start;
    bytes_ = heap_bytes() - heap_before;
  }
  std::string library() const override { return "CGAL"; }
  std::string configuration() const override {
    return "leaf " + std::to_string(leaf_) + (Cached::value ? ", cached points" : "");
  }
  double build_seconds() const override { return seconds_; }
  double bytes_per_point() const override { return bytes_ / static_cast<double>(points_); }
  // The library has no search for the k nearest within a radius: the k nearest are cut at it.
  void search(const std::vector<UVec3>& queries, size_t begin, size_t end, int64_t r2_max,
              Found& found) const override {
    for (size_t i = begin; i < end; ++i) {
      const Kernel::Point_3 query(static_cast<float>(queries[i][0]),
                                  static_cast<float>(queries[i][1]),
                                  static_cast<float>(queries[i][2]));
      Search search(*tree_, query, found.k, 0, true, Distance(), false);
      uint32_t n = 0;
      float largest = 0;
      for (const auto& [point, d2] : search) {
        if (r2_max >= 0 && d2 > static_cast<float>(r2_max)) continue;
        found.index[i * found.k + n] = boost::get<1>(point);
        found.d2[i * found.k + n] = d2;
        largest = std::max(largest, d2);
        ++n;
      }
      found.count[i] = n;
      found.r2[i] = n == found.k ? static_cast<double>(largest) : static_cast<double>(r2_max);
    }
  }

 private:
  size_t points_;
  int leaf_;
  std::unique_ptr<Tree> tree_;
  double seconds_, bytes_;
};

}  // namespace

void add_cgal(const std::vector<UVec3>& points, Contenders& to) {
  for (int leaf : {8, 16, 32}) {
    to.push_back(std::make_unique<Cgal<CGAL::Tag_false>>(points, leaf));
    to.push_back(std::make_unique<Cgal<CGAL::Tag_true>>(points, leaf));
  }
}

}  // namespace photonloom::bench
