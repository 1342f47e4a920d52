// SPDX-License-Identifier: Apache-2.0
#include "study/store.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;

uint64_t fnv1a(std::string_view bytes) {
  uint64_t h = 0xcbf29ce484222325ull;
  for (const char c : bytes) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return h;
}

Json numbers(const std::vector<double>& values) {
  Json array = Json::array();
  for (const double v : values) array.push_back(std::isfinite(v) ? Json(v) : Json());
  return array;
}

std::vector<double> numbers_of(const Json& array) {
  std::vector<double> values;
  for (const Json& v : array)
    values.push_back(v.is_null() ? std::numeric_limits<double>::quiet_NaN() : v.get<double>());
  return values;
}

bool is_hex(const std::string& text, size_t digits) {
  return text.size() == digits && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

// SCENE-PLAN-SEED.json below PP.
bool is_result_name(const std::string& name, const std::string& folder) {
  return name.size() > 39 && is_hex(name.substr(0, 16), 16) && name[16] == '-' &&
         is_hex(name.substr(17, 16), 16) && name[33] == '-' && name.substr(17, 2) == folder &&
         name.ends_with(".json") &&
         name.find_first_not_of("0123456789", 34) == name.size() - std::strlen(".json");
}

// Of a plan in plans/.
bool is_plan_name(const std::string& name) {
  return name.ends_with(".toml") && is_hex(name.substr(0, name.size() - 5), 16);
}

// Without what follows the name of a file that is being written.
std::string final_name(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  return name.substr(0, name.find(".partial-"));
}

template <class Holds>
bool all_entries(const std::filesystem::path& folder, const Holds& holds) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) return false;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (!holds(entry.path())) return false;
  return !error;
}

// PP of results/.
bool is_results_part(const std::filesystem::path& folder) {
  const std::string part = folder.filename().string();
  return is_hex(part, 2) && all_entries(folder, [&](const std::filesystem::path& file) {
           return is_result_name(final_name(file), part);
         });
}

bool has_a_result(const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& part : std::filesystem::directory_iterator(folder / "results", error))
    for (const auto& file : std::filesystem::directory_iterator(part.path(), error))
      if (is_result_name(file.path().filename().string(), part.path().filename().string()))
        return true;
  return false;
}

// As point_table_text() writes it, also where it is cut short.
bool is_point_table(const std::filesystem::path& file) {
  const std::string text = read_file(file.string());
  const bool begins = text.starts_with("{\n \"study\": \"");
  if (begins && text.find("\n \"source\": \"") != std::string::npos) return true;
  const Json j = Json::parse(text, nullptr, false);
  if (j.is_discarded()) return begins;
  return j.is_object() && j.contains("study") && j.contains("source") && j.contains("points");
}

// Of a process, as FolderLock writes it.
bool is_lock(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::is_regular_file(file, error) &&
         std::filesystem::file_size(file, error) < 32 &&
         read_file(file.string()).find_first_not_of("0123456789\n") == std::string::npos;
}

// Whether a sweep may have left this in its folder; a name alone says so of no folder.
bool is_sweeps(const std::filesystem::path& path) {
  const auto entries_end = [&](const char* ending) {
    return all_entries(path, [&](const auto& file) { return final_name(file).ends_with(ending); });
  };
  const std::string name = final_name(path);
  if (name == "results") return all_entries(path, is_results_part);
  if (name == "plans")
    return all_entries(
        path, [](const std::filesystem::path& file) { return is_plan_name(final_name(file)); });
  if (name == "references") return entries_end(".exr");
  if (name == "lock") return is_lock(path);
  // Others have tables of these names too, but beside no lock.
  const bool is_table = name == kPointsFile || name == "results.sqlite" || name == "results.csv" ||
                        name == "summary.json" || name == "host.csv";
  std::error_code error;
  return is_table && std::filesystem::is_regular_file(path, error) &&
         (path.filename() != name || std::filesystem::is_empty(path, error) ||
          (name != kPointsFile && is_lock(path.parent_path() / "lock")));
}

// Whether a killed sweep left this half-written: a name of its own where it writes such files, and
// behind it what OutputFile or the database adds meanwhile. Users have files of like names.
bool is_unfinished(const std::filesystem::path& file, const std::string& sweep_folder) {
  static const std::regex mark(R"(\.partial-(\d+-\d+|sqlite))");
  const std::string name = final_name(file);
  std::error_code error;
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file, error)) ||
      !std::regex_match(file.filename().string().substr(name.size()), mark))
    return false;
  if (file.parent_path() == sweep_folder) return is_sweeps(file);
  const std::string folder = file.parent_path().filename().string();
  if (folder == "plans") return is_plan_name(name);
  if (folder == "references") return name.ends_with(".exr");
  if (folder == "search") return name == "question.json" || name == "answer.json";
  if (folder == "slurm") return name == "points" || name == "job.sh";
  return is_result_name(name, folder);
}

bool is_sweep_folder(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::path points = folder / kPointsFile;
  if (std::filesystem::is_regular_file(points, error) && is_point_table(points)) return true;
  // Its points were lost, or it was stopped before they were written, or is a plan search's, which
  // has no list of them.
  return has_a_result(folder) || all_entries(folder, is_sweeps);
}

}  // namespace

std::string checksum(std::string_view text) { return fmt::format("{:016x}", fnv1a(text)); }

