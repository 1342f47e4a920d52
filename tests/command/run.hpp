// SPDX-License-Identifier: Apache-2.0
// Runs the built photonloom as a user would, for tests of the command line.
#pragma once
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "golden/numeric/output_file.hpp"

namespace photonloom::test {

// The source tree; set by ctest, a test started by hand needs PHOTONLOOM and PHOTONLOOM_SOURCE.
inline std::string environment(const char* name) {
  const char* value = std::getenv(name);
  if (!value || !*value)
    throw std::runtime_error(std::string(name) + " is not set; run this test through ctest");
  return value;
}
inline std::string source(const std::string& path) {
  return environment("PHOTONLOOM_SOURCE") + "/" + path;
}

// A folder of the test's own, removed at its end.
struct Scratch {
  std::filesystem::path path;
  Scratch() {
    // A new name each time: a folder that a killed test left may have this process's number.
    std::string name = (std::filesystem::temp_directory_path() / "photonloom-test-XXXXXX").string();
    if (!mkdtemp(name.data()))
      throw std::runtime_error(name + ": cannot be made: " + std::strerror(errno));
    path = name;
  }
  ~Scratch() { std::filesystem::remove_all(path); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string operator/(const std::string& name) const { return (path / name).string(); }
  size_t entries() const {
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(path), {}));
  }
};

struct Outcome {
  int status;  // exit status; 128 + signal when killed
  std::string out, err;
  // One clear error: a line on stderr that begins with the program's name, nothing more.
  bool one_error_line() const {
    return err.rfind("photonloom: ", 0) == 0 && err.find('\n') == err.size() - 1;
  }
};

// `arguments` as in a shell.
inline Outcome run(const std::string& arguments) {
  const Scratch scratch;
  const std::string command = "'" + environment("PHOTONLOOM") + "' " + arguments + " >'" +
                              scratch / "out" + "' 2>'" + scratch / "err" + "' </dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          read_file(scratch / "out"), read_file(scratch / "err")};
}

}  // namespace photonloom::test
