// SPDX-License-Identifier: Apache-2.0
#include "golden/numeric/output_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <new>
#include <stdexcept>
#include <utility>

namespace photonloom {
namespace {

std::mutex unfinished_mutex;
// What is being written, and under which name it will stand.
std::map<std::string, std::string>& unfinished() {
  static std::map<std::string, std::string> targets;
  return targets;
}

// Held for good once the program is being interrupted: whoever wants to begin or commit waits for
// the end of the program.
void forget(const std::string& path) {
  const std::lock_guard lock(unfinished_mutex);
  unfinished().erase(path);
}

std::string beside(const std::string& path) {
  static int number = 0;  // under unfinished_mutex
  return fmt::format("{}.partial-{}-{}", path, getpid(), number++);
}

// The name that a file of an unfinished folder will have; under unfinished_mutex.
std::string final_name(const std::string& path) {
  for (const auto& [temporary, target] : unfinished())
    if (path.starts_with(temporary + "/")) return target + path.substr(temporary.size());
  return path;
}

// The file a link points to: the link itself stays.
std::string resolved(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path target = std::filesystem::weakly_canonical(path, ignored);
  return std::filesystem::is_symlink(path, ignored) && !target.empty() ? target.string() : path;
}

bool is_of(const OutputFolderKind& kind, const std::string& name) {
  return name == kind.mark ||
         std::any_of(kind.own.begin(), kind.own.end(), [&](const std::string& own) {
           return own.starts_with("*") ? name.ends_with(own.substr(1)) : name == own;
         });
}

// What speaks against replacing a folder as one of this kind; empty: nothing.
std::string foreign(const std::string& path, const OutputFolderKind& kind) {
  std::error_code error;
  if (std::filesystem::is_empty(path, error)) return "";
  if (!std::filesystem::is_regular_file(path + "/" + kind.mark, error))
    return fmt::format("it holds files but no {}", kind.mark);
  if (read_file(path + "/" + kind.mark).find(kind.proof) == std::string::npos)
    return fmt::format("its {} is another one", kind.mark);
  std::vector<std::string> others;
  for (const auto& entry : std::filesystem::directory_iterator(path, error))
    if (const std::string name = entry.path().filename().string(); !is_of(kind, name))
      others.push_back(name);
  if (others.empty()) return "";
  return fmt::format("it also holds {}", *std::min_element(others.begin(), others.end()));
}

}  // namespace

void OutputFile::fail(const char* what) const {
  throw std::runtime_error(fmt::format("{}: {}: {}", shown_, what, std::strerror(errno)));
}

OutputFile::OutputFile(std::string path) : path_(std::move(path)), shown_(path_) {
  struct stat info {};
  if (path_.empty()) throw std::runtime_error("the name of an output file is empty");
  const bool exists = stat(path_.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode))
    throw std::runtime_error(path_ + ": cannot be written: it is a folder, expected a file name");
  if (exists && !S_ISREG(info.st_mode)) {
    descriptor_ = open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail("cannot be opened for writing");
    return;
  }
  if (exists && access(path_.c_str(), W_OK) != 0) fail("cannot be written");
  const std::lock_guard lock(unfinished_mutex);
  path_ = resolved(path_);
  shown_ = final_name(path_);
  const std::string temporary = beside(path_);
  descriptor_ = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail("cannot be created");
  temporary_ = temporary;
  unfinished().emplace(temporary_, path_);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!temporary_.empty()) {
    unlink(temporary_.c_str());
    forget(temporary_);
  }
}

void OutputFile::write(std::string_view bytes) {
  buffer_ += bytes;
  if (buffer_.size() >= (1u << 20)) flush();
}

void OutputFile::flush() {
  const char* next = buffer_.data();
  size_t left = buffer_.size();
  while (left > 0) {
    const ssize_t n = ::write(descriptor_, next, left);
    if (n < 0) {
      if (errno == EINTR) continue;
      fail("cannot be written");
    }
    next += n;
    left -= static_cast<size_t>(n);
  }
  buffer_.clear();
}

void OutputFile::commit() {
  flush();
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (close(descriptor) != 0) fail("cannot be written");
  if (temporary_.empty()) return;
  const std::lock_guard lock(unfinished_mutex);
  if (rename(temporary_.c_str(), path_.c_str()) != 0) fail("cannot be put in place");
  unfinished().erase(temporary_);
  temporary_.clear();
}

OutputFolder::OutputFolder(std::string path, const OutputFolderKind& kind)
    : OutputFolder([&] {
        std::error_code error;
        if (!path.empty() && std::filesystem::is_directory(path, error))
          if (const std::string why = foreign(path, kind); !why.empty())
            throw std::runtime_error(fmt::format(
                "{}: is not replaced: {}, expected a new folder, an empty one, or one that was "
                "written by the same command",
                path, why));
        return path;
      }()) {
  kind_ = kind;
}

