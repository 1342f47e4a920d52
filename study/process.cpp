// SPDX-License-Identifier: Apache-2.0
#include "study/process.hpp"

#include <sys/wait.h>

#include <cstdio>
#include <stdexcept>

namespace photonloom {

std::pair<int, std::string> output_of(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (!pipe) throw std::runtime_error("no process can be started");
  std::string text;
  char buffer[4096];
  while (const size_t n = fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, n);
  const int status = pclose(pipe);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128, text};
}

}  // namespace photonloom
