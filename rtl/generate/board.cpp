// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/board.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "golden/plan/units.hpp"
#include "rtl/generate/sources.hpp"

namespace photonloom {
namespace {

enum class Flow { kEcp5, kIce40, kVivado };

// What a board is, apart from its pins.
struct Board {
  const char* name;
  const char* top;    // prefix of the modules
  const char* part;   // for people
  const char* clock;  // port of the oscillator
  int oscillator_khz;
  int core_khz;  // default clock of board_core; 0: the board takes one unit only
  int unit_khz;  // what a unit alone is constrained to
  Flow flow;
  bool sdram;
  const char* serial_in;  // pins of a unit alone
  const char* serial_out;
};

constexpr Board kBoards[] = {
    {"ulx3s-85f", "ulx3s_85f", "LFE5U-85F-6 CABGA381", "clk_25mhz", 25000, 50000, 100000,
     Flow::kEcp5, true, "btn_i", "led_o"},
    {"up5k", "up5k", "iCE40UP5K SG48 of an iCEBreaker", "clk_12mhz", 12000, 0, 12000, Flow::kIce40,
     false, "btn_i", "led_o"},
    {"arty-a7-100t", "arty_a7_100t", "XC7A100T-1 CSG324", "clk_100mhz", 100000, 50000, 100000,
     Flow::kVivado, false, "btn_i", "led_o"},
};

const Board& find_board(const std::string& name) {
  for (const Board& b : kBoards)
    if (name == b.name) return b;
  std::string known;
  for (const Board& b : kBoards) known += (known.empty() ? "" : ", ") + std::string(b.name);
  throw std::runtime_error(fmt::format("there is no board {}, expected one of {}", name, known));
}

// A pin: port of the top, its site, and what it is.
struct Pin {
  std::string port, site;
  bool output = false;
};

// ULX3S: the pins that board_core uses, from the board's constraint file (docs/data.md).
std::vector<Pin> ulx3s_pins(bool unit, bool sdram) {
  std::vector<Pin> pins = {{"clk_25mhz", "G2", false}};
  if (unit) {
    pins.push_back({"btn_i", "R1", false});
    pins.push_back({"led_o", "B2", true});
    return pins;
  }
  pins.push_back({"btn_i", "R1", false});
  pins.push_back({"ftdi_txd_i", "M1", false});
  pins.push_back({"ftdi_rxd_o", "L4", true});
  const auto bus = [&](const std::string& name, std::initializer_list<const char*> sites) {
    int i = 0;
    for (const char* site : sites) pins.push_back({fmt::format("{}[{}]", name, i++), site, true});
  };
  bus("led_o", {"B2", "C2", "C1", "D2", "D1", "E2", "E1", "H3"});
  if (!sdram) return pins;
  for (const auto& [port, site] : {std::pair{"sdram_clk_o", "F19"},
                                   {"sdram_cke_o", "F20"},
                                   {"sdram_csn_o", "P20"},
                                   {"sdram_wen_o", "T20"},
                                   {"sdram_rasn_o", "R20"},
                                   {"sdram_casn_o", "T19"}})
    pins.push_back({port, site, true});
  bus("sdram_a_o",
      {"M20", "M19", "L20", "L19", "K20", "K19", "K18", "J20", "J19", "H20", "N19", "G20", "G19"});
  bus("sdram_ba_o", {"P19", "N20"});
  bus("sdram_dqm_o", {"U19", "E20"});
  bus("sdram_dq_io", {"J16", "L18", "M18", "N18", "P18", "T18", "T17", "U20", "E19", "D20", "D19",
                      "C20", "E18", "F18", "J18", "J17"});
  return pins;
}

std::string lpf(const Board& b, bool unit, bool sdram, int clock_khz) {
  std::string text =
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# Pins and clocks of a ULX3S; written by `photonloom generate`.\n"
      "BLOCK RESETPATHS;\nBLOCK ASYNCPATHS;\n"
      "SYSCONFIG CONFIG_IOVOLTAGE=3.3 COMPRESS_CONFIG=ON MCCLK_FREQ=62 MASTER_SPI_PORT=DISABLE "
      "SLAVE_SPI_PORT=DISABLE SLAVE_PARALLEL_PORT=DISABLE;\n\n";
  for (const Pin& p : ulx3s_pins(unit, sdram)) {
    const bool clock = p.port == b.clock, button = p.port == "btn_i";
    const bool serial = p.port.rfind("ftdi", 0) == 0;
    text += fmt::format("LOCATE COMP \"{}\" SITE \"{}\";\n", p.port, p.site);
    text += fmt::format("IOBUF PORT \"{}\" PULLMODE={} IO_TYPE=LVCMOS33{};\n", p.port,
                        serial   ? "UP"
                        : button ? "DOWN"
                                 : "NONE",
                        clock || button || !p.output ? "" : " DRIVE=4");
  }
  text += fmt::format("\nFREQUENCY PORT \"{}\" {:.3f} MHZ;\n", b.clock,
                      (unit ? clock_khz : b.oscillator_khz) / 1000.0);
  return text;
}

// Reset while the PLL is not locked and while the button is held, released in step with the clock.
constexpr const char* kResetText =
    "  logic [3:0] reset_q;\n"
    "  logic rst_q;\n"
    "  always_ff @(posedge clk) begin\n"
    "    reset_q <= {reset_q[2:0], btn_i || !locked};\n"
    "    rst_q   <= reset_q[3];\n"
    "  end\n\n";

// board_core's SDRAM pins where there is none.
constexpr const char* kNoSdramText =
    "  /* verilator lint_off UNUSED */  // there is no SDRAM in this plan\n"
    "  logic cke, cs_n, ras_n, cas_n, we_n, dq_enable;\n"
    "  logic [1:0] ba, dqm;\n"
    "  logic [12:0] a;\n"
    "  logic [15:0] dq_out;\n"
    "  /* verilator lint_on UNUSED */\n\n";
constexpr const char* kNoSdramPorts =
    "      .clk_sdram_i(clk),\n"
    "      .sdram_cke_o(cke),\n"
    "      .sdram_cs_no(cs_n),\n"
    "      .sdram_ras_no(ras_n),\n"
    "      .sdram_cas_no(cas_n),\n"
    "      .sdram_we_no(we_n),\n"
    "      .sdram_ba_o(ba),\n"
    "      .sdram_a_o(a),\n"
    "      .sdram_dqm_o(dqm),\n"
    "      .sdram_dq_i(16'h0),\n"
    "      .sdram_dq_o(dq_out),\n"
    "      .sdram_dq_oe_o(dq_enable)\n";

// Dividers of an EHXPLLL: VCO = f_in / ref * feedback * output, f_out = VCO / output.
struct Pll {
  int ref = 0, feedback = 0, output = 0;
};

// Exact, with the VCO nearest to 600 MHz; limits in docs/data.md.
Pll ecp5_pll(int in_khz, int out_khz) {
  Pll best;
  long best_distance = 0;
  if (out_khz >= 10000 && out_khz <= 400000)
    for (int ref = 1; ref <= 128 && in_khz >= 3125 * ref; ++ref)
      for (int feedback = 1; feedback <= 80; ++feedback) {
        if (static_cast<long>(in_khz) * feedback != static_cast<long>(out_khz) * ref) continue;
        for (int output = 1; output <= 128; ++output) {
          const long vco = static_cast<long>(out_khz) * output, distance = std::labs(vco - 600000);
          if (vco < 400000 || vco > 800000) continue;
          if (best.output == 0 || distance < best_distance) {
            best = {ref, feedback, output};
            best_distance = distance;
          }
        }
      }
  if (best.output == 0)
    throw std::runtime_error(
        fmt::format("the PLL cannot make {} kHz of {} kHz exactly, expected for example 50000, "
                    "62500, 75000 or 100000",
                    out_khz, in_khz));
  return best;
}

std::string name_list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& n : names) text += (text.empty() ? "" : ", ") + n;
  return text;
}

