// SPDX-License-Identifier: Apache-2.0
// What every searcher of the benchmark offers.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "golden/numeric/vec.hpp"

namespace photonloom::bench {

// Where the k nearest points of each query are written: k places a query, `count` of them used.
struct Found {
  uint32_t k = 0;
  std::vector<uint32_t> index;
  std::vector<float> d2;  // libraries only
  std::vector<uint32_t> count;
  std::vector<double> r2;  // d^2 of the k-th where there are k, else r2_max
};

// One searcher in one configuration, built over its points. Searches are exact, but golden's where
// a leaf limit is asked for.
class Contender {
 public:
  virtual ~Contender() = default;
  virtual std::string library() const = 0;
  virtual std::string configuration() const = 0;
  virtual double build_seconds() const = 0;
  // Of everything a search reads, the points included.
  virtual double bytes_per_point() const = 0;
  // The number that the point of an index had among the points given: libraries answer with it,
  // golden with the photon's address in the map.
  virtual uint32_t number(uint32_t index) const { return index; }
  // Answers queries [begin, end), one after the other, in one thread. r2_max < 0: no radius.
  // Threads may share golden, each with queries of its own.
  virtual void search(const std::vector<UVec3>& queries, size_t begin, size_t end, int64_t r2_max,
                      Found& found) const = 0;
};

using Contenders = std::vector<std::unique_ptr<Contender>>;

// How golden searches. bucket: photons of a leaf; leaf_limit: leaves that a query visits at most,
// 0: as many as an exact answer needs.
struct GoldenSearch {
  uint32_t bucket = 8, leaf_limit = 0;
};
std::unique_ptr<Contender> make_photonloom(const std::vector<UVec3>& points,
                                           const GoldenSearch& how = {});

// Each takes a configuration for each leaf size and result set of its library.
void add_nanoflann(const std::vector<UVec3>& points, Contenders& to);
void add_flann(const std::vector<UVec3>& points, Contenders& to);
void add_cgal(const std::vector<UVec3>& points, Contenders& to);

// CPU seconds of this thread: what other programs do meanwhile does not count.
double now();

// Bytes that the heap holds now.
double heap_bytes();

}  // namespace photonloom::bench
