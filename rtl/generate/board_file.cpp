// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/board_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>
#include <set>
#include <stdexcept>
#include <string_view>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/plan.hpp"
#include "golden/plan/toml.hpp"
#include "rtl/generate/data_files.hpp"
#include "rtl/generate/sources.hpp"

namespace photonloom {
namespace {

namespace fs = std::filesystem;

constexpr int kMost = std::numeric_limits<int>::max();
constexpr int kLeastBaud = 300;
constexpr int kMostKHz = 1000000;  // of a board's clock

std::string joined(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& n : names) text += (text.empty() ? "" : ", ") + n;
  return text;
}

// A table of a file whose keys are all asked for: done() complains of the others.
class Table {
 public:
  Table(const toml::table& table, std::string file, std::string prefix)
      : table_(table), file_(std::move(file)), prefix_(std::move(prefix)) {}

  bool has(const std::string& key) {
    asked_.insert(key);
    return table_.contains(key);
  }
  std::string text(const std::string& key) {
    return value<std::string>(node(key, "text"), key, "text");
  }
  int number(const std::string& key, int least = 1, int most = kMost) {
    return checked(node(key, expected(least, most)), key, least, most);
  }
  IntRange range(const std::string& key, int most = kMost) {
    const std::vector<int> ends = numbers(key, 1, most);
    if (ends.size() != 2 || ends[0] > ends[1])
      fail(key, "is no range", "two numbers, [least, most]");
    return {ends[0], ends[1]};
  }
  std::vector<int> numbers(const std::string& key, int least = 1, int most = kMost) {
    std::vector<int> list;
    each(key, [&](const toml::node& n) { list.push_back(checked(n, key, least, most)); });
    return list;
  }
  std::vector<std::string> texts(const std::string& key) {
    std::vector<std::string> list;
    each(key, [&](const toml::node& n) { list.push_back(value<std::string>(n, key, "text")); });
    return list;
  }
  Table table(const std::string& key) {
    const toml::node& n = node(key, "a table");
    if (!n.is_table()) fail(key, "is no table", fmt::format("[{}{}]", prefix_, key));
    return {*n.as_table(), file_, prefix_ + key + "."};
  }
  std::vector<std::string> keys() const {
    std::vector<std::string> names;
    for (const auto& [key, value] : table_) names.emplace_back(key.str());
    return names;
  }
  // A number or a text, as text.
  std::string word(const std::string& key) {
    const toml::node& n = node(key, "text or a number");
    return n.is_integer() ? fmt::format("{}", *n.value<int64_t>())
                          : value<std::string>(n, key, "text or a number");
  }
  void done() const {
    for (const auto& [key, value] : table_)
      if (!asked_.count(std::string(key.str())))
        throw std::runtime_error(
            fmt::format("{}, line {}: the key {}{} is unknown, expected one of {}", file_,
                        key.source().begin.line, prefix_, key.str(), joined(asked_)));
  }
  [[noreturn]] void fail(const std::string& key, const std::string& what,
                         const std::string& expected) const {
    throw std::runtime_error(
        fmt::format("{}: {}{} {}, expected {}", file_, prefix_, key, what, expected));
  }

 private:
  static std::string expected(int least, int most) {
    return most == kMost ? fmt::format("a number from {}", least)
                         : fmt::format("a number from {} to {}", least, most);
  }
  const toml::node& node(const std::string& key, const std::string& expected) {
    if (!has(key)) fail(key, "is missing", expected);
    return *table_.get(key);
  }
  template <class T>
  T value(const toml::node& n, const std::string& key, const std::string& expected) const {
    const auto found = n.value_exact<T>();
    if (!found) fail(key, "is of another kind", expected);
    return *found;
  }
  int checked(const toml::node& n, const std::string& key, int least, int most) const {
    const auto found = value<int64_t>(n, key, expected(least, most));
    if (found < least || found > most)
      fail(key, fmt::format("is {}", found), expected(least, most));
    return static_cast<int>(found);
  }
  template <class F>
  void each(const std::string& key, F&& take) {
    const toml::node& n = node(key, "a list");
    if (!n.is_array() || n.as_array()->empty())
      fail(key, "is no list", "[...] with something in it");
    for (const toml::node& one : *n.as_array()) take(one);
  }

