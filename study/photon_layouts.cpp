// SPDX-License-Identifier: Apache-2.0
#include "study/photon_layouts.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "golden/plan/plan_file.hpp"
#include "golden/unit/photon_lines.hpp"

#include "golden/numeric/octahedral.hpp"

namespace photonloom {
namespace {

constexpr int kLine = 128;

int photon_bytes_of(const Plan& plan) { return (plan.photon_bits() + 7) / 8; }

// The k nearest so far, as docs/photon_gatherer.md has them.
class Nearest {
 public:
  Nearest(const Plan& plan, const PhotonMap& map, const GatherQuery& query,
          std::vector<Neighbour>& found)
      : plan_(plan),
        map_(map),
        query_(query),
        r2_max_(plan.map(query.map != 0).r2_max),
        found_(found) {
    found_.clear();
  }
  uint64_t bound() const {
    return found_.size() == static_cast<size_t>(plan_.k) ? found_.back().d2 : r2_max_;
  }
  void look_at(uint32_t index) {
    const PackedPhoton& photon = map_.slots[index];
    uint64_t d2 = 0;
    for (size_t c = 0; c < 3; ++c) {
      const int64_t d = int64_t{photon.position[c]} - int64_t{query_.position[c]};
      d2 += static_cast<uint64_t>(d * d);
    }
    const Neighbour candidate{d2, index};
    const bool full = found_.size() == static_cast<size_t>(plan_.k);
    if (d2 > r2_max_ || (full && !(candidate < found_.back())) ||
        !faces(plan_, photon.direction, query_.normal))
      return;
    if (full) found_.pop_back();
    found_.insert(std::upper_bound(found_.begin(), found_.end(), candidate), candidate);
  }

 private:
  const Plan& plan_;
  const PhotonMap& map_;
  const GatherQuery& query_;
  uint64_t r2_max_;
  std::vector<Neighbour>& found_;
};

class PlainLines : public PhotonLayout {
 public:
  PlainLines(const Plan& plan, const PhotonMap& map, int photon_bytes)
      : plan_(plan), map_(map), line_bytes_(plan.bucket * photon_bytes) {}
  int line_bytes() const override { return line_bytes_; }
  uint64_t map_bytes() const override {
    return uint64_t{map_.lines} * static_cast<uint64_t>(line_bytes_);
  }
  void gather(const GatherQuery& query, std::vector<Neighbour>& found,
              std::vector<uint32_t>& lines) const override {
    search_gather(plan_, map_, query, found, &lines);
  }

 private:
  const Plan plan_;
  const PhotonMap& map_;
  int line_bytes_;
};

// The plan with compressed lines of so many bytes and room for any number of further ones.
Plan with_compressed_lines(Plan plan, int line_bytes) {
  plan.photon_lines = PhotonLines::kCompressed;
  plan.photon_bytes = line_bytes / plan.bucket;
  plan.further_percent = 100 * (plan.bucket - 1);
  return plan;
}

class CompressedLines final : public PhotonLayout {
 public:
  CompressedLines(const Plan& plan, const PhotonMap& map, int line_bytes)
      : plan_(with_compressed_lines(plan, line_bytes)), decoded_(map), line_bytes_(line_bytes) {
    if (const auto problem = find_problem(plan_); problem && problem->line == "photon.photon_bytes")
      throw std::invalid_argument("compressed lines: photon_bytes " + problem->what);
    const std::vector<uint8_t> bytes = photon_lines(plan_, map, false);
    lines_ = bytes.size() / static_cast<size_t>(line_bytes);
    const auto bucket = static_cast<size_t>(plan.bucket);
    for (uint32_t leaf = 0; leaf < map.lines; ++leaf) {
      const StoredLeaf stored = read_leaf(plan_, bytes, leaf);
      std::copy(stored.slots.begin(), stored.slots.end(),
                decoded_.slots.begin() + static_cast<std::ptrdiff_t>(leaf * bucket));
    }
    further_ = further_lines(plan_, map, false);
  }
  int line_bytes() const override { return line_bytes_; }
  uint64_t map_bytes() const override { return lines_ * static_cast<uint64_t>(line_bytes_); }
  void gather(const GatherQuery& query, std::vector<Neighbour>& found,
              std::vector<uint32_t>& lines) const override {
    std::vector<uint32_t> leaves;
    search_gather(plan_, decoded_, query, found, &leaves);
    const std::vector<uint32_t> read = lines_of(further_, leaves);
    lines.insert(lines.end(), read.begin(), read.end());
  }

