// SPDX-License-Identifier: Apache-2.0
// JSON as the commands print it.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace photonloom {

// Indented. A file's name may hold bytes that are no UTF-8; U+FFFD stands for each.
inline std::string json_text(const nlohmann::ordered_json& j) {
  return j.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace photonloom
