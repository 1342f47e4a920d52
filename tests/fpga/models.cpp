// SPDX-License-Identifier: Apache-2.0
// The models of the ECP5's cells (fpga/models) against specifications of their own, written from
// the vendor's description (docs/data.md): a block RAM is 18,432 bits and two ports that name some
// of them; a multiplier is a product of integers. Nothing of the models is used here but their
// pins.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/random.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "verilator_tb/model/model.hpp"
#include "verilator_tb/rig/stall.hpp"

using namespace photonloom;

namespace {

// Verilog text as a netlist of the module `top`, loaded.
std::string build(const std::string& text, const std::string& top) {
  const test::Scratch scratch;
  const std::string file = scratch / (top + ".sv");
  write_file(file, text);
  ModelSource source;
  source.unit = top;
  source.rtl_dir = scratch.path.string();
  source.work_dir = "cosim";
  source.kind = ModelKind::kNetlist;
  source.netlist = file;
  return build_model(Plan{}, source);
}

void set(const Model& model, const std::string& port, uint64_t value) {
  std::memcpy(model.port(port).data, &value, std::min<size_t>(8, model.port(port).bytes));
}

uint64_t get(const Model& model, const std::string& port) {
  uint64_t value = 0;
  std::memcpy(&value, model.port(port).data, std::min<size_t>(8, model.port(port).bytes));
  return value;
}

// ".DIA0(di_a_i[0]), ..."
std::string pins(const std::string& pin, const std::string& net, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format(".{0}{1}({2}[{1}]), ", pin, i, net);
  return text;
}

// ---- block RAM ----

enum class WriteMode { kNormal, kWriteThrough, kReadBeforeWrite };
constexpr const char* kWriteModes[] = {"NORMAL", "WRITETHROUGH", "READBEFOREWRITE"};

struct RamPort {
  int width;
  WriteMode mode;
  bool output_register;
  uint32_t decode;
  bool inverted_clock;
};

struct RamCase {
  RamPort a, b;
  bool async_reset;
};

constexpr auto kN = WriteMode::kNormal;
constexpr auto kW = WriteMode::kWriteThrough;
constexpr auto kR = WriteMode::kReadBeforeWrite;
constexpr RamCase kRams[] = {
    {{1, kN, false, 0, false}, {1, kR, false, 0, false}, false},
    {{2, kW, false, 0, false}, {4, kN, true, 0, false}, false},
    {{4, kR, true, 0, false}, {2, kW, false, 0, false}, true},
    {{4, kR, false, 0, false}, {4, kR, false, 0, false}, true},
    {{9, kN, false, 5, false}, {9, kW, false, 0, false}, false},
    {{9, kR, false, 0, true}, {18, kN, false, 0, false}, false},
    {{18, kW, false, 0, false}, {18, kR, true, 3, false}, false},
    {{18, kN, true, 0, false}, {9, kN, false, 0, true}, true},
    {{18, kR, false, 6, false}, {1, kW, false, 0, false}, true},
    {{36, kN, false, 0, false}, {36, kN, false, 0, false}, false},
    {{36, kN, false, 0, false}, {36, kN, true, 0, false}, true},
    {{36, kN, false, 1, false}, {18, kN, false, 0, false}, false},
    {{36, kN, false, 0, false}, {9, kN, true, 0, false}, true},
    {{36, kN, false, 0, true}, {4, kN, false, 0, false}, false},
    {{36, kN, false, 0, false}, {1, kN, false, 0, false}, true},
};
constexpr int kInitials[] = {0x00, 0x1a, 0x3f};  // INITVALs that are not 0

std::string ram_text(RoleRandom& random, std::vector<std::vector<std::array<uint8_t, 320>>>& init) {
  std::string text = "module rams (\n";
  for (const char p : {'a', 'b'})
    text += fmt::format(
        "  input logic clk_{0}_i,\n  input logic ce_{0}_i,\n  input logic oce_{0}_i,\n"
        "  input logic we_{0}_i,\n  input logic rst_{0}_i,\n  input logic [2:0] cs_{0}_i,\n"
        "  input logic [13:0] ad_{0}_i,\n  input logic [17:0] di_{0}_i,\n",
        p);
  for (size_t i = 0; i < std::size(kRams); ++i)
    text += fmt::format("  output logic [17:0] do_a{0}_o,\n  output logic [17:0] do_b{0}_o{1}\n", i,
                        i + 1 < std::size(kRams) ? "," : "");
  text += ");\n";
  for (size_t i = 0; i < std::size(kRams); ++i) {
    const RamCase& c = kRams[i];
    text += fmt::format("  DP16KD #(.RESETMODE(\"{}\"),\n", c.async_reset ? "ASYNC" : "SYNC");
    for (const bool second : {false, true}) {
      const RamPort& p = second ? c.b : c.a;
      text += fmt::format(
          "    .DATA_WIDTH_{0}({1}), .WRITEMODE_{0}(\"{2}\"), .REGMODE_{0}(\"{3}\"), "
          ".CSDECODE_{0}(\"0b{4:03b}\"), .CLK{0}MUX(\"{5}\"),\n",
          second ? 'B' : 'A', p.width, kWriteModes[static_cast<int>(p.mode)],
          p.output_register ? "OUTREG" : "NOREG", p.decode,
          p.inverted_clock ? "INV"
          : second         ? "CLKB"
                           : "CLKA");
    }
    init.emplace_back();
    for (const int which : kInitials) {
      std::array<uint8_t, 320>& bits = init.back().emplace_back();
      std::string digits(320, '0');
      for (size_t b = 0; b < 320; ++b) {
        bits[b] = random.bits() & 1;
        digits[319 - b] = bits[b] ? '1' : '0';
      }
      text +=
          fmt::format("    .INITVAL_{:02X}(320'b{}){}\n", which, digits, which == 0x3f ? "" : ",");
    }
    text += fmt::format("  ) ram{} (\n    ", i);
    for (const bool second : {false, true}) {
      const char up = second ? 'B' : 'A', low = second ? 'b' : 'a';
      text += pins(fmt::format("DI{}", up), fmt::format("di_{}_i", low), 18);
      text += pins(fmt::format("AD{}", up), fmt::format("ad_{}_i", low), 14);
      text += pins(fmt::format("CS{}", up), fmt::format("cs_{}_i", low), 3);
      text += pins(fmt::format("DO{}", up), fmt::format("do_{}{}_o", low, i), 18);
      text += fmt::format(
          "\n    .CLK{0}(clk_{1}_i), .CE{0}(ce_{1}_i), .OCE{0}(oce_{1}_i), .WE{0}(we_{1}_i), "
          ".RST{0}(rst_{1}_i){2}\n    ",
          up, low, second ? ");" : ",");
    }
    text += "\n";
  }
  return text + "endmodule\n";
}

// Pins of one port, as they are set.
struct Pins {
  bool clock = false, ce = false, oce = false, we = false, rst = false;
  uint32_t cs = 0, address = 0, data = 0;
};

// The specification: bits, and what each port names of them.
class RamSpec {
 public:
  RamSpec(const RamCase& c, const std::vector<std::array<uint8_t, 320>>& init)
      : case_(c), bits_(18432, 0) {
    for (size_t n = 0; n < init.size(); ++n)
      for (size_t word = 0; word < 16; ++word)
        for (size_t bit = 0; bit < 18; ++bit)
          bits_[(static_cast<size_t>(kInitials[n]) * 16 + word) * 18 + bit] =
              init[n][20 * word + bit];
  }

