// SPDX-License-Identifier: Apache-2.0
// What a test that injects faults saw of them: a line of JSON for `make faults`.
#pragma once
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

namespace photonloom::test {

struct FaultRow {
  std::string fault, where;
  uint64_t injected = 0;
  uint64_t detected = 0;  // told by a refusal, a flag or a frame that is sent again
  uint64_t harmless = 0;  // without effect on what was asked
  uint64_t wrong = 0;     // results that differ from golden's
  std::string recovery;   // time until all is right again, with its unit
};

// Adds it to the file PHOTONLOOM_FAULTS of the environment; without that, nothing.
inline void report(const FaultRow& row) {
  const char* path = std::getenv("PHOTONLOOM_FAULTS");
  if (!path) return;
  std::ofstream(path, std::ios::app)
      << nlohmann::json{{"fault", row.fault},       {"where", row.where},
                        {"injected", row.injected}, {"detected", row.detected},
                        {"harmless", row.harmless}, {"wrong", row.wrong},
                        {"recovery", row.recovery}}
             .dump()
      << '\n';
}

}  // namespace photonloom::test