  const toml::table& table_;
  std::string file_, prefix_;
  std::set<std::string> asked_;
};

PllLimits read_pll(Table t) {
  PllLimits pll;
  const std::string from = t.text("feedback_from");
  if (from != "output" && from != "vco") t.fail("feedback_from", "is " + from, "output or vco");
  pll.fed_back_from_output = from == "output";
  pll.reference = t.range("reference", 1024);
  pll.feedback = t.range("feedback", 1024);
  pll.output = t.range("output", 1024);
  if (t.has("detector_least_khz")) pll.detector_least_khz = t.number("detector_least_khz");
  pll.vco_khz = t.range("vco_khz");
  pll.vco_best_khz = t.number("vco_best_khz");
  pll.output_khz = t.has("output_khz") ? t.range("output_khz") : IntRange{1, kMost};
  t.done();
  return pll;
}

BoardSdram read_sdram(Table t) {
  BoardSdram sdram;
  t.text("chip");
  sdram.clock_khz = t.number("clock_khz", kSdramLeastKHz);
  for (const char* time : {"row_to_column_ns", "precharge_ns", "row_active_ns", "row_to_row_ns",
                           "write_recovery_ns", "refresh_ns"})
    sdram.times_ns[time] = t.number(time);
  t.done();
  return sdram;
}

void read_flow(Table t, BoardDescription& board) {
  board.flow = t.text("name");
  const std::string flows = data_dir() + "/fpga/flows";
  std::set<std::string> known;
  for (const auto& entry : fs::directory_iterator(flows))
    known.insert(entry.path().filename().string());
  if (!known.count(board.flow)) t.fail("name", "is " + board.flow, "one of " + joined(known));
  for (const std::string& key : t.keys()) {
    if (key == "name") continue;
    std::string place;
    for (const char c : key)
      place += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const std::string word = t.word(key);
    // It becomes part of a command in a Makefile or a script.
    if (!std::all_of(word.begin(), word.end(), [](unsigned char c) {
          return std::isalnum(c) ||
                 std::string_view(" -_.,+=:/").find(static_cast<char>(c)) != std::string_view::npos;
        }))
      t.fail(key, "is " + word, "letters, digits, blanks and - _ . , + = : / alone");
    board.flow_places[place] = word;
  }
}

// Whether a path stays in the folder that it is relative to.
bool inside(const fs::path& path) {
  return path.is_relative() && std::find(path.begin(), path.end(), "..") == path.end();
}

void read_tops(Table t, BoardDescription& board) {
  for (const char* name : {"block_ram", "sdram", "unit"}) {
    if (!t.has(name)) continue;
    Table one = t.table(name);
    BoardTop& top = board.tops[name];
    std::vector<std::string> files;
    if (name != std::string("unit")) files.push_back(top.file = one.text("file"));
    top.constraints = one.texts("constraints");
    files.insert(files.end(), top.constraints.begin(), top.constraints.end());
    one.done();
    for (const std::string& file : files)
      if (!inside(file) || !fs::is_regular_file(board.folder + "/" + file))
        t.fail(name, "names " + file, "a file of " + board.folder);
  }
  t.done();
  if (board.tops.empty()) t.fail("unit", "is missing", "one of block_ram, sdram, unit at least");
}

// Reserved in IEEE 1800-2017.
constexpr std::string_view kReserved =
    " accept_on alias always always_comb always_ff always_latch and assert assign assume"
    " automatic before begin bind bins binsof bit break buf bufif0 bufif1 byte case casex"
    " casez cell chandle checker class clocking cmos config const constraint context continue"
    " cover covergroup coverpoint cross deassign default defparam design disable dist do edge"
    " else end endcase endchecker endclass endclocking endconfig endfunction endgenerate"
    " endgroup endinterface endmodule endpackage endprimitive endprogram endproperty"
    " endsequence endspecify endtable endtask enum event eventually expect export extends"
    " extern final first_match for force foreach forever fork forkjoin function generate"
    " genvar global highz0 highz1 if iff ifnone ignore_bins illegal_bins implements implies"
    " import incdir include initial inout input inside instance int integer interconnect"
    " interface intersect join join_any join_none large let liblist library local localparam"
    " logic longint macromodule matches medium modport module nand negedge nettype new"
    " nexttime nmos nor noshowcancelled not notif0 notif1 null or output package packed"
    " parameter pmos posedge primitive priority program property protected pull0 pull1"
    " pulldown pullup pulsestyle_ondetect pulsestyle_onevent pure rand randc randcase"
    " randsequence rcmos real realtime ref reg reject_on release repeat restrict return rnmos"
    " rpmos rtran rtranif0 rtranif1 s_always s_eventually s_nexttime s_until s_until_with"
    " scalared sequence shortint shortreal showcancelled signed small soft solve specify"
    " specparam static string strong strong0 strong1 struct super supply0 supply1"
    " sync_accept_on sync_reject_on table tagged task this throughout time timeprecision"
    " timeunit tran tranif0 tranif1 tri tri0 tri1 triand trior trireg type typedef union"
    " unique unique0 unsigned until until_with untyped use uwire var vectored virtual void"
    " wait wait_order wand weak weak0 weak1 while wildcard wire with within wor xnor xor ";

// A simple identifier of SystemVerilog.
bool is_identifier(const std::string& name) {
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) || c == '_'; };
  return !name.empty() && is_letter(static_cast<unsigned char>(name[0])) &&
         std::all_of(name.begin(), name.end(),
                     [&](unsigned char c) { return is_letter(c) || std::isdigit(c); }) &&
         kReserved.find(" " + name + " ") == std::string_view::npos;
}

}  // namespace

