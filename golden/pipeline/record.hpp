// SPDX-License-Identifier: Apache-2.0
// Writes every packet that goes into or comes out of a frame's units, a JSON line each, in stream
// order.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "golden/pipeline/frame.hpp"

namespace photonloom {

// Files: those of each unit's kRecorded, each .jsonl. They stand in `folder` whole after close();
// without it nothing is left.
class PacketRecorder {
 public:
  PacketRecorder(const Plan& plan, const std::string& folder);
  ~PacketRecorder();

  // The same units, recorded. The recorder must outlive them.
  FrameUnits wrap(FrameUnits units);
  void close();

  // A trace being written, of packets of any type.
  class File;

 private:
  Plan plan_;
  std::string folder_;
  std::vector<std::shared_ptr<File>> files_;
};

}  // namespace photonloom
