// SPDX-License-Identifier: Apache-2.0
// Other ways to lay a photon map out in memory, as far as bytes go: what a gather reads of each,
// and that it finds the same photons. docs/reordering.md defines them.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "golden/unit/photon_gatherer.hpp"
#include "study/cache_model.hpp"

namespace photonloom {

// The photons of a map in another structure. A gather's photons are named by their index in the
// map.
class PhotonLayout {
 public:
  virtual ~PhotonLayout() = default;
  virtual int line_bytes() const = 0;
  virtual uint64_t map_bytes() const = 0;
  // The lines that the query reads, appended in their order; `found` becomes its result.
  virtual void gather(const GatherQuery& query, std::vector<Neighbour>& found,
                      std::vector<uint32_t>& lines) const = 0;
};

// The complete tree over lines of the plan's bucket, inner nodes elsewhere: `photon_bytes` a
// photon.
std::unique_ptr<PhotonLayout> make_plain_lines(const Plan& plan, const PhotonMap& map,
                                               int photon_bytes);
// The same with compressed lines of `line_bytes`; a leaf that does not fit takes further ones.
std::unique_ptr<PhotonLayout> make_compressed_lines(const Plan& plan, const PhotonMap& map,
                                                    int line_bytes);
// A left-balanced kd-tree of one photon a node, in heap order, as many whole nodes in a line of 128
// bytes as fit: a photon's bits and two for the axis.
std::unique_ptr<PhotonLayout> make_textbook_tree(const Plan& plan, const PhotonMap& map);
// Cells as wide as the largest radius, hashed into a table of as many entries as there are photons:
// the photons of an entry follow each other, without padding, behind a table of 32-bit beginnings.
// The map must have a radius.
std::unique_ptr<PhotonLayout> make_hash_grid(const Plan& plan, const PhotonMap& map);

}  // namespace photonloom
