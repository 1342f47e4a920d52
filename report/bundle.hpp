// SPDX-License-Identifier: Apache-2.0
// The page's front end as it was bundled from report/page (docs/report.md).
#pragma once
#include <string_view>

namespace photonloom {

extern const std::string_view kPageScript;
extern const std::string_view kPageStyle;

}  // namespace photonloom
