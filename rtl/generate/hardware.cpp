// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/hardware.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/sha256.hpp"
#include "golden/plan/units.hpp"
#include "rtl/generate/board.hpp"
#include "rtl/generate/chip.hpp"
#include "rtl/generate/fill.hpp"
#include "rtl/generate/lock.hpp"
#include "rtl/generate/package.hpp"
#include "rtl/generate/readme.hpp"
#include "rtl/generate/sources.hpp"

namespace photonloom {

namespace fs = std::filesystem;

namespace {

// Modules that stand in branches which this plan does not take.
std::set<std::string> modules_not_taken(const Plan& plan) {
  std::set<std::string> without;
  if (plan.reorder_key != ReorderKey::kHilbert) without.insert("hilbert_index");
  if (plan.reorder_key == ReorderKey::kNone || plan.reorder_drain != ReorderDrain::kSweep)
    without.insert("reorder_sweep");
  if (plan.reorder_key == ReorderKey::kNone || plan.reorder_drain != ReorderDrain::kFullest)
    without.insert("reorder_fullest");
  if (plan.reorder_key == ReorderKey::kNone) without.insert("reorder_key");
  if (plan.reciprocal_bits == 0) without.insert("reciprocal");
  if (!plan.parity) without.insert("parity_check");
  if (!plan.self_test) without.insert("self_test");
  without.insert(plan.photon_memory == PhotonMemory::kSdram ? "photon_ram" : "photon_sdram");
  return without;
}

}  // namespace

std::map<std::string, std::string> generate_hardware(const HardwareRequest& request) {
  const Plan& plan = request.plan;
  check_plan(plan);
  const std::string rtl = request.rtl_dir.empty() ? default_rtl_dir() : request.rtl_dir;
  std::vector<std::string> units = units_present(plan);
  if (units.empty())
    throw std::runtime_error(
        "the plan has neither a photon map nor final gather rays: there is no "
        "hardware to generate");
  if (!request.unit.empty()) {
    if (const std::string lacks = find_unit(request.unit).lacks(plan); !lacks.empty())
      throw std::runtime_error(
          fmt::format("the plan has no {}: it has no {}", request.unit, lacks));
    units = {request.unit};
  }
  const BoardRequest on_board{request.board, request.unit, request.clock_khz, request.boards_dir};
  if (!request.board.empty()) check_board(plan, on_board);
  const bool chip = request.unit.empty() && request.board.empty();
  const uint64_t hash = plan_hash(plan);

  std::map<std::string, std::string> files;
  std::vector<std::string> order = {"rtl/photonloom_pkg.sv"};
  files["rtl/photonloom_pkg.sv"] = write_package(plan, hash);
  const std::set<std::string> without = modules_not_taken(plan);
  // On a board the units stand in board_core; work of others stays with the host.
  const bool core = !request.board.empty() && request.unit.empty();
  if (core) units = units_on_board(plan);
  for (const std::string& unit : core ? std::vector<std::string>{"board_core"} : units)
    for (const std::string& file : module_files(rtl, unit, without)) {
      if (!files.emplace("rtl/" + file, read_file(rtl + "/" + file)).second) continue;
      order.push_back("rtl/" + file);
    }
  if (chip) {
    order.push_back(fmt::format("rtl/{}.sv", kChip));
    files[order.back()] = write_chip(plan, rtl);
  }
  std::string top = chip ? kChip : request.unit;
  BoardFiles board;
  if (!request.board.empty()) {
    board = board_files(plan, on_board, rtl, order);
    top = board.top;
    order.insert(order.end(), board.sources.begin(), board.sources.end());
    files.merge(board.files);
  }
  files["plan.toml"] = plan_text(plan, request.reasons);
  nlohmann::ordered_json asked{
      {"unit", request.unit}, {"board", request.board}, {"clock_khz", board.clock_khz}};
  for (const auto& [name, text] : request.images) {
    Sha256 sum;
    sum.add(text);
    asked["images"][name] = sum.hex();
    files[name] = text;
  }
  files["package.json"] = asked.dump(2) + "\n";

  std::string list, indented;
  for (const std::string& file : order) {
    list += file + "\n";
    indented += "      - " + file + "\n";
  }
  files["files.f"] = list;
  files["photonloom.core"] = fill_template(
      "photonloom.core", {{"TOP", top}, {"PLAN", plan_hash_text(plan)}, {"FILES", indented}});

  PackageReadme readme{.plan = plan, .top = top, .units = units};
  readme.ports =
      chip ? chip_ports(plan, rtl) : described_ports(rtl, core ? board.inner : request.unit);
  readme.whole_board = core;
  readme.ports_of = board.inner;
  readme.lint_options = board.lint;
  readme.board = board.readme;
  files["README.md"] = write_readme(readme);
  files["photonloom.lock"] = write_lock(plan, request.board, request.boards_dir, files);
  return files;
}

void check_hardware(const std::string& dir, const std::string& rtl_dir,
                    const std::string& boards_dir) {
  if (!fs::is_regular_file(dir + "/plan.toml"))
    throw std::runtime_error(dir + ": has no plan.toml, expected a generated hardware package");
  HardwareRequest request;
  request.plan = read_plan(dir + "/plan.toml");
  request.rtl_dir = rtl_dir;
  request.boards_dir = boards_dir;
  const std::string again = "; generate it again";
  const std::string package = dir + "/rtl/photonloom_pkg.sv";
  if (!fs::is_regular_file(package)) throw std::runtime_error(package + ": is missing" + again);
  const std::string expected = plan_hash_text(request.plan), text = read_file(package);
  const std::string key = "PlanHash = 64'h";
  const size_t at = text.find(key);
  const std::string found = at == std::string::npos ? "none" : text.substr(at + key.size(), 16);
  if (found != expected)
    throw std::runtime_error(
        fmt::format("{}: is stale, made from plan {}, but {}/plan.toml is plan "
                    "{}{}",
                    package, found, dir, expected, again));
  const std::string asked = dir + "/package.json";
  if (!fs::is_regular_file(asked)) throw std::runtime_error(asked + ": is missing" + again);
  std::map<std::string, std::string> images;  // path -> SHA-256
  try {
    const nlohmann::json j = nlohmann::json::parse(read_file(asked));
    request.unit = j.at("unit").get<std::string>();
    request.board = j.at("board").get<std::string>();
    request.clock_khz = j.at("clock_khz").get<int>();
    if (j.contains("images")) images = j.at("images").get<std::map<std::string, std::string>>();
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(
        fmt::format("{}: is damaged, expected unit, board, clock_khz and images{}", asked, again));
  }
  const std::vector<std::string> boards = board_names(boards_dir);
  if (!request.board.empty() && boards.empty()) read_board(request.board, boards_dir);
  if (!request.board.empty() &&
      std::find(boards.begin(), boards.end(), request.board) == boards.end()) {
    std::string known;
    for (const std::string& b : boards) known += (known.empty() ? "" : ", ") + b;
    throw std::runtime_error(
        fmt::format("{}: board is {}, expected one of {}{}", asked, request.board, known, again));
  }
  std::map<std::string, std::string> files = generate_hardware(request);
  files.erase("plan.toml");
  files.erase("package.json");
  const auto read = [&](const std::string& name) {
    const std::string path = dir + "/" + name;
    if (!fs::is_regular_file(path)) throw std::runtime_error(path + ": is missing" + again);
    return read_file(path);
  };
  const auto compare = [&](const std::string& name, const std::string& content) {
    if (read(name) != content)
      throw std::runtime_error(
          fmt::format("{}/{}: is stale, differs from what its plan and the RTL sources give{}", dir,
                      name, again));
  };
  const std::string lock = files.extract("photonloom.lock").mapped();
  for (const auto& [name, content] : files) compare(name, content);
  compare("photonloom.lock", lock);  // last: a source that differs is named itself
  for (const auto& [name, hash] : images) {
    Sha256 sum;
    sum.add(read(name));
    if (sum.hex() != hash)
      throw std::runtime_error(
          fmt::format("{}/{}: is not the image that was generated{}", dir, name, again));
  }
  for (const char* folder : {"rtl", "board", "images"}) {
    if (!fs::is_directory(dir + "/" + folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(dir + "/" + folder)) {
      const std::string name = fs::relative(entry.path(), dir).string();
      if (entry.is_regular_file() && !files.count(name) && !images.count(name))
        throw std::runtime_error(
            fmt::format("{}/{}: does not belong to the package{}", dir, name, again));
    }
  }
}

}  // namespace photonloom
