// SPDX-License-Identifier: Apache-2.0
#include "study/routed.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/plan/units.hpp"
#include "study/process.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom {
namespace {

const char* const kFlow = PHOTONLOOM_SOURCE_DIR "/scripts/fpga";
const char* const kReports = PHOTONLOOM_SOURCE_DIR "/build/fpga";
constexpr const char* kBoard = "ulx3s-85f";

}  // namespace

std::string routing_missing() {
  const auto [status, said] =
      output_of(fmt::format("{} --tools --board {}", model_tools::quoted(kFlow), kBoard));
  return status == 0 ? ""
                     : "measure routed needs the tools of the open FPGA flow: " +
                           said.substr(said.rfind('\n') + 1);
}

RoutedResources routed_gatherer(const Plan& plan, const std::string& folder) {
  const std::string unit = unit_name<PhotonGatherer>, hash = plan_hash_text(plan),
                    file = folder + "/" + hash + ".toml",
                    report = fmt::format("{}/{}-{}/report.json", kReports, kBoard, hash);
  std::filesystem::create_directories(folder);
  write_plan(plan, file, {});
  // Exit status 1 says that a clock was missed, which is a figure here, or that the flow failed:
  // then what stands in the report is of an earlier run.
  std::error_code none;
  const auto before = std::filesystem::last_write_time(report, none);
  const auto [status, said] =
      output_of(fmt::format("{} {} --board {} --units {} --seeds 1", model_tools::quoted(kFlow),
                            model_tools::quoted(file), kBoard, unit));
  try {
    if (status > 1 || (status == 1 && std::filesystem::last_write_time(report, none) == before))
      throw std::runtime_error(said);
    const auto json = nlohmann::json::parse(read_file(report));
    for (const auto& entry : json.at("entries")) {
      if (entry.at("name") != unit || !entry.contains("fmax_mhz")) continue;
      const auto& r = entry.at("resources");
      return {r.at("LUT-eq"), r.at("FF"), r.at("MULT18X18D"), r.at("DP16KD"),
              entry.at("fmax_mhz").at("median")};
    }
    throw std::runtime_error("the report has no placement");
  } catch (const std::exception& error) {
    throw std::runtime_error(
        fmt::format("plan {}: {}: {}", hash, error.what(), said.substr(said.rfind('\n') + 1)));
  }
}

}  // namespace photonloom