// One unit between a shift register and a signature register: every input comes from a flip-flop
// and every output ends in one, so that what is routed is the unit's own paths. What comes out of
// the last flip-flop depends on all outputs, so nothing is removed.
std::string unit_top(const Board& b, const std::string& unit, const std::string& rtl_dir) {
  std::vector<std::string> in, out, declared, connected;
  for (const ModulePort& p : module_ports(rtl_dir, unit)) {
    connected.push_back(fmt::format(".{0}({0})", p.name));
    if (p.name == "clk_i") continue;
    const std::string type = package_type(p.type, unit);
    declared.push_back(fmt::format("  {} {};\n", type, p.name));
    (p.output ? out : in).push_back(p.name);
    if (p.output) declared.push_back(fmt::format("  {} {}_q;\n", type, p.name));
  }
  std::string text = fmt::format(
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Generated: {0} alone, to read its size and speed. Its inputs come from a shift register, "
      "its outputs go into a\n// signature register; the pins mean nothing.\n"
      "module {1}_{0}_top (\n"
      "    input  logic {2},\n"
      "    input  logic {3},\n"
      "    output logic {4}\n"
      ");\n"
      "  logic clk_i;\n"
      "  assign clk_i = {2};\n",
      unit, b.top, b.clock, b.serial_in, b.serial_out);
  for (const std::string& d : declared) text += d;
  std::vector<std::string> out_q;
  for (const std::string& o : out) out_q.push_back(o + "_q");
  const std::string ins = name_list(in), outs = name_list(out), outs_q = name_list(out_q);
  text += fmt::format(
      "\n  logic serial_q;\n"
      "  always_ff @(posedge clk_i) {{serial_q, {0}}} <= {{{0}, {3}}};\n"
      "  always_ff @(posedge clk_i) {{{1}, {4}}} <= {{{4}, {1}}} ^ {{{2}, serial_q}};\n\n",
      ins, outs_q, outs, b.serial_in, b.serial_out);
  text += fmt::format("  (* keep_hierarchy *)\n  {0} {0} (\n", unit);
  for (size_t i = 0; i < connected.size(); ++i)
    text += fmt::format("      {}{}\n", connected[i], i + 1 < connected.size() ? "," : "");
  return text + "  );\nendmodule\n";
}

