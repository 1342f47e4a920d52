// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: a plan file of arbitrary bytes is a plan that reads back with its hash, or one
// PlanError. '=' in front: lines of the default plan, as --set has them.
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "golden/plan/plan_file.hpp"

using namespace photonloom;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    Plan plan;
    if (!text.empty() && text[0] == '=') {
      std::istringstream lines(text.substr(1));
      for (std::string line; std::getline(lines, line);) set_plan_line(plan, line);
      derive_plan(plan);
    } else {
      plan = parse_plan(text, "plan.toml");
    }
    if (find_problem(plan)) return 0;  // of single lines
    const Plan again = parse_plan(plan_text(plan), "again.toml");
    if (plan_hash(again) != plan_hash(plan)) std::abort();
  } catch (const PlanError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
  return 0;
}