std::vector<std::string> board_names(const std::string& boards_dir) {
  const std::string dir = boards_dir.empty() ? default_boards_dir() : boards_dir;
  std::vector<std::string> names;
  if (!fs::is_directory(dir)) return names;
  for (const auto& entry : fs::directory_iterator(dir))
    if (fs::is_regular_file(entry.path() / "board.toml"))
      names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

BoardDescription read_board(const std::string& name, const std::string& boards_dir) {
  const std::string dir = boards_dir.empty() ? default_boards_dir() : boards_dir;
  const std::vector<std::string> names = board_names(dir);
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw std::runtime_error(
        names.empty()
            ? fmt::format("there is no board {}: {} has no folder with a board.toml", name, dir)
            : fmt::format("there is no board {}, expected one of {}", name,
                          joined({names.begin(), names.end()})));
  BoardDescription board;
  board.name = board.prefix = name;
  std::replace(board.prefix.begin(), board.prefix.end(), '-', '_');
  if (!is_identifier(board.prefix + "_top"))
    throw std::runtime_error(fmt::format(
        "{}/{}: the folder's name begins the names of modules, expected a letter, then letters, "
        "digits, - and _",
        dir, name));
  board.folder = dir + "/" + name;
  board.file = board.folder + "/board.toml";
  toml::table parsed;
  try {
    parsed = parse_toml(read_file(board.file), board.file);
  } catch (const toml::parse_error& error) {
    throw std::runtime_error(fmt::format("{}, line {}: not TOML: {}", board.file,
                                         error.source().begin.line,
                                         std::string(error.description())));
  }
  Table t(parsed, board.file, "");
  board.tested = t.text("tested");
  read_tops(t.table("top"), board);

  Table part = t.table("part");
  board.part = part.text("name");
  part.text("family");
  if (part.has("resources")) {
    Table resources = part.table("resources");
    for (const std::string& key : resources.keys()) board.resources[key] = resources.number(key);
  }
  part.done();

  Table clock = t.table("clock");
  board.clock_port = clock.text("port");
  if (!is_identifier(board.clock_port))
    clock.fail("port", fmt::format("is '{}'", board.clock_port),
               "the name of a port: a letter or _, then letters, digits and _, no word of "
               "SystemVerilog");
  board.oscillator_khz = clock.number("khz", 1, kMostKHz);
  board.unit_khz = clock.number("unit_khz", 1, kMostKHz);
  if (board.has_core()) board.core_khz = clock.number("core_khz", 1, kMostKHz);
  clock.done();

  if (board.has_core()) {
    board.leds = t.text("leds");
    board.pll = read_pll(t.table("pll"));
    Table serial = t.table("serial");
    board.serial_port = serial.text("port");
    board.baud = serial.numbers("baud", kLeastBaud);
    std::sort(board.baud.rbegin(), board.baud.rend());
    serial.done();
  }
  if (board.tops.count("sdram")) board.sdram = read_sdram(t.table("sdram"));
  read_flow(t.table("flow"), board);
  if (t.has("tools")) {
    Table tools = t.table("tools");
    for (const std::string& tool : tools.keys()) board.tools[tool] = tools.text(tool);
  }
  if (t.has("measure")) {  // of the flow's Python alone
    Table measure = t.table("measure");
    if (measure.has("plan")) measure.text("plan");
    if (measure.has("units")) measure.texts("units");
    measure.done();
  }
  t.done();
  return board;
}

}  // namespace photonloom
