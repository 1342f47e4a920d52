// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/model/hls.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "hls_kernels/generate/header.hpp"
#include "verilator_tb/model/model.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom {

namespace {

namespace fs = std::filesystem;

// -fno-gnu-unique and hidden names: what is static in one plan's kernel is not that of another's.
// An index outside an array ends the run with a sentence that names the kernel's file, line and
// array: hardware would drop or wrap it, and here it would reach what lies next to the array. clang
// links its runtime into programs only.
const std::string& flags() {
  static const std::string text =
      std::string(
          "-std=c++17 -O2 -fPIC -shared -fvisibility=hidden -DPHOTONLOOM_HLS_NATIVE -Wall -Wextra "
          "-Werror") +
      (model_tools::compiler().version.find("clang") == std::string::npos
           ? " -fno-gnu-unique -fsanitize=bounds -fno-sanitize-recover=bounds"
           : "");
  return text;
}

// Path of the unit's shared object for this plan, compiled where it is not there.
std::string find_or_build(const Plan& plan, const std::string& unit, const std::string& work_dir) {
  using namespace model_tools;
  const std::string dir = default_hls_dir();
  const std::vector<std::string> files = hls_files(dir, {"native/" + unit + ".cpp"});
  const std::string header = write_hls_header(plan, 0);  // plans that differ elsewhere share it
  uint64_t key = text_hash(compiler().version + flags() + header, 1);
  for (const std::string& file : files) key = text_hash(read_file(dir + "/" + file), key);

  std::error_code ignored;
  fs::create_directories(work_dir, ignored);
  if (!fs::is_directory(work_dir))
    throw std::runtime_error(work_dir + ": cannot be made, needed for models");
  const std::string base =
      fmt::format("{}/{}-hls-{:016x}", fs::canonical(work_dir).string(), unit, key);
  const std::string library = base + "/model.so";
  if (fs::exists(library)) return library;
  const Lock lock(base + ".lock");
  if (fs::exists(library)) return library;

  OutputFolder folder(base);
  const std::string& to = folder.temporary();
  write_file(to + "/photonloom_hls.hpp", header);
  for (const std::string& file : files) {
    const fs::path path = to + "/hls_kernels/" + file;
    fs::create_directories(path.parent_path());
    write_file(path.string(), read_file(dir + "/" + file));
  }
  run_tool(fmt::format("cd {0} && {1} {2} -I. hls_kernels/{3} -o model.so", quoted(to),
                       compiler().command, flags(), files[0]),
           to + "/compile.log", fmt::format("compiling the HLS kernel {}", unit));
  folder.commit();
  return library;
}

}  // namespace

std::string build_kernel(const Plan& plan, const std::string& unit, const std::string& work_dir) {
  try {
    return find_or_build(plan, unit, work_dir);
  } catch (const std::exception& error) {
    throw ModelBuildError(error.what());
  }
}

}  // namespace photonloom
