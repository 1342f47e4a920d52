// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/hardware.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/sha256.hpp"
#include "golden/packet/layout.hpp"
#include "golden/planner/resources.hpp"
#include "rtl/generate/board.hpp"
#include "rtl/generate/package.hpp"
#include "rtl/generate/sources.hpp"
#include "rtl/generate/tables.hpp"

namespace photonloom {

namespace fs = std::filesystem;

namespace {

constexpr const char* kChip = "photonloom_chip";
// The chip wires the one before the other.
const std::string kReorder = unit_name<ReorderBuffer>, kGatherer = unit_name<PhotonGatherer>;

bool has(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

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
  without.insert(plan.photon_memory == PhotonMemory::kSdram ? "photon_ram" : "photon_sdram");
  return without;
}

// Streams that the chip wires inside, by unit.
bool is_inner(const std::string& unit, const std::string& port, bool reordered) {
  const auto is_stream = [&](const std::string& stream, bool unit_gives) {
    const char* forward = unit_gives ? "_o" : "_i";
    const char* back = unit_gives ? "_i" : "_o";
    return port == stream + "_valid" + forward || port == stream + forward ||
           port == stream + "_ready" + back;
  };
  if (unit == kReorder) return is_stream("in", false) || is_stream("out", true);
  return unit == kGatherer && is_stream("in", false) && reordered;
}

// How a unit's port is called on the chip.
std::string chip_port(const std::string& unit, const std::string& port) {
  if (port == "clk_i" || port == "rst_i") return port;
  const std::string prefix = find_unit(unit).chip_prefix;
  if (!prefix.empty()) return prefix + port;
  if (unit == kGatherer && port.rfind("in_", 0) == 0) return "query_" + port.substr(3);
  if (port.rfind("count_", 0) == 0) return unit + "_" + port;
  return port;
}

struct ChipPort {
  bool output;
  std::string type, name, meaning, unit, port;
};

// What a port of a stream means is the same everywhere.
std::string meaning_of(const std::string& name, const std::string& type,
                       const std::string& meaning) {
  if (!meaning.empty()) return meaning;
  const auto ends = [&](const std::string& end) {
    return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
  };
  if (name == "clk_i") return "clock";
  if (name == "rst_i") return "reset, synchronous";
  if (ends("_valid_i") || ends("_valid_o")) return "offered";
  if (ends("_ready_i") || ends("_ready_o")) return "taken when offered";
  if (type.rfind("photonloom_pkg::", 0) == 0) return "the packet";
  static const std::map<std::string, std::string> kOfBoard = {
      {"uart_rx_i", "serial line from the host"},
      {"uart_tx_o", "serial line to the host"},
      {"clk_sdram_i", "clock of the SDRAM's pins"},
      {"sdram_cke_o", "clock enable"},
      {"sdram_cs_no", "chip select, active low"},
      {"sdram_ras_no", "row address strobe, active low"},
      {"sdram_cas_no", "column address strobe, active low"},
      {"sdram_we_no", "write enable, active low"},
      {"sdram_ba_o", "bank"},
      {"sdram_a_o", "row or column address"},
      {"sdram_dqm_o", "byte masks"},
      {"sdram_dq_i", "data from the chip"},
      {"sdram_dq_o", "data to the chip"},
      {"sdram_dq_oe_o", "data pins are driven"}};
  const auto of_board = kOfBoard.find(name);
  return of_board == kOfBoard.end() ? "" : of_board->second;
}

std::vector<ChipPort> chip_ports(const Plan& plan, const std::string& rtl_dir) {
  const std::vector<std::string> units = units_present(plan);
  const bool reordered = has(units, kReorder);
  std::vector<ChipPort> ports;
  for (const std::string& unit : units)
    for (const ModulePort& p : module_ports(rtl_dir, unit)) {
      if (is_inner(unit, p.name, reordered)) continue;
      const std::string name = chip_port(unit, p.name);
      if (std::any_of(ports.begin(), ports.end(),
                      [&](const ChipPort& q) { return q.name == name; }))
        continue;  // clock and reset
      ports.push_back({p.output, package_type(p.type, unit), name,
                       meaning_of(name, p.type, p.meaning), unit, p.name});
    }
  if (reordered) {
    const std::string query = "photonloom_pkg::gather_query_t";
    ports.insert(ports.begin() + 2, {{false, "logic", "query_valid_i", "queries, see docs", "", ""},
                                     {true, "logic", "query_ready_o", "", "", ""},
                                     {false, query, "query_i", "", "", ""}});
  }
  ports.push_back({true, "logic [63:0]", "plan_hash_o", "hash of the plan", "", ""});
  return ports;
}

std::string port_table(const std::vector<ChipPort>& ports) {
  std::string text = "| port | direction | type | meaning |\n|---|---|---|---|\n";
  for (const ChipPort& p : ports)
    text += fmt::format("| `{}` | {} | `{}` | {} |\n", p.name, p.output ? "out" : "in", p.type,
                        p.meaning);
  return text;
}

// Bits of memory and multipliers that follow from the plan, a row each.
std::string budget_table(const Plan& plan, const std::vector<std::string>& units) {
  std::string text = "| what | size |\n|---|---|\n";
  const auto row = [&](const std::string& what, const std::string& size) {
    text += fmt::format("| {} | {} |\n", what, size);
  };
  if (has(units, kGatherer)) {
    const uint64_t nodes = plan.lines(plan.global) + plan.lines(plan.caustic);
    const int line = plan.bucket * plan.photon_bytes;
    row("external line memory", fmt::format("{} lines of {} bytes = {} bytes", nodes, line,
                                            nodes * static_cast<uint64_t>(line)));
    row("node memory", fmt::format("{} x {} bits", nodes, plan.position_bits + 2));
    row("leaf cache", fmt::format("{} bytes, {} ways", plan.cache_bytes, plan.cache_ways));
    row("candidate lists", fmt::format("{} contexts x {} entries x {} bits of (d2, index)",
                                       plan.contexts, plan.k, plan.r2_bits() + plan.index_bits()));
    row("distance lanes",
        fmt::format("{} x 3 squares of {} bits", plan.lanes, plan.position_bits + 1));
    row("flux accumulators", fmt::format("{} channels x {} bits", plan.channels, plan.flux_bits()));
  }
  if (has(units, kReorder)) {
    row("reorder pool", fmt::format("{} packets x {} bits", plan.reorder_packets,
                                    PacketLayout::of<GatherQuery>(plan).bits()));
    row("reorder links and bins",
        fmt::format("{} links, {} heads and tails of {} bits", plan.reorder_packets,
                    plan.reorder_bins,
                    std::max(1, clog2(static_cast<uint64_t>(plan.reorder_packets)))));
  }
  if (has(units, unit_name<CdfSampler>))
    row("sampler tables",
        fmt::format("2 x {} cells x {} bits", 1 << plan.cell_index_bits(), plan.total_bits()));
  return text;
}

// What the units will take of an LFE5U, a row each.
std::string resource_table(const Plan& plan, const std::vector<std::string>& units, bool board) {
  std::string text =
      "| unit, on an LFE5U | LUT-equivalents | flip-flops | MULT18X18D | DP16KD |\n"
      "|---|---|---|---|---|\n";
  for (const std::string& unit : units) {
    if (!is_predicted(unit)) continue;
    const UnitResources r = estimate_resources(plan, unit);
    const bool several = board && unit == kGatherer && plan.gatherers > 1;
    text += fmt::format("| `{}`{} | {:.0f} | {:.0f} | {:.0f} | {:.0f} |\n", unit,
                        several ? fmt::format(", each of {}", plan.gatherers) : std::string(),
                        r.lut, r.ff, r.dsp, r.ebr);
  }
  if (board) {
    const BoardMemories b = board_memories(plan);
    const auto row = [&](const std::string& what, int blocks) {
      text += fmt::format("| {} | | | | {} |\n", what, blocks);
    };
    row(plan.photon_memory == PhotonMemory::kSdram ? "cache before the SDRAM" : "photon memory",
        b.photons);
    row("replayer, link", b.replayer + b.link);
    row("all of the top", b.total());
  }
  return text + "\nPredicted from the plan's lines; `make fpga` measures.\n";
}

}  // namespace

std::string write_chip(const Plan& plan, const std::string& rtl_dir) {
  const std::vector<std::string> units = units_present(plan);
  const bool reordered = has(units, kReorder);
  std::string text = fmt::format(
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Generated from plan {0}: its units, wired. Edit the plan, not this file.\n",
      plan_hash_text(plan));
  if (reordered)
    text +=
        "//\n// Queries of camera hits (tag = gather rays) go straight to the gatherer. From the "
        "first\n"
        "// other query up to and including the flush they pass the reorder buffer, and the next\n"
        "// query waits until the flush has left it: so the order at the gatherer follows from "
        "the\n"
        "// packets alone. Every flush is answered by a result with flush = 1.\n";
  const std::vector<ChipPort> ports = chip_ports(plan, rtl_dir);
  text += fmt::format("module {} (\n", kChip);
  for (size_t i = 0; i < ports.size(); ++i)
    text += fmt::format("    {} {} {}{}{}\n", ports[i].output ? "output" : "input ", ports[i].type,
                        ports[i].name, i + 1 < ports.size() ? "," : "",
                        ports[i].meaning.empty() ? "" : "  // " + ports[i].meaning);
  text += ");\n  assign plan_hash_o = photonloom_pkg::PlanHash;\n\n";
  if (reordered)
    text += fmt::format(
        R"(  // Whether a run of reordered queries is on its way, and whether its flush has gone in.
  logic run_q, flushed_q;
  logic direct, run_starts;
  logic reorder_in_valid, reorder_in_ready, reorder_out_valid, reorder_out_ready;
  logic gather_in_valid, gather_in_ready;
  photonloom_pkg::gather_query_t reorder_out, gather_in;
  assign direct = !run_q && query_i.tag == {0}'d{1} && !query_i.flush;
  assign run_starts = !run_q && query_valid_i && !direct;
  assign reorder_in_valid = query_valid_i && run_q && !flushed_q;
  assign query_ready_o = run_q ? reorder_in_ready && !flushed_q : direct && gather_in_ready;
  assign gather_in_valid = run_q ? reorder_out_valid : query_valid_i && direct;
  assign gather_in = run_q ? reorder_out : query_i;
  assign reorder_out_ready = run_q && gather_in_ready;
  always_ff @(posedge clk_i) begin
    if (run_starts) run_q <= 1'b1;
    if (reorder_in_valid && reorder_in_ready && query_i.flush) flushed_q <= 1'b1;
    if (reorder_out_valid && reorder_out_ready && reorder_out.flush) begin
      run_q <= 1'b0;
      flushed_q <= 1'b0;
    end
    if (rst_i) begin
      run_q <= 1'b0;
      flushed_q <= 1'b0;
    end
  end

)",
        plan.tag_bits(), plan.gather_rays);
  for (const std::string& unit : units) {
    text += fmt::format("  {0} {0} (\n", unit);
    const std::vector<ModulePort> list = module_ports(rtl_dir, unit);
    for (size_t i = 0; i < list.size(); ++i) {
      const std::string& p = list[i].name;
      std::string wire = chip_port(unit, p);
      if (is_inner(unit, p, reordered)) {
        const std::string prefix = unit == kGatherer ? "gather" : "reorder";
        if (unit == kReorder && p == "in_i")
          wire = "query_i";
        else
          wire = prefix + "_" + p.substr(0, p.size() - 2);
      }
      text += fmt::format("      .{}({}){}\n", p, wire, i + 1 < list.size() ? "," : "");
    }
    text += "  );\n\n";
  }
  text.pop_back();
  return text + "endmodule\n";
}

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
  const BoardRequest on_board{request.board, request.unit, request.clock_khz};
  if (!request.board.empty()) check_board(plan, on_board);
  const bool chip = request.unit.empty() && request.board.empty();
  const uint64_t hash = plan_hash(plan);

  std::map<std::string, std::string> files;
  std::vector<std::string> order = {"rtl/photonloom_pkg.sv"};
  files["rtl/photonloom_pkg.sv"] = write_package(plan, hash);
  const std::set<std::string> without = modules_not_taken(plan);
  // On a board the units stand in board_core; work of others stays with the host.
  const bool core = !request.board.empty() && request.unit.empty();
  if (core)
    std::erase_if(
        units, [](const std::string& unit) { return find_unit(unit).board == BoardPlace::kHost; });
  for (const std::string& unit : core ? std::vector<std::string>{"board_core"} : units)
    for (const std::string& file : module_files(rtl, unit, without)) {
      if (!files.emplace("rtl/" + file, read_file(rtl + "/" + file)).second) continue;
      order.push_back("rtl/" + file);
    }
  if (chip) {
    files["rtl/photonloom_chip.sv"] = write_chip(plan, rtl);
    order.push_back("rtl/photonloom_chip.sv");
  }
  std::string top = chip ? kChip : request.unit;
  BoardFiles board;
  if (!request.board.empty()) {
    board = board_files(plan, on_board, rtl, order);
    top = board.top;
    order.push_back("rtl/" + top + ".sv");
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

  std::string list, core_files;
  for (const std::string& file : order) {
    list += file + "\n";
    core_files += "      - " + file + "\n";
  }
  files["files.f"] = list;
  files["photonloom.core"] = fmt::format(
      "CAPI=2:\n"
      "# SPDX-License-Identifier: Apache-2.0\n"
      "name: photonloom:hw:{0}:0.1.0\n"
      "description: Photon-mapping hardware for plan {1}\n"
      "filesets:\n"
      "  rtl:\n"
      "    files:\n{2}"
      "    file_type: systemVerilogSource\n"
      "targets:\n"
      "  default: &default\n"
      "    filesets: [rtl]\n"
      "    toplevel: {0}\n"
      "  lint:\n"
      "    <<: *default\n"
      "    default_tool: verilator\n"
      "    tools:\n"
      "      verilator:\n"
      "        mode: lint-only\n"
      "        verilator_options: [-Wall]\n",
      top, plan_hash_text(plan), core_files);

  std::vector<ChipPort> ports;
  std::set<std::string> packets;
  if (chip)
    ports = chip_ports(plan, rtl);
  else {
    const std::string module = core ? board.inner : request.unit;
    for (const ModulePort& p : module_ports(rtl, module))
      ports.push_back({p.output, package_type(p.type, module), p.name,
                       meaning_of(p.name, p.type, p.meaning), module, p.name});
  }
  std::string packet_tables;
  for (const std::string& name : packet_names())
    for (const ChipPort& p : ports)
      if ((core || p.type == "photonloom_pkg::" + name + "_t") && packets.insert(name).second)
        packet_tables += packet_table(plan, name) + "\n";
  std::string constants = "| constant | value | meaning |\n|---|---|---|\n";
  for (const PackageConstant& c : package_constants(plan))
    constants += fmt::format("| `{}` | {} | {} |\n", c.name, c.value, c.meaning);
  std::string contents;
  for (const std::string& unit : units) contents += fmt::format(" `{}`", unit);
  const std::string lint =
      fmt::format("verilator --lint-only -Wall --top-module {}{} -f files.f", top,
                  files.count("board/primitives.sv") ? " board/primitives.sv" : "");
  const std::string synthesis =
      request.board.empty()
          ? fmt::format(
                "- Synthesize: `yosys -p \"read_verilog -sv $(tr '\\n' ' ' < files.f); "
                "synth_ecp5 -abc9 -top {}\"`.\n",
                top)
          : std::string();
  files["README.md"] = fmt::format(
      "# {0}\n\n"
      "Photon-mapping hardware for plan `{1}` (`plan.toml`), generated by `photonloom generate`. "
      "Units:{2}.\n\n"
      "- `files.f` lists the sources in order, relative to this folder; top module `{0}`.\n"
      "- `photonloom.core` is the same for FuseSoC.\n"
      "- Check that nothing here is stale: `photonloom generate --check DIR`.\n"
      "- Lint: `{7}`.\n"
      "{8}\n"
      "{9}"
      "Streams are valid/ready: valid never waits for ready, the packet holds until it is taken. "
      "Reset is synchronous, active high.\n\n"
      "## Ports{10}\n\n{3}\n## Packets\n\nThe first field is in the most significant bits, element "
      "0 "
      "of an array lowest.\n\n{4}## Budget\n\n{5}\n## Constants\n\nOf `photonloom_pkg`, beside "
      "`PlanHash` = `{1}`; modules take theirs as parameter defaults.\n\n{6}",
      top, plan_hash_text(plan), contents, port_table(ports), packet_tables,
      budget_table(plan, units) + "\n" + resource_table(plan, units, core), constants, lint,
      synthesis, board.readme,
      request.board.empty() ? std::string() : fmt::format(" of `{}`", board.inner));
  return files;
}

void check_hardware(const std::string& dir, const std::string& rtl_dir) {
  if (!fs::is_regular_file(dir + "/plan.toml"))
    throw std::runtime_error(dir + ": has no plan.toml, expected a generated hardware package");
  HardwareRequest request;
  request.plan = read_plan(dir + "/plan.toml");
  request.rtl_dir = rtl_dir;
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
  const std::vector<std::string> boards = board_names();
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
  for (const auto& [name, content] : files)
    if (read(name) != content)
      throw std::runtime_error(
          fmt::format("{}/{}: is stale, differs from what its plan and the RTL sources give{}", dir,
                      name, again));
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