// The list of sources as one line of a Yosys script.
std::string joined(const std::vector<std::string>& files) {
  std::string text;
  for (const std::string& f : files) text += " " + f;
  return text;
}

std::string synthesis_script(const Board& b, const std::string& top, const std::string& unit,
                             const std::vector<std::string>& sources) {
  std::string text =
      fmt::format("# SPDX-License-Identifier: Apache-2.0\nread_verilog -sv{}\n", joined(sources));
  // An iCE40 has no memories of LUTs: they become flip-flops.
  if (b.flow == Flow::kIce40)
    text += fmt::format(
        "hierarchy -check -top {0}\nsetattr -unset ram_style a:ram_style=distributed\n"
        "synth_ice40 -device u -abc9 -top {0}\n",
        top);
  else
    text += fmt::format("synth_ecp5 -abc9 -top {}\n", top);
  text += fmt::format("tee -q -o build/{}.stat.json stat -json\n", top);
  // The unit's own size has been counted; now it is flattened for placement.
  if (!unit.empty()) text += fmt::format("setattr -unset keep_hierarchy t:{}\nflatten\n", unit);
  return text + fmt::format("write_json build/{}.json\n", top);
}

constexpr int kSdramKhz = 100000;

std::string makefile(const Board& b, const std::string& top, bool sdram, int clock_khz) {
  const std::string head = fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# {0} for {1}: `make` leaves build/{0}_seed$(SEED).bit; SEED=n places it anew,\n"
      "# `make flash` loads it over USB. Fails where the clock of {2:.3f} MHz is not met.\n",
      top, b.name, clock_khz / 1000.0);
  const std::string synthesis = fmt::format(
      "SEED ?= 1\n"
      "YOSYS ?= yosys\n"
      "ROUTED := build/{0}_seed$(SEED){1}\n\n"
      ".PHONY: all synth route flash clean\n"
      "all: $(ROUTED).bit\n"
      "synth: build/{0}.json\n"
      "route: $(ROUTED).config\n\n"
      "build/{0}.json: files.f board/synth.ys $(shell cat files.f)\n"
      "\t@mkdir -p build\n"
      "\t$(YOSYS) -q -l build/yosys.log board/synth.ys\n\n",
      top,
      b.flow == Flow::kEcp5 ? "$(if $(filter-out heap,$(PLACER)),_$(PLACER))"
                              "$(if $(filter-out 6,$(ROUTE_SPEED)),_route$(ROUTE_SPEED))"
                            : "");
  if (b.flow == Flow::kEcp5) {
    std::string clocks = fmt::format("'$$glbnet$$clk' {:.3f}", clock_khz / 1000.0);
    if (sdram) clocks += fmt::format(" '$$glbnet$$clk_sdram' {:.3f}", kSdramKhz / 1000.0);
    return head +
           "NEXTPNR ?= nextpnr-ecp5\nECPPACK ?= ecppack\nPLACER ?= heap\nROUTE_SPEED ?= 6\n" +
           synthesis +
           fmt::format(
               "# PLACER=static leaves shorter wires than nextpnr's default, and so a router less "
               "to do on a "
               "wide top.\n"
               "# The router of nextpnr 0.7 searches longer the slower the delays that it is "
               "given, "
               "without end\n"
               "# where wires are scarce. ROUTE_SPEED=8 has it route by those of the fastest "
               "grade; what it\n"
               "# leaves is analysed at grade 6 all the same. The clocks behind the PLL have to be "
               "told again.\n"
               "PART = $(NEXTPNR) -q --85k --package CABGA381 --freq {2:.3f} --lpf board/{1}.lpf\n"
               "PLACE = $(PART) --placer $(PLACER)\n"
               "ROUTE = $(PART) --lpf $(ROUTED).clocks.lpf --no-pack --no-place\n"
               "RESULT = --report $(ROUTED).json --log $(ROUTED).log --textcfg $@ "
               "$(NEXTPNR_FLAGS)\n\n"
               "$(ROUTED).config: build/{0}.json board/{1}.lpf\n"
               "ifeq ($(ROUTE_SPEED),6)\n"
               "\t$(PLACE) --speed 6 --seed $(SEED) --json build/{0}.json $(RESULT)\n"
               "else\n"
               "\t@printf 'FREQUENCY NET \"%s\" %s MHZ;\\n' {3} >$(ROUTED).clocks.lpf\n"
               "\t$(PLACE) --speed 6 --seed $(SEED) --json build/{0}.json --no-route "
               "--timing-allow-fail \\\n"
               "\t  --write $(ROUTED).placed.json --log $(ROUTED).placed.log\n"
               "\t$(ROUTE) --speed $(ROUTE_SPEED) --json $(ROUTED).placed.json --timing-allow-fail "
               "\\\n"
               "\t  --write $(ROUTED).routed.json --log $(ROUTED).routed.log\n"
               "\t$(ROUTE) --speed 6 --json $(ROUTED).routed.json $(RESULT)\n"
               "endif\n\n"
               "$(ROUTED).bit: $(ROUTED).config\n"
               "\t$(ECPPACK) --compress $< $@\n\n"
               "flash: $(ROUTED).bit\n"
               "\topenFPGALoader -b ulx3s $<\n\n"
               "clean:\n\trm -rf build\n",
               top, b.top, clock_khz / 1000.0, clocks);
  }
  return head + "NEXTPNR ?= nextpnr-ice40\nICEPACK ?= icepack\n" + synthesis +
         fmt::format(
             "$(ROUTED).config: build/{0}.json board/{1}.pcf\n"
             "\t$(NEXTPNR) -q --up5k --package sg48 --freq {2:.3f} --seed $(SEED) "
             "--json build/{0}.json --pcf board/{1}.pcf \\\n"
             "\t  --report $(ROUTED).json --log $(ROUTED).log --asc $@ $(NEXTPNR_FLAGS)\n\n"
             "$(ROUTED).bit: $(ROUTED).config\n"
             "\t$(ICEPACK) $< $@\n\n"
             "flash: $(ROUTED).bit\n"
             "\topenFPGALoader -b ice40_generic $<\n\n"
             "clean:\n\trm -rf build\n",
             top, b.top, clock_khz / 1000.0);
}

