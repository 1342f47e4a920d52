// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/model/tools.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/random.hpp"

namespace photonloom::model_tools {

std::string replace_all(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

std::string quoted(const std::string& text) { return "'" + replace_all(text, "'", "'\\''") + "'"; }

std::string shell_word(const std::string& text) {
  const bool plain = !text.empty() && text.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-+=:,./@%") == std::string::npos;
  return plain ? text : quoted(text);
}

// Output of a shell command; empty where it fails.
std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(("( " + command + " ) 2>/dev/null").c_str(), "r");
  if (!pipe) return text;
  std::array<char, 4096> buffer;
  for (size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    text.append(buffer.data(), n);
  if (pclose(pipe) != 0) text.clear();
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

int run_shell(const std::string& command) {
  const char* const words[] = {"sh", "-c", command.c_str(), nullptr};
  pid_t shell = 0;
  if (const int error = posix_spawn(&shell, "/bin/sh", nullptr, nullptr,
                                    const_cast<char* const*>(words), environ))
    throw std::runtime_error(fmt::format("/bin/sh: cannot be run: {}", std::strerror(error)));
  int status = 0;
  while (waitpid(shell, &status, 0) < 0 && errno == EINTR) {
  }
  const bool interrupted =
      WIFSIGNALED(status) ? WTERMSIG(status) == SIGINT : WEXITSTATUS(status) == 128 + SIGINT;
  if (interrupted) {
    raise(SIGINT);
    sleep(10);  // who handles it ends the program, after what was half-written is gone
  }
  return status;
}

void run_tool(const std::string& command, const std::string& log, const std::string& what) {
  if (run_shell(fmt::format("( {} ) >{} 2>&1", command, quoted(log))) == 0) return;
  std::istringstream in(read_file(log));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  // From the first line that speaks of an error, which warnings may stand before; Verilator stops
  // for its warnings too.
  const auto speaks = [](const std::string& line) {
    return line.find("rror") != std::string::npos || line.find("ERROR") != std::string::npos ||
           line.starts_with("%Warning");
  };
  size_t first = 0;
  while (first < lines.size() && !speaks(lines[first])) ++first;
  if (first == lines.size()) first = 0;
  std::string said;
  for (size_t i = first; i < std::min(lines.size(), first + 12); ++i) said += "\n  " + lines[i];
  throw std::runtime_error(fmt::format("{} failed:{}", what, said));
}

const Compiler& compiler() {
  static const Compiler found = [] {
    Compiler c;
    const char* cxx = std::getenv("CXX");
    c.command = cxx && *cxx ? cxx : "c++";
    c.version = output_of(c.command + " --version | head -n 1");
    if (c.version.empty()) throw std::runtime_error(c.command + ": no C++ compiler found; set CXX");
    if (!output_of("command -v ccache").empty()) c.command = "ccache " + c.command;
    return c;
  }();
  return found;
}

uint64_t text_hash(const std::string& text, uint64_t h) {
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return mix64(h ^ text.size());
}

Lock::Lock(const std::string& path)
    : descriptor_(open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {
  if (descriptor_ < 0 || flock(descriptor_, LOCK_EX) != 0)
    throw std::runtime_error(fmt::format("{}: cannot be locked: {}", path, strerror(errno)));
}

Lock::~Lock() { close(descriptor_); }

}  // namespace photonloom::model_tools