OutputFolder::OutputFolder(std::string path) : path_(std::move(path)) {
  while (path_.size() > 1 && path_.back() == '/') path_.pop_back();
  if (path_.empty()) throw std::runtime_error("the name of an output folder is empty");
  std::error_code error;
  if (std::filesystem::exists(path_, error) && !std::filesystem::is_directory(path_, error))
    throw std::runtime_error(path_ + ": cannot be replaced: it is not a folder");
  if (std::filesystem::exists(path_, error)) {
    for (std::filesystem::path here = std::filesystem::current_path(error); !here.empty();
         here = here.parent_path()) {
      if (std::filesystem::equivalent(here, path_, error))
        throw std::runtime_error(path_ +
                                 ": cannot be replaced: the program runs in it, expected a folder "
                                 "beside or below");
      if (here == here.parent_path()) break;
    }
  }
  const std::lock_guard lock(unfinished_mutex);
  path_ = resolved(path_);
  const std::string temporary = beside(path_);
  std::filesystem::create_directories(temporary, error);
  if (error) throw std::runtime_error(path_ + ": cannot be created: " + error.message());
  temporary_ = temporary;
  unfinished().emplace(temporary_, path_);
}

OutputFolder::~OutputFolder() {
  if (temporary_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove_all(temporary_, ignored);
  forget(temporary_);
}

void OutputFolder::commit() {
  const std::lock_guard lock(unfinished_mutex);
  std::error_code error;
  const std::string old = beside(path_);
  const bool existed = std::filesystem::exists(path_);
  if (existed && kind_)
    if (const std::string why = foreign(path_, *kind_); !why.empty()) {
      const std::string kept = std::exchange(temporary_, "");
      unfinished().erase(kept);
      throw std::runtime_error(
          fmt::format("{}: is not replaced: {}, which has come meanwhile; what was to stand there "
                      "is in {}",
                      path_, why, kept));
    }
  if (existed) std::filesystem::rename(path_, old, error);
  if (!error) std::filesystem::rename(temporary_, path_, error);
  if (error) throw std::runtime_error(path_ + ": cannot be put in place: " + error.message());
  unfinished().erase(temporary_);
  temporary_.clear();
  if (existed) std::filesystem::remove_all(old, error);
}

bool stands_in(const std::string& file, const std::string& folder) {
  std::error_code error;
  const auto folder_of = [&](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error)
        .parent_path();
  };
  return folder_of(file) == folder_of(std::filesystem::path(folder) / "x");
}

void refuse_to_replace_input(const std::string& output, const std::string& input) {
  std::error_code error;
  if (std::filesystem::is_regular_file(output, error) &&
      std::filesystem::equivalent(output, input, error))
    throw std::runtime_error(output +
                             ": is the input, which would be lost; expected another file to write");
}

void check_outputs(const std::vector<std::string>& outputs,
                   const std::vector<std::string>& inputs) {
  for (const std::string& output : outputs) {
    if (output.empty()) continue;
    if (output == "-")
      throw std::runtime_error(
          "-: is not standard output here, expected a file; ./- is one of that name");
    for (const std::string& input : inputs) refuse_to_replace_input(output, input);
    // Who reads a pipe would take an end of the probe for the end of the output.
    std::error_code error;
    const auto type = std::filesystem::status(output, error).type();
    if (type != std::filesystem::file_type::fifo) const OutputFile probe(output);
  }
}

void write_file(const std::string& path, std::string_view bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

std::string read_file(const std::string& path) try {
  // Devices such as /dev/zero have no end.
  constexpr size_t kDeviceBytes = size_t{1} << 30;
  struct Open {
    int descriptor;
    ~Open() {
      if (descriptor >= 0) close(descriptor);
    }
  };
  const auto fail = [&path] {
    throw std::runtime_error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  };
  const Open file{open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.descriptor < 0) fail();
  std::string bytes;
  struct stat info {};
  if (fstat(file.descriptor, &info) == 0 && info.st_size > 0)
    bytes.reserve(static_cast<size_t>(info.st_size));
  char block[65536];
  for (;;) {
    const ssize_t n = read(file.descriptor, block, sizeof block);
    if (n == 0) return bytes;
    if (n < 0) {
      if (errno == EINTR) continue;
      fail();
    }
    bytes.append(block, static_cast<size_t>(n));
    if (S_ISCHR(info.st_mode) && bytes.size() > kDeviceBytes)
      throw std::runtime_error(fmt::format(
          "{}: is a device that gives more than {} bytes, expected a file", path, kDeviceBytes));
  }
} catch (const std::bad_alloc&) {
  throw std::runtime_error(path + ": is larger than the memory that there is");
}

void remove_unfinished_outputs() {
  unfinished_mutex.lock();  // never unlocked: the program ends now
  std::error_code ignored;
  for (const auto& [path, target] : unfinished()) std::filesystem::remove_all(path, ignored);
}

}  // namespace photonloom