std::string pcf(const Board& b) {
  return fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# Pins of an iCEBreaker: oscillator, button, green LED; written by `photonloom generate`.\n"
      "set_io {} 35\nset_io {} 10\nset_io {} 37\n",
      b.clock, b.serial_in, b.serial_out);
}

std::string xdc(const Board& b, bool unit, int clock_khz) {
  std::string text = fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# Pins and clock of an Arty A7-100T; written by `photonloom generate`.\n"
      "set_property CFGBVS VCCO [current_design]\n"
      "set_property CONFIG_VOLTAGE 3.3 [current_design]\n"
      "create_clock -name oscillator -period {:.3f} [get_ports {}]\n",
      1e6 / (unit ? clock_khz : b.oscillator_khz), b.clock);
  std::vector<Pin> pins = {{b.clock, "E3", false}, {"btn_i", "D9", false}};
  if (unit) {
    pins.push_back({"led_o", "H5", true});
  } else {
    pins.push_back({"uart_rx_i", "A9", false});
    pins.push_back({"uart_tx_o", "D10", true});
    int i = 0;
    for (const char* site : {"H5", "J5", "T9", "T10"})
      pins.push_back({fmt::format("led_o[{}]", i++), site, true});
  }
  for (const Pin& p : pins)
    text += fmt::format(
        "set_property -dict {{PACKAGE_PIN {} IOSTANDARD LVCMOS33}} [get_ports {{{}}}]\n", p.site,
        p.port);
  return text;
}

std::string vivado_script(const std::string& top) {
  return fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# vivado -mode batch -source board/vivado.tcl, from the folder of the package; leaves\n"
      "# build/{0}.bit and reports beside it. Written to the vendor's documentation and not run "
      "on\n"
      "# the vendor's tool.\n"
      "file mkdir build\n"
      "create_project -in_memory -part xc7a100tcsg324-1\n"
      "read_verilog -sv [split [string trim [read [open files.f]]]]\n"
      "read_xdc board/arty_a7_100t.xdc\n"
      "synth_design -top {0}\n"
      "report_utilization -file build/{0}.synthesis.txt\n"
      "opt_design\nplace_design\nphys_opt_design\nroute_design\n"
      "report_utilization -file build/{0}.utilization.txt\n"
      "report_timing_summary -file build/{0}.timing.txt\n"
      "write_bitstream -force build/{0}.bit\n"
      "if {{[get_property SLACK [get_timing_paths]] < 0}} {{\n"
      "  puts \"ERROR: the clock is not met, see build/{0}.timing.txt\"\n  exit 1\n}}\n",
      top);
}

