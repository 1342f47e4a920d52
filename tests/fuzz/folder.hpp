// SPDX-License-Identifier: Apache-2.0
// A folder for the files of a fuzz target, in memory where the system has such a place; removed at
// exit.
#pragma once
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace photonloom::fuzz {

struct Folder {
  std::filesystem::path path;
  Folder() {
    const std::filesystem::path shared = "/dev/shm";
    path =
        (std::filesystem::is_directory(shared) ? shared : std::filesystem::temp_directory_path()) /
        ("photonloom_fuzz_" + std::to_string(getpid()));
    std::filesystem::create_directories(path);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return (path / name).string();
  }
};

}  // namespace photonloom::fuzz
