// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/data_files.hpp"

#include <fmt/core.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

namespace photonloom {

namespace fs = std::filesystem;

namespace {

// Volatile, so that the path stands in the program as it is, however short: tests/install puts
// another one in its place.
const char* const volatile kSources = PHOTONLOOM_SOURCE_DIR;

struct Place {
  std::string dir;
  bool installed;
};

// Both folders are known by their RTL.
bool holds_data(const fs::path& dir) {
  std::error_code ignored;
  return fs::is_directory(dir / "rtl", ignored);
}

const Place& place() {
  static const Place found = [] {
    std::error_code ignored;
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    const fs::path share =
        (program.parent_path() / PHOTONLOOM_SHARE_FROM_PROGRAM).lexically_normal();
    if (!program.empty() && holds_data(share)) return Place{share.string(), true};
    const fs::path sources = kSources;
    if (holds_data(sources)) return Place{sources.string(), false};
    throw std::runtime_error(fmt::format(
        "the program's data files are not there: expected the folder rtl in {} (installed) or in "
        "{} (the source tree)",
        share.string(), sources.string()));
  }();
  return found;
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

}  // namespace

std::string data_dir() { return place().dir; }

bool is_installed() { return place().installed; }

std::string default_work_dir() {
  if (!is_installed()) return "build/cosim";
  const std::string cache = variable("XDG_CACHE_HOME"), home = variable("HOME");
  if (fs::path(cache).is_absolute()) return cache + "/photonloom";
  if (!home.empty()) return home + "/.cache/photonloom";
  return "photonloom-models";
}

std::string default_results_dir() { return is_installed() ? "cosim" : default_work_dir(); }

}  // namespace photonloom