// Fastest rate of the board's UART that whole core clocks make, at least 8 of them a bit.
int uart_baud(const Board& b, int clock_khz) {
  for (const int baud : {3000000, 2000000, 1500000, 1000000, 500000, 115200}) {
    const long clocks = 1000L * clock_khz / baud;
    // 2 % off in the middle of the last bit is what a receiver bears; exact rates are the rule.
    if (clocks >= 8 && std::labs(1000L * clock_khz - clocks * baud) * 200 <= 1000L * clock_khz)
      return baud;
  }
  throw std::runtime_error(
      fmt::format("board {}: a core clock of {} kHz is too slow for its UART, expected at least "
                  "1000 kHz",
                  b.name, clock_khz));
}

// The SDRAM's own clock; its pin is ahead of it by a quarter, so that what the chip answers is
// stable when it is taken, and what it is told is stable when it looks.

std::string ulx3s_top(const Board& b, bool sdram, int clock_khz, int baud) {
  const Pll pll = ecp5_pll(b.oscillator_khz, clock_khz);
  const int vco_khz = clock_khz * pll.output, phase = pll.output / 2;
  const int sdram_divider = vco_khz / kSdramKhz;
  if (sdram && vco_khz % kSdramKhz != 0)
    throw std::runtime_error(
        fmt::format("the PLL cannot make {} kHz beside the SDRAM's {} kHz, expected for example "
                    "50000, 60000 or 100000",
                    clock_khz, kSdramKhz));
  std::string text = fmt::format(
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Generated: a ULX3S around board_core. The core runs at {0:.3f} MHz, made of the board's "
      "25 "
      "MHz; button FIRE1\n// resets it. The link is the board's USB serial port at {1} baud.\n"
      "module {2}_top #(\n"
      "    parameter int unsigned ClocksPerBit = {3}\n"
      ") (\n"
      "    input  logic        clk_25mhz,\n"
      "    input  logic        btn_i,\n"
      "    input  logic        ftdi_txd_i,     // from the host\n"
      "    output logic        ftdi_rxd_o,     // to the host\n"
      "    output logic [ 7:0] led_o{4}\n",
      clock_khz / 1000.0, baud, b.top, (1000L * clock_khz + baud / 2) / baud, sdram ? "," : "");
  if (sdram)
    text +=
        "    output logic        sdram_clk_o,\n"
        "    output logic        sdram_cke_o,\n"
        "    output logic        sdram_csn_o,\n"
        "    output logic        sdram_rasn_o,\n"
        "    output logic        sdram_casn_o,\n"
        "    output logic        sdram_wen_o,\n"
        "    output logic [ 1:0] sdram_ba_o,\n"
        "    output logic [12:0] sdram_a_o,\n"
        "    output logic [ 1:0] sdram_dqm_o,\n"
        "    inout  wire  [15:0] sdram_dq_io\n";
  text += fmt::format(
      ");\n"
      "  logic clk, {4}locked;\n"
      "  (* FREQUENCY_PIN_CLKI = \"25\", ICP_CURRENT = \"12\", LPF_RESISTOR = \"8\", "
      "MFG_ENABLE_FILTEROPAMP = \"1\", MFG_GMCREF_SEL = \"2\" *)\n"
      "  EHXPLLL #(\n"
      "      .PLLRST_ENA(\"DISABLED\"),\n"
      "      .INTFB_WAKE(\"DISABLED\"),\n"
      "      .STDBY_ENABLE(\"DISABLED\"),\n"
      "      .DPHASE_SOURCE(\"DISABLED\"),\n"
      "      .OUTDIVIDER_MUXA(\"DIVA\"),\n"
      "      .OUTDIVIDER_MUXB(\"DIVB\"),\n"
      "      .OUTDIVIDER_MUXC(\"DIVC\"),\n"
      "      .OUTDIVIDER_MUXD(\"DIVD\"),\n"
      "      .CLKI_DIV({0}),\n"
      "      .CLKFB_DIV({1}),\n"
      "      .FEEDBK_PATH(\"CLKOP\"),\n"
      "      .CLKOP_ENABLE(\"ENABLED\"),\n"
      "      .CLKOP_DIV({2}),\n"
      "      .CLKOP_CPHASE({3}),\n"
      "      .CLKOP_FPHASE(0)",
      pll.ref, pll.feedback, pll.output, phase, sdram ? "clk_sdram, clk_chip, " : "");
  if (sdram) {
    const int eighths = 6 * sdram_divider;  // three quarters of a period, in eighths of a VCO cycle
    text += fmt::format(
        ",\n"
        "      .CLKOS_ENABLE(\"ENABLED\"),\n"
        "      .CLKOS_DIV({0}),\n"
        "      .CLKOS_CPHASE({1}),\n"
        "      .CLKOS_FPHASE(0),\n"
        "      .CLKOS2_ENABLE(\"ENABLED\"),\n"
        "      .CLKOS2_DIV({0}),\n"
        "      .CLKOS2_CPHASE({2}),\n"
        "      .CLKOS2_FPHASE({3})",
        sdram_divider, phase, phase + eighths / 8, eighths % 8);
  }
  text += fmt::format(
      "\n  ) pll (\n"
      "      .RST(1'b0),\n"
      "      .STDBY(1'b0),\n"
      "      .CLKI(clk_25mhz),\n"
      "      .CLKFB(clk),\n"
      "      .CLKOP(clk),\n{}"
      "      .PHASESEL0(1'b0),\n"
      "      .PHASESEL1(1'b0),\n"
      "      .PHASEDIR(1'b1),\n"
      "      .PHASESTEP(1'b1),\n"
      "      .PHASELOADREG(1'b1),\n"
      "      .PLLWAKESYNC(1'b0),\n"
      "      .ENCLKOP(1'b0),\n"
      "      .LOCK(locked)\n"
      "  );\n\n",
      sdram ? "      .CLKOS(clk_sdram),\n      .CLKOS2(clk_chip),\n" : "");
  text += kResetText;
  if (sdram)
    text +=
        "  logic [15:0] dq_in, dq_out;\n"
        "  logic dq_enable;\n"
        "  for (genvar i = 0; i < 16; i++) begin : gen_dq\n"
        "    BB pad (\n"
        "        .I(dq_out[i]),\n"
        "        .T(!dq_enable),\n"
        "        .O(dq_in[i]),\n"
        "        .B(sdram_dq_io[i])\n"
        "    );\n"
        "  end\n"
        "  ODDRX1F clock_pad (\n"
        "      .SCLK(clk_chip),\n"
        "      .RST(1'b0),\n"
        "      .D0(1'b1),\n"
        "      .D1(1'b0),\n"
        "      .Q(sdram_clk_o)\n"
        "  );\n\n";
  else
    text += kNoSdramText;
  text += fmt::format(
      "  board_core #(\n"
      "      .ClocksPerBit(ClocksPerBit),\n"
      "      .ClockKHz({})\n"
      "  ) core (\n"
      "      .clk_i(clk),\n"
      "      .rst_i(rst_q),\n"
      "      .uart_rx_i(ftdi_txd_i),\n"
      "      .uart_tx_o(ftdi_rxd_o),\n"
      "      .led_o(led_o),\n",
      clock_khz);
  return text + (sdram ? "      .clk_sdram_i(clk_sdram),\n"
                         "      .sdram_cke_o(sdram_cke_o),\n"
                         "      .sdram_cs_no(sdram_csn_o),\n"
                         "      .sdram_ras_no(sdram_rasn_o),\n"
                         "      .sdram_cas_no(sdram_casn_o),\n"
                         "      .sdram_we_no(sdram_wen_o),\n"
                         "      .sdram_ba_o(sdram_ba_o),\n"
                         "      .sdram_a_o(sdram_a_o),\n"
                         "      .sdram_dqm_o(sdram_dqm_o),\n"
                         "      .sdram_dq_i(dq_in),\n"
                         "      .sdram_dq_o(dq_out),\n"
                         "      .sdram_dq_oe_o(dq_enable)\n"
                         "  );\nendmodule\n"
                       : std::string(kNoSdramPorts) + "  );\nendmodule\n");
}

