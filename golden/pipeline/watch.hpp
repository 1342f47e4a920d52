// SPDX-License-Identifier: Apache-2.0
// Looks at every packet of a frame's units in stream order: how many there are, the widest value of
// each field, and the first few whole.
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "golden/pipeline/frame.hpp"

namespace photonloom {

class PacketWatch {
 public:
  // Keeps the first `kept` packets of each stream.
  PacketWatch(const Plan& plan, size_t kept);
  ~PacketWatch();

  // The same units, watched. The watch must outlive them.
  FrameUnits wrap(FrameUnits units);

  // {"streams": [{unit, stream, count, fields: [{name, elements, bits, used, most, unit, meaning}],
  // rows}]}: `used` bits hold `most`, the largest value of any element; a row is a packet's
  // elements, field by field. Streams are named as PacketRecorder's files. Values over 53 bits are
  // decimal strings, as in traces.
  std::string json() const;

  class Stream;

 private:
  Plan plan_;
  size_t kept_;
  std::vector<std::shared_ptr<Stream>> streams_;
};

}  // namespace photonloom