 private:
  const Plan plan_;
  PhotonMap decoded_;  // what the lines hold
  int line_bytes_;
  uint64_t lines_;
  FurtherLines further_;
};

class TextbookTree final : public PhotonLayout {
 public:
  TextbookTree(const Plan& plan, const PhotonMap& map)
      : plan_(plan),
        map_(map),
        in_line_(kLine / ((plan.photon_bits() + 2 + 7) / 8)),
        nodes_(map.count + 1),
        axis_(map.count + 1) {
    std::vector<uint32_t> photons(map.count);
    std::iota(photons.begin(), photons.end(), 0u);
    if (map.count > 0) balance(1, photons, 0, map.count);
  }
  int line_bytes() const override { return kLine; }
  uint64_t map_bytes() const override { return (uint64_t{line_of(map_.count)} + 1) * kLine; }
  void gather(const GatherQuery& query, std::vector<Neighbour>& found,
              std::vector<uint32_t>& lines) const override {
    Nearest nearest(plan_, map_, query, found);
    if (map_.count > 0) visit(1, {0, 0, 0}, query, nearest, lines);
  }

 private:
  uint32_t line_of(uint64_t node) const {
    return static_cast<uint32_t>(node / static_cast<uint64_t>(in_line_));
  }

  // Nodes of the left subtree of a complete tree with n nodes.
  static uint64_t left_nodes(uint64_t n) {
    const int depth = std::bit_width(n) - 1;  // of the last level
    const uint64_t above = (uint64_t{1} << depth) - 1, last = n - above;
    const uint64_t half = depth == 0 ? 0 : uint64_t{1} << (depth - 1);
    return (above - 1) / 2 + std::min(last, half);
  }

  void balance(uint64_t node, std::vector<uint32_t>& photons, uint64_t begin, uint64_t end) {
    UVec3 low = map_.slots[photons[begin]].position, high = low;
    for (uint64_t i = begin; i < end; ++i)
      for (size_t c = 0; c < 3; ++c) {
        low[c] = std::min(low[c], map_.slots[photons[i]].position[c]);
        high[c] = std::max(high[c], map_.slots[photons[i]].position[c]);
      }
    size_t axis = 0;
    for (size_t c = 1; c < 3; ++c)
      if (high[c] - low[c] > high[axis] - low[axis]) axis = c;
    const uint64_t middle = begin + (end - begin > 1 ? left_nodes(end - begin) : 0);
    const auto at = [&](uint64_t i) { return photons.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](uint32_t a, uint32_t b) {
      return std::make_pair(map_.slots[a].position[axis], a) <
             std::make_pair(map_.slots[b].position[axis], b);
    });
    nodes_[node] = photons[middle];
    axis_[node] = static_cast<uint8_t>(axis);
    if (middle > begin) balance(2 * node, photons, begin, middle);
    if (end > middle + 1) balance(2 * node + 1, photons, middle + 1, end);
  }

  void visit(uint64_t node, UVec3 offset, const GatherQuery& query, Nearest& nearest,
             std::vector<uint32_t>& lines) const {
    lines.push_back(line_of(node));
    const uint32_t photon = nodes_[node];
    if (2 * node <= map_.count) {
      const size_t axis = axis_[node];
      const int64_t away =
          int64_t{query.position[axis]} - int64_t{map_.slots[photon].position[axis]};
      const uint64_t near = 2 * node + (away >= 0 ? 1 : 0), far = near ^ 1;
      if (near <= map_.count) visit(near, offset, query, nearest, lines);
      offset[axis] = static_cast<uint32_t>(std::abs(away));
      uint64_t d2 = 0;
      for (const uint32_t o : offset) d2 += uint64_t{o} * o;
      if (far <= map_.count && d2 <= nearest.bound()) visit(far, offset, query, nearest, lines);
    }
    nearest.look_at(photon);
  }