std::string arty_top(const Board& b, int clock_khz, int baud) {
  constexpr int kVcoKhz = 1000000;
  if (kVcoKhz % clock_khz != 0 || kVcoKhz / clock_khz > 128)
    throw std::runtime_error(
        fmt::format("the PLL cannot make {} kHz of its {} kHz, expected a whole fraction of it: "
                    "for example 50000, 62500 or 100000",
                    clock_khz, kVcoKhz));
  std::string text = fmt::format(
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Generated: an Arty A7-100T around board_core. The core runs at {0:.3f} MHz, made of the "
      "board's 100 MHz; button 0\n// resets it. The link is the board's USB serial port at {1} "
      "baud. LEDs 0 to 3 are the core's.\n"
      "module {2}_top #(\n"
      "    parameter int unsigned ClocksPerBit = {3}\n"
      ") (\n"
      "    input  logic       clk_100mhz,\n"
      "    input  logic       btn_i,\n"
      "    input  logic       uart_rx_i,   // from the host\n"
      "    output logic       uart_tx_o,   // to the host\n"
      "    output logic [3:0] led_o\n"
      ");\n"
      "  logic clk, clk_made, feedback, locked;\n"
      "  PLLE2_BASE #(\n"
      "      .CLKIN1_PERIOD(10.0),\n"
      "      .CLKFBOUT_MULT(10),\n"
      "      .DIVCLK_DIVIDE(1),\n"
      "      .CLKOUT0_DIVIDE({4})\n"
      "  ) pll (\n"
      "      .CLKIN1(clk_100mhz),\n"
      "      .CLKFBIN(feedback),\n"
      "      .CLKFBOUT(feedback),\n"
      "      .CLKOUT0(clk_made),\n"
      "      .RST(1'b0),\n"
      "      .PWRDWN(1'b0),\n"
      "      .LOCKED(locked)\n"
      "  );\n"
      "  BUFG clock_buffer (\n"
      "      .I(clk_made),\n"
      "      .O(clk)\n"
      "  );\n\n",
      clock_khz / 1000.0, baud, b.top, (1000L * clock_khz + baud / 2) / baud, kVcoKhz / clock_khz);
  text += kResetText;
  text += kNoSdramText;
  text += fmt::format(
      "  logic [7:0] led;\n"
      "  logic unused_led;\n"
      "  assign led_o = led[3:0];\n"
      "  assign unused_led = ^led[7:4];\n"
      "  board_core #(\n"
      "      .ClocksPerBit(ClocksPerBit),\n"
      "      .ClockKHz({})\n"
      "  ) core (\n"
      "      .clk_i(clk),\n"
      "      .rst_i(rst_q),\n"
      "      .uart_rx_i(uart_rx_i),\n"
      "      .uart_tx_o(uart_tx_o),\n"
      "      .led_o(led),\n",
      clock_khz);
  return text + kNoSdramPorts + "  );\nendmodule\n";
}