  // The pins' levels, without an edge.
  void settle(const Pins& a, const Pins& b) {
    if (!case_.async_reset) return;
    if (a.rst) clear(0);
    if (b.rst) clear(1);
  }

  // The clocks of the ports in `edges` rise (or fall, where inverted).
  void clock(const Pins& a, const Pins& b, const std::array<bool, 2>& edges) {
    const std::array<const Pins*, 2> pins{&a, &b};
    std::array<std::vector<uint8_t>, 2> written{std::vector<uint8_t>(18432, 0), {}};
    written[1] = written[0];
    std::vector<uint8_t> after = bits_;
    std::array<bool, 2> writes{};
    for (const size_t p : {0u, 1u}) {
      // Set to write, whether its own edge comes now or not: a collision is of levels.
      writes[p] = active(p, *pins[p]) && pins[p]->we && !(wide() && p == 1) &&
                  !(pins[p]->rst && !case_.async_reset);
      if (!writes[p]) continue;
      const int width = port(p).width;
      const uint64_t data = wide() ? static_cast<uint64_t>(b.data) << 18 | a.data : pins[p]->data;
      for (int i = 0; i < width; ++i) {
        if (width >= 18 && !(pins[p]->address >> (i / 9) & 1)) continue;
        const size_t at = place(p, *pins[p], i);
        written[p][at] = 1;
        if (edges[p]) after[at] = data >> i & 1;
      }
    }
    for (const size_t p : {0u, 1u}) {
      if (!edges[p] || (wide() && p == 0)) continue;
      if (pins[p]->rst) {
        clear(p);
        continue;
      }
      if (port(p).output_register && pins[p]->oce) register_[p] = latch_[p];
      if (!active(p, *pins[p]) || (writes[p] && port(p).mode == WriteMode::kNormal)) continue;
      latch_[p] = 0;
      for (int i = 0; i < port(p).width; ++i) {
        const size_t at = place(p, *pins[p], i);
        uint64_t bit = bits_[at] ^ written[1 - p][at];  // a collision is made visible
        if (written[p][at] && port(p).mode == WriteMode::kWriteThrough) bit = after[at];
        latch_[p] |= bit << i;
      }
    }
    bits_ = after;
  }

