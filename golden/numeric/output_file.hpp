// SPDX-License-Identifier: Apache-2.0
// Files and folders that appear whole or not at all: written beside their target under another name
// and renamed by commit(). What is not committed is removed by the destructor, or by
// remove_unfinished_outputs() when the program is interrupted.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

// By what a folder is known that a command wrote before: a file, what its text holds, and all that
// may lie beside it, names or "*.ending".
struct OutputFolderKind {
  std::string mark, proof;
  std::vector<std::string> own;
};

// A folder filled at temporary() and put in the place of `path` by commit(). A folder that was
// there before is replaced if it is empty or of this kind and holds nothing else, then and at
// commit(), so that no file of a user is lost; without a kind, whatever it holds. Anything else is
// an error, and so is a folder in which the program runs. Where files of a user came meanwhile,
// both folders stay, and the error names them.
class OutputFolder {
 public:
  explicit OutputFolder(std::string path);
  OutputFolder(std::string path, const OutputFolderKind& kind);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::string& temporary() const { return temporary_; }
  void commit();

 private:
  std::string path_, temporary_;
  std::optional<OutputFolderKind> kind_;
};

// Whether a file stands in a folder, however their paths are spelt.
bool stands_in(const std::string& file, const std::string& folder);

// Throws where an output would replace the file that it is made of.
void refuse_to_replace_input(const std::string& output, const std::string& input);

// Before long work: throws where one of the outputs, which are files, would replace one of the
// inputs or cannot be written. Nothing is left of it. Empty names stand for what was not asked for.
void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

void write_file(const std::string& path, std::string_view bytes);

// The bytes of a regular file or pipe; throws std::runtime_error naming it.
std::string read_file(const std::string& path);

// Removes everything begun and not committed; afterwards no further output can be begun or
// committed. For the interrupt handling of the program, from any thread.
void remove_unfinished_outputs();

}  // namespace photonloom