// Primitives of the part that the top instantiates, empty, for lint; synthesis has its own.
std::string primitives(const Board& b, bool sdram) {
  std::string text =
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Ports of the part's primitives that the top uses, for lint alone: synthesis has its "
      "own.\n"
      "/* verilator lint_off DECLFILENAME */\n/* verilator lint_off UNUSED */\n"
      "/* verilator lint_off UNDRIVEN */\n/* verilator lint_off MULTITOP */\n";
  if (b.flow == Flow::kEcp5) {
    text += "module EHXPLLL #(\n";
    for (const char* p :
         {"PLLRST_ENA", "INTFB_WAKE", "STDBY_ENABLE", "DPHASE_SOURCE", "OUTDIVIDER_MUXA",
          "OUTDIVIDER_MUXB", "OUTDIVIDER_MUXC", "OUTDIVIDER_MUXD", "FEEDBK_PATH", "CLKOP_ENABLE",
          "CLKOS_ENABLE", "CLKOS2_ENABLE"})
      text += fmt::format("    parameter {} = \"\",\n", p);
    for (const char* p :
         {"CLKI_DIV", "CLKFB_DIV", "CLKOP_DIV", "CLKOP_CPHASE", "CLKOP_FPHASE", "CLKOS_DIV",
          "CLKOS_CPHASE", "CLKOS_FPHASE", "CLKOS2_DIV", "CLKOS2_CPHASE"})
      text += fmt::format("    parameter int {} = 1,\n", p);
    text +=
        "    parameter int CLKOS2_FPHASE = 0\n"
        ") (\n"
        "    input  RST, STDBY, CLKI, CLKFB, PHASESEL0, PHASESEL1, PHASEDIR, PHASESTEP,\n"
        "    input  PHASELOADREG, PLLWAKESYNC, ENCLKOP,\n"
        "    output ";
    text += sdram ? "CLKOP, CLKOS, CLKOS2, LOCK\n);\nendmodule\n" : "CLKOP, LOCK\n);\nendmodule\n";
    text +=
        "module BB (input I, T, output O, inout B);\nendmodule\n"
        "module ODDRX1F (input SCLK, RST, D0, D1, output Q);\nendmodule\n";
  } else {
    text +=
        "module PLLE2_BASE #(\n"
        "    parameter real CLKIN1_PERIOD = 0,\n"
        "    parameter int CLKFBOUT_MULT = 1,\n"
        "    parameter int DIVCLK_DIVIDE = 1,\n"
        "    parameter int CLKOUT0_DIVIDE = 1\n"
        ") (\n"
        "    input  CLKIN1, CLKFBIN, RST, PWRDWN,\n"
        "    output CLKFBOUT, CLKOUT0, LOCKED\n"
        ");\nendmodule\n"
        "module BUFG (input I, output O);\nendmodule\n";
  }
  return text;
}