  std::array<uint64_t, 2> outputs() const {
    std::array<uint64_t, 2> out;
    for (const size_t p : {0u, 1u}) out[p] = port(p).output_register ? register_[p] : latch_[p];
    if (wide()) {
      const uint64_t b = out[1];
      out[1] = case_.b.width == 36 ? b >> 18 : b;
      out[0] = b & 0x3ffff;
    }
    return out;
  }
  // A's output pins mean something.
  bool shows_a() const { return !wide() || case_.b.width == 36; }

 private:
  bool wide() const { return case_.a.width == 36; }
  const RamPort& port(size_t p) const { return p ? case_.b : case_.a; }
  bool active(size_t p, const Pins& pins) const { return pins.ce && pins.cs == port(p).decode; }
  void clear(size_t p) { latch_[p] = register_[p] = 0; }
  // Where bit i of the port's word lies. 512 words of 36 bits; address bits that are too fine for
  // the width name byte enables or nothing.
  size_t place(size_t p, const Pins& pins, int i) const {
    const int width = port(p).width;
    const uint32_t byte = pins.address / 8;
    const auto bit = static_cast<uint32_t>(i);
    if (width == 36) return 9 * (byte / 4 * 4) + bit;
    if (width == 18) return 9 * (byte / 2 * 2) + bit;
    if (width == 9) return 9 * byte + bit;
    const uint32_t step = static_cast<uint32_t>(width);
    return 9 * byte + pins.address % 8 / step * step + bit;
  }

  RamCase case_;
  std::vector<uint8_t> bits_;
  std::array<uint64_t, 2> latch_{}, register_{};
};

// Addresses of few words, those with initial values among them, so that words are met again.
uint32_t random_address(RoleRandom& random) {
  const uint32_t words[] = {0, 1, 7, 0x1a * 8, 0x1a * 8 + 3, 300, 511};
  return words[random.below(std::size(words))] << 5 | static_cast<uint32_t>(random.below(32));
}

}  // namespace

TEST_CASE("block RAM: every width, write mode, reset and register as specified") {
  RoleRandom random(1, "DP16KD");
  std::vector<std::vector<std::array<uint8_t, 320>>> init;
  const std::string library = build(ram_text(random, init), "rams");
  Model model(library, 1);
  std::vector<RamSpec> specs;
  for (size_t i = 0; i < std::size(kRams); ++i) specs.emplace_back(kRams[i], init[i]);
  std::array<Pins, 2> pins;
  const auto apply = [&] {
    for (const size_t p : {0u, 1u}) {
      const std::string low = p ? "_b_i" : "_a_i";
      set(model, "clk" + low, pins[p].clock);
      set(model, "ce" + low, pins[p].ce);
      set(model, "oce" + low, pins[p].oce);
      set(model, "we" + low, pins[p].we);
      set(model, "rst" + low, pins[p].rst);
      set(model, "cs" + low, pins[p].cs);
      set(model, "ad" + low, pins[p].address);
      set(model, "di" + low, pins[p].data);
    }
    model.eval();
  };
  std::array<uint64_t, std::size(kRams)> ones_seen{};
  const auto compare = [&](int step) {
    for (size_t i = 0; i < specs.size(); ++i) {
      const auto expected = specs[i].outputs();
      const uint64_t a = get(model, fmt::format("do_a{}_o", i)),
                     b = get(model, fmt::format("do_b{}_o", i));
      ones_seen[i] += b != 0;
      if (b == expected[1] && (!specs[i].shows_a() || a == expected[0])) continue;
      FAIL("RAM " << i << ", widths " << kRams[i].a.width << " and " << kRams[i].b.width
                  << ", step " << step << ": outputs " << a << ", " << b << ", expected "
                  << expected[0] << ", " << expected[1]);
    }
  };
  apply();
  for (int step = 0; step < 20000; ++step) {
    const std::array<bool, 2> toggles{random.below(8) != 0, random.below(8) != 0};
    for (const size_t p : {0u, 1u}) {
      Pins& n = pins[p];
      n.ce = random.below(5) != 0;
      n.oce = random.below(4) != 0;
      n.we = random.below(2) != 0;
      n.rst = random.below(24) == 0;
      // Mostly the value that some of the cases decode, so that the others are left alone.
      n.cs = random.below(4) ? 0 : static_cast<uint32_t>(random.below(8));
      n.address = random_address(random);
      n.data = static_cast<uint32_t>(random.bits() & 0x3ffff);
    }
    if (random.below(4) == 0) pins[1].address = pins[0].address ^ (random.below(2) ? 16 : 0);
    // What two writes at once leave in a bit nobody knows.
    if (pins[0].address / 16 == pins[1].address / 16 && pins[0].we) pins[1].we = false;
    for (RamSpec& s : specs) s.settle(pins[0], pins[1]);
    apply();
    compare(step);
    for (const size_t p : {0u, 1u}) pins[p].clock ^= toggles[p];
    for (size_t i = 0; i < specs.size(); ++i) {
      const auto edge = [&](size_t p) {
        const bool inverted = p ? kRams[i].b.inverted_clock : kRams[i].a.inverted_clock;
        return toggles[p] && pins[p].clock != inverted;
      };
      specs[i].clock(pins[0], pins[1], {edge(0), edge(1)});
    }
    apply();
    compare(step);
  }
  for (const uint64_t n : ones_seen) CHECK(n > 1000);
}

