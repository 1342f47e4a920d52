// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: a study file of arbitrary bytes is a study or one StudyError; with '=' in front
// a list of numbers, as --only has it.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "study/study_file.hpp"

using namespace photonloom;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    if (!text.empty() && text[0] == '=') {
      const auto numbers = parse_numbers(text.substr(1), "--only");
      for (size_t i = 1; i < numbers.size(); ++i)
        if (numbers[i - 1] >= numbers[i]) std::abort();
      return 0;
    }
    const Study study = parse_study(text, "study.toml",
                                    {{"visible", {"relmse", "flip", "bias"}},
                                     {"formats", {"relmse", "bias"}},
                                     {"caching", {"relmse"}},
                                     {"noise", {"relmse", "rays"}},
                                     {"gather", {"cycles", "bytes"}},
                                     {"bounds", {"recall"}},
                                     {"area", {"lut_equivalents"}},
                                     {"routed", {"fmax"}}});
    if (study.width < 1 || study.height < 1 || study.scenes.empty()) std::abort();
  } catch (const StudyError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
  return 0;
}