std::string board_readme(const Board& b, const BoardFiles& files) {
  std::string text = fmt::format("## Board\n\n`{}`: {}. ", b.name, b.part);
  if (files.uart_baud)
    text += fmt::format(
        "The core runs at {:.3f} MHz, the link at {} baud ({}).\n\n", files.clock_khz / 1000.0,
        files.uart_baud,
        b.flow == Flow::kEcp5 ? "the FT231X of port US1" : "the FT2232 of the board's USB port");
  else
    text += fmt::format(
        "`{}` alone, constrained to {:.3f} MHz: its inputs come from a shift register, its outputs "
        "go into a signature register, so that its own size and speed can be read. The pins mean "
        "nothing.\n\n",
        files.inner, files.clock_khz / 1000.0);
  switch (b.flow) {
    case Flow::kEcp5:
      text += fmt::format(
          "    make          # Yosys >= 0.52, nextpnr-ecp5, ecppack: build/{0}_seed1.bit\n"
          "    make flash    # openFPGALoader -b ulx3s build/{0}_seed1.bit\n\n"
          "`openFPGALoader -b ulx3s -f FILE.bit` writes it into the board's flash, so that it is "
          "there after power-on. The tools are those on PATH, for instance of Photonloom's `make "
          "fpga-tools`, whose commands lie in its build/fpga-tools/bin; others by `make YOSYS=... "
          "NEXTPNR=... ECPPACK=...`.\n\n",
          files.top);
      break;
    case Flow::kIce40:
      text += fmt::format(
          "    make          # Yosys, nextpnr-ice40, icepack: build/{0}_seed1.bit\n"
          "    make flash    # openFPGALoader -b ice40_generic build/{0}_seed1.bit\n\n",
          files.top);
      break;
    case Flow::kVivado:
      text += fmt::format(
          "    vivado -mode batch -source board/vivado.tcl    # build/{0}.bit\n"
          "    openFPGALoader -b arty_a7_100t build/{0}.bit\n\n"
          "This project was not run on the vendor's tool.\n\n",
          files.top);
      break;
  }
  if (files.uart_baud)
    text += fmt::format(
        "With the board at a serial port, a frame through it, packet by packet:\n\n"
        "    photonloom board info /dev/ttyUSB0@{0}\n"
        "    photonloom cosim SCENE --plan plan.toml --backend "
        "{1}=board:/dev/ttyUSB0@{0}"
        "\n\n",
        files.uart_baud, unit_name<PhotonGatherer>);
  if (files.uart_baud) {
    text += "LEDs: 0 heartbeat, 1 bytes from the host, 2 bytes to the host, 3 queries inside";
    if (b.flow == Flow::kEcp5)  // the others have no more than four
      text +=
          ", 4 replayer busy, 5 photon memory busy, 6 a bad frame since reset, 7 a host has read "
          "the plan hash";
    text += ".\n\n";
  }
  return text;
}

}  // namespace

std::vector<std::string> board_names() {
  std::vector<std::string> names;
  for (const Board& b : kBoards) names.push_back(b.name);
  return names;
}

void check_board(const Plan& plan, const BoardRequest& request) {
  const Board& b = find_board(request.name);
  if (!request.unit.empty()) return;
  if (b.core_khz == 0)
    throw std::runtime_error(fmt::format(
        "board {} has room for one unit alone, expected --unit with it ({} of a small plan "
        "fits)",
        b.name, unit_name<ReorderBuffer>));
  if (plan.photon_memory == PhotonMemory::kSdram && !b.sdram)
    throw std::runtime_error(
        fmt::format("board {} has no SDRAM that photon_sdram serves, but the plan's "
                    "board.photon_memory is sdram, expected block_ram",
                    b.name));
}

BoardFiles board_files(const Plan& plan, const BoardRequest& request, const std::string& rtl_dir,
                       const std::vector<std::string>& sources) {
  check_board(plan, request);
  const Board& b = find_board(request.name);
  const bool unit = !request.unit.empty();
  BoardFiles out;
  out.inner = unit ? request.unit : "board_core";
  out.top = unit ? fmt::format("{}_{}_top", b.top, request.unit) : fmt::format("{}_top", b.top);
  out.clock_khz = request.clock_khz ? request.clock_khz : unit ? b.unit_khz : b.core_khz;
  std::vector<std::string> all = sources;
  all.push_back("rtl/" + out.top + ".sv");
  std::string& top = out.files["rtl/" + out.top + ".sv"];
  const bool sdram = !unit && plan.photon_memory == PhotonMemory::kSdram;
  if (unit) {
    top = unit_top(b, request.unit, rtl_dir);
  } else {
    out.uart_baud = uart_baud(b, out.clock_khz);
    top = b.flow == Flow::kEcp5 ? ulx3s_top(b, sdram, out.clock_khz, out.uart_baud)
                                : arty_top(b, out.clock_khz, out.uart_baud);
    out.files["board/primitives.sv"] = primitives(b, sdram);
  }
  switch (b.flow) {
    case Flow::kEcp5:
      out.files[fmt::format("board/{}.lpf", b.top)] = lpf(b, unit, sdram, out.clock_khz);
      break;
    case Flow::kIce40:
      out.files[fmt::format("board/{}.pcf", b.top)] = pcf(b);
      break;
    case Flow::kVivado:
      out.files[fmt::format("board/{}.xdc", b.top)] = xdc(b, unit, out.clock_khz);
      out.files["board/vivado.tcl"] = vivado_script(out.top);
      break;
  }
  if (b.flow != Flow::kVivado) {
    out.files["board/synth.ys"] = synthesis_script(b, out.top, request.unit, all);
    out.files["Makefile"] = makefile(b, out.top, sdram, out.clock_khz);
  }
  out.readme = board_readme(b, out);
  return out;
}

}  // namespace photonloom
