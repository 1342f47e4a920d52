// SPDX-License-Identifier: Apache-2.0
// A sweep's folder: results, each a file that is there whole or not at all, and the lock.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "study/measures.hpp"

namespace photonloom {

// Of what a result is.
struct ResultKey {
  std::string scene, plan;  // hashes, 16 hexadecimal digits each
  uint64_t seed = 0;
  auto operator<=>(const ResultKey&) const = default;
};

struct Result {
  ResultKey key;
  std::string failure;  // why measures are missing; empty: none failed
  struct Taken {
    std::string settings;
    Measurement figures;
  };
  std::map<std::string, Taken> measures;
  double seconds = 0;  // of this machine; no part of any compared table
};

// 16 hexadecimal digits that nearly always differ where the text does.
std::string checksum(std::string_view text);
// A line with the checksum of what stands before it.
std::string check_line(std::string_view before);

// The file's text and back. Reading throws std::runtime_error saying what is wrong: cut short, a
// checksum that does not fit, another format.
std::string result_text(const Result& result);
Result parse_result(const std::string& text);

// By which a sweep's folder is known.
inline constexpr const char* kPointsFile = "points.json";

// Throws std::runtime_error unless a sweep may write into the folder: there is none, it is empty,
// or it is a sweep's.
void check_sweep_folder(const std::string& folder);

class ResultStore {
 public:
  // Makes it. Throws std::runtime_error for a folder of other files.
  explicit ResultStore(std::string folder);

  const std::string& folder() const { return folder_; }
  std::string path(const ResultKey& key) const;
  // Nothing where there is none. Throws std::runtime_error, naming the file, for a damaged one.
  std::optional<Result> find(const ResultKey& key) const;
  void put(const Result& result) const;
  // Removes what killed sweeps left half-written, and no file that is not theirs. Only under the
  // lock, with no other process at work in the folder.
  void remove_unfinished() const;

 private:
  std::string folder_;
};

// Held as long as this lives, and no longer than the process does.
class FolderLock {
 public:
  // Throws std::runtime_error where another process holds it; with `wait` waits.
  FolderLock(const std::string& folder, bool wait);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace photonloom
