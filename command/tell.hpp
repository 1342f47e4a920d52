// SPDX-License-Identifier: Apache-2.0
// What standard error says beside a command's work.
#pragma once
#include <fmt/core.h>

#include <cstdio>
#include <string>
#include <utility>

namespace photonloom {

// Writes to standard error. Where that cannot be written, on a full disk or closed, the words are
// lost and nothing else is.
template <class... Args>
void tell(fmt::format_string<Args...> text, Args&&... args) {
  const std::string words = fmt::format(text, std::forward<Args>(args)...);
  std::fwrite(words.data(), 1, words.size(), stderr);
}

}  // namespace photonloom