  const Plan plan_;
  const PhotonMap& map_;
  int in_line_;
  std::vector<uint32_t> nodes_;  // index in the map
  std::vector<uint8_t> axis_;
};

class HashGrid final : public PhotonLayout {
 public:
  HashGrid(const Plan& plan, const PhotonMap& map)
      : plan_(plan), map_(map), photon_bytes_(static_cast<uint64_t>(photon_bytes_of(plan))) {
    const uint64_t r2 = plan.global.r2_max;
    if (r2 >= plan.r2_limit()) throw std::invalid_argument("a hash grid needs a radius");
    radius_ = static_cast<uint32_t>(std::sqrt(static_cast<double>(r2)));
    while (uint64_t{radius_} * radius_ < r2) ++radius_;
    radius_ = std::max(radius_, 1u);
    entries_ = std::bit_ceil(std::max<uint64_t>(1, map.count));
    begin_.assign(entries_ + 1, 0);
    for (uint64_t i = 0; i < map.count; ++i) ++begin_[entry_of(cell_of(i)) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    photons_.resize(map.count);
    std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (uint64_t i = 0; i < map.count; ++i)
      photons_[next[entry_of(cell_of(i))]++] = static_cast<uint32_t>(i);
    table_lines_ = static_cast<uint32_t>((4 * (entries_ + 1) + kLine - 1) / kLine);
  }
  int line_bytes() const override { return kLine; }
  uint64_t map_bytes() const override {
    return uint64_t{table_lines_} * kLine +
           (photon_bytes_ * map_.count + kLine - 1) / kLine * kLine;
  }
  void gather(const GatherQuery& query, std::vector<Neighbour>& found,
              std::vector<uint32_t>& lines) const override {
    Nearest nearest(plan_, map_, query, found);
    UVec3 low, high;
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t x = query.position[c];
      low[c] = (x < radius_ ? 0 : x - radius_) / radius_;
      high[c] = static_cast<uint32_t>((uint64_t{x} + radius_) / radius_);
    }
    std::vector<uint64_t> entries;  // two cells may share one
    for (uint32_t z = low[2]; z <= high[2]; ++z)
      for (uint32_t y = low[1]; y <= high[1]; ++y)
        for (uint32_t x = low[0]; x <= high[0]; ++x) {
          const uint64_t entry = entry_of({x, y, z});
          if (std::find(entries.begin(), entries.end(), entry) != entries.end()) continue;
          entries.push_back(entry);
          lines.push_back(static_cast<uint32_t>(4 * entry / kLine));
          if ((4 * entry + 4) / kLine != 4 * entry / kLine)
            lines.push_back(static_cast<uint32_t>((4 * entry + 4) / kLine));
          const uint64_t begin = begin_[entry], end = begin_[entry + 1];
          if (begin == end) continue;
          for (uint64_t line = photon_bytes_ * begin / kLine;
               line <= (photon_bytes_ * end - 1) / kLine; ++line)
            lines.push_back(table_lines_ + static_cast<uint32_t>(line));
          for (uint64_t i = begin; i < end; ++i) nearest.look_at(photons_[i]);
        }
  }

 private:
  UVec3 cell_of(uint64_t index) const {
    UVec3 cell = map_.slots[index].position;
    for (uint32_t& x : cell) x /= radius_;
    return cell;
  }
  // Teschner et al. 2003, "Optimized spatial hashing".
  uint64_t entry_of(const UVec3& cell) const {
    return ((cell[0] * 73856093u) ^ (cell[1] * 19349663u) ^ (cell[2] * 83492791u)) & (entries_ - 1);
  }

  const Plan plan_;
  const PhotonMap& map_;
  uint64_t photon_bytes_, entries_ = 1;
  uint32_t radius_ = 1, table_lines_ = 0;
  std::vector<uint32_t> begin_, photons_;
};

}  // namespace

std::unique_ptr<PhotonLayout> make_plain_lines(const Plan& plan, const PhotonMap& map,
                                               int photon_bytes) {
  return std::make_unique<PlainLines>(plan, map, photon_bytes);
}
std::unique_ptr<PhotonLayout> make_compressed_lines(const Plan& plan, const PhotonMap& map,
                                                    int line_bytes) {
  return std::make_unique<CompressedLines>(plan, map, line_bytes);
}
std::unique_ptr<PhotonLayout> make_textbook_tree(const Plan& plan, const PhotonMap& map) {
  return std::make_unique<TextbookTree>(plan, map);
}
std::unique_ptr<PhotonLayout> make_hash_grid(const Plan& plan, const PhotonMap& map) {
  return std::make_unique<HashGrid>(plan, map);
}

}  // namespace photonloom
