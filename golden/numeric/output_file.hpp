// SPDX-License-Identifier: Apache-2.0
// Files and folders that appear whole or not at all: written beside their target under another name
// and renamed by commit(). What is not committed is removed by the destructor, or by
// remove_unfinished_outputs() when the program is interrupted.
#pragma once
#include <string>
#include <string_view>

namespace photonloom {

// All members throw std::runtime_error naming the target and the system's reason. A target that
// exists and is not a regular file (/dev/stdout, a pipe) is written directly.
class OutputFile {
 public:
  explicit OutputFile(std::string path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);
  void commit();
  const std::string& path() const { return path_; }

 private:
  void flush();
  [[noreturn]] void fail(const char* what) const;

  std::string path_;
  std::string shown_;      // path_ as the user knows it, also inside of an unfinished folder
  std::string temporary_;  // empty when written directly
  std::string buffer_;
  int descriptor_ = -1;
};

// A folder filled at temporary() and put in the place of `path` by commit(). A folder that was
// there before is replaced if it is empty or holds the file `mark`, by which an older one of the
// same kind is known (none: whatever it holds). Anything else is an error, and so is a folder in
// which the program runs.
class OutputFolder {
 public:
  explicit OutputFolder(std::string path, const std::string& mark = "");
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::string& temporary() const { return temporary_; }
  void commit();

 private:
  std::string path_, temporary_;
};

void write_file(const std::string& path, std::string_view bytes);

// The bytes of a regular file or pipe; throws std::runtime_error naming it.
std::string read_file(const std::string& path);

// Removes everything begun and not committed; afterwards no further output can be begun or
// committed. For the interrupt handling of the program, from any thread.
void remove_unfinished_outputs();

}  // namespace photonloom
