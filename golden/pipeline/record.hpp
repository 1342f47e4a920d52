// SPDX-License-Identifier: Apache-2.0
// Writes every packet that goes into or comes out of a frame's units, a JSON line each, in stream
// order.
#pragma once
#include <memory>
#include <string>

#include "golden/pipeline/frame.hpp"

namespace photonloom {

// Files: gather_query, gather_result, gather_photon (photon_gatherer), reorder_in, reorder_out
// (reorder_buffer), sampler_input, sample (cdf_sampler), each .jsonl. They stand in `folder` whole
// after close(); without it nothing is left.
class PacketRecorder {
 public:
  PacketRecorder(const Plan& plan, const std::string& folder);
  ~PacketRecorder();

  // The same units, recorded. The recorder must outlive them.
  FrameUnits wrap(FrameUnits units);
  void close();

  struct Files;

 private:
  std::unique_ptr<Files> files_;
};

}  // namespace photonloom