TEST_CASE("multiplier: the product, each side signed or not") {
  std::string text =
      "module mult (\n  input logic [17:0] a_i,\n  input logic [17:0] b_i,\n"
      "  input logic signed_a_i,\n  input logic signed_b_i,\n  output logic [35:0] p_o\n);\n"
      "  MULT18X18D cell_i (\n    ";
  text += pins("A", "a_i", 18) + pins("B", "b_i", 18) + pins("P", "p_o", 36);
  text +=
      "\n    .SIGNEDA(signed_a_i), .SIGNEDB(signed_b_i), .SOURCEA(1'b0), .SOURCEB(1'b0));\n"
      "endmodule\n";
  Model model(build(text, "mult"), 1);
  const auto check = [&](uint32_t a, uint32_t b, bool signed_a, bool signed_b) {
    set(model, "a_i", a);
    set(model, "b_i", b);
    set(model, "signed_a_i", signed_a);
    set(model, "signed_b_i", signed_b);
    model.eval();
    const auto number = [](uint32_t x, bool is_signed) {
      return is_signed && x >= 1u << 17 ? static_cast<int64_t>(x) - (1 << 18)
                                        : static_cast<int64_t>(x);
    };
    const int64_t product = number(a, signed_a) * number(b, signed_b);
    if (get(model, "p_o") != (static_cast<uint64_t>(product) & 0xfffffffffull))
      FAIL(a << " * " << b << ", signed " << signed_a << " " << signed_b << ": got "
             << get(model, "p_o") << ", expected " << product);
  };
  const uint32_t corners[] = {0, 1, 2, 0x1ffff, 0x20000, 0x20001, 0x3fffe, 0x3ffff};
  for (const uint32_t a : corners)
    for (const uint32_t b : corners)
      for (int s = 0; s < 4; ++s) check(a, b, s & 1, s & 2);
  RoleRandom random(1, "MULT18X18D");
  for (int i = 0; i < 20000; ++i)
    check(static_cast<uint32_t>(random.bits() & 0x3ffff),
          static_cast<uint32_t>(random.bits() & 0x3ffff), random.below(2), random.below(2));
}

TEST_CASE("what the models do not model is refused") {
  const std::string head = "module cell_user (\n  input logic clk_i\n);\n";
  const auto refuses = [&](const std::string& cell, const std::string& complaint) {
    try {
      build(head + cell + "endmodule\n", "cell_user");
      FAIL(cell << " was built");
    } catch (const std::exception& error) {
      CHECK_THAT(error.what(), ContainsSubstring(complaint));
    }
  };
  refuses("  MULT18X18D #(.REG_OUTPUT_CLK(\"CLK0\")) m (.A0(clk_i));\n",
          "mult18x18d_registers_are_not_modelled");
  refuses("  MULT18X18D m (.A0(clk_i), .CLK0(clk_i));\n", "CLK0");
  refuses("  DP16KD #(.DATA_WIDTH_A(3)) r (.CLKA(clk_i));\n",
          "dp16kd_widths_are_1_2_4_9_18_or_with_a_36");
  refuses("  DP16KD #(.DATA_WIDTH_A(18), .DATA_WIDTH_B(36)) r (.CLKA(clk_i));\n",
          "dp16kd_widths_are_1_2_4_9_18_or_with_a_36");
}
