// SPDX-License-Identifier: Apache-2.0
// photonloom.lock, by which a hardware package can be held against another, or against the program
// that made it, without making it again.
#pragma once
#include <map>
#include <string>

#include "golden/plan/plan.hpp"

namespace photonloom {

// A JSON object: `photonloom`, the program's version; `plan`, the plan's hash; `tools`, the oldest
// version of each, by its command: of those that simulate and synthesize any package, and of those
// under [tools] in the board.toml of `board` ("" for none); `sources`, the SHA-256 of each of
// `files` (path -> text) in rtl/ and board/. Nothing in it depends on the machine or the day.
std::string write_lock(const Plan& plan, const std::string& board, const std::string& boards_dir,
                       const std::map<std::string, std::string>& files);

}  // namespace photonloom
