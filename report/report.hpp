// SPDX-License-Identifier: Apache-2.0
// The page of `photonloom report`: what cosim and sweep left in their folders, as one HTML file
// that needs nothing else. docs/report.md describes it.
#pragma once
#include <string>
#include <vector>

#include "golden/numeric/progress.hpp"

namespace photonloom {

// A further image of a run or of a study's scene.
struct ExtraImage {
  std::string scene;  // name of a run or scene
  std::string label, file;
};

struct ReportRequest {
  std::vector<std::string> folders;  // runs and studies
  std::vector<ExtraImage> images;
  std::string program;  // name and version
  Progress* progress = nullptr;
};

// The file's text; equal folders give equal bytes. Throws std::runtime_error that names the file
// and what was expected: a folder that is neither a run nor a study, a file that is missing or
// damaged, images of different sizes.
std::string report_page(const ReportRequest& request);

}  // namespace photonloom