std::string check_line(std::string_view before) {
  return fmt::format("check {}\n", checksum(before));
}

std::string result_text(const Result& r) {
  Json j;
  j["scene"] = r.key.scene;
  j["plan"] = r.key.plan;
  j["seed"] = r.key.seed;
  if (!r.failure.empty()) j["failure"] = r.failure;
  j["seconds"] = r.seconds;
  j["measures"] = Json::object();
  for (const auto& [name, taken] : r.measures) {
    Json& m = j["measures"][name];
    m["settings"] = taken.settings;
    m["values"] = numbers(taken.figures.values);
    for (const auto& [column, blocks] : taken.figures.blocks) m["blocks"][column] = numbers(blocks);
  }
  const std::string body = j.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  return body + check_line(body);
}

Result parse_result(const std::string& text) {
  const size_t line = text.find('\n');
  if (line == std::string::npos) throw std::runtime_error("is cut short");
  const std::string body = text.substr(0, line + 1);
  if (text.substr(line + 1) != check_line(body))
    throw std::runtime_error("is damaged: its checksum does not fit");
  try {
    const Json j = Json::parse(body);
    Result r;
    r.key = {j.at("scene"), j.at("plan"), j.at("seed")};
    r.failure = j.value("failure", "");
    r.seconds = j.at("seconds");
    for (const auto& [name, m] : j.at("measures").items()) {
      Result::Taken& taken = r.measures[name];
      taken.settings = m.at("settings");
      taken.figures.values = numbers_of(m.at("values"));
      if (m.contains("blocks"))
        for (const auto& [column, blocks] : m.at("blocks").items())
          taken.figures.blocks[column] = numbers_of(blocks);
    }
    return r;
  } catch (const Json::exception& error) {
    throw std::runtime_error(fmt::format("is no result: {}", error.what()));
  }
}

void check_sweep_folder(const std::string& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) return;
  if (!std::filesystem::is_directory(folder, error))
    throw std::runtime_error(
        fmt::format("{}: is not a folder, expected a new one or a sweep's", folder));
  if (!is_sweep_folder(folder))
    throw std::runtime_error(
        fmt::format("{}: is no sweep's folder: it holds files but no {} of a sweep, expected a new "
                    "folder, an empty one, or a sweep's to go on with",
                    folder, kPointsFile));
}

ResultStore::ResultStore(std::string folder) : folder_(std::move(folder)) {
  check_sweep_folder(folder_);
  std::error_code error;
  std::filesystem::create_directories(folder_ + "/results", error);
  if (error)
    throw std::runtime_error(
        fmt::format("{}: cannot be made a sweep's folder: {}", folder_, error.message()));
}

std::string ResultStore::path(const ResultKey& key) const {
  return fmt::format("{}/results/{}/{}-{}-{}.json", folder_, key.plan.substr(0, 2), key.scene,
                     key.plan, key.seed);
}

std::optional<Result> ResultStore::find(const ResultKey& key) const {
  const std::string file = path(key);
  if (!std::filesystem::exists(file)) return {};
  try {
    Result r = parse_result(read_file(file));
    if (r.key != key) throw std::runtime_error("is another result than its name says");
    return r;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", file, error.what()));
  }
}

void ResultStore::put(const Result& result) const {
  const std::string file = path(result.key);
  std::error_code error;
  std::filesystem::create_directories(std::filesystem::path(file).parent_path(), error);
  if (error)
    throw std::runtime_error(fmt::format("{}: cannot be created: {}", file, error.message()));
  write_file(file, result_text(result));
}

void ResultStore::remove_unfinished() const {
  std::error_code ignored;
  std::vector<std::filesystem::path> folders = {folder_}, found;
  for (const char* name : {"plans", "references", "search", "slurm"})
    folders.push_back(std::filesystem::path(folder_) / name);
  for (const auto& part :
       std::filesystem::directory_iterator(std::filesystem::path(folder_) / "results", ignored))
    folders.push_back(part.path());
  for (const auto& folder : folders)
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
      if (is_unfinished(entry.path(), folder_)) found.push_back(entry.path());
  for (const auto& path : found) std::filesystem::remove(path, ignored);
}

FolderLock::FolderLock(const std::string& folder, bool wait) {
  const std::string path = folder + "/lock";
  descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0)
    throw std::runtime_error(fmt::format("{}: cannot be opened: {}", path, std::strerror(errno)));
  int locked;
  do {
    locked = flock(descriptor_, LOCK_EX | (wait ? 0 : LOCK_NB));
  } while (locked != 0 && errno == EINTR);
  if (locked != 0) {
    char holder[32] = {};
    const ssize_t n = read(descriptor_, holder, sizeof holder - 1);
    close(descriptor_);
    throw std::runtime_error(fmt::format(
        "{}: another sweep is at work in this folder{}; wait for it, with --wait, or take another "
        "folder",
        folder,
        n > 0 ? fmt::format(" (process {})", std::string(holder, strcspn(holder, "\n"))) : ""));
  }
  const std::string own = fmt::format("{}\n", getpid());
  // Only for the sentence above: a full disk does not matter here.
  if (ftruncate(descriptor_, 0) == 0 && pwrite(descriptor_, own.data(), own.size(), 0) < 0) return;
}

FolderLock::~FolderLock() { close(descriptor_); }

}  // namespace photonloom
