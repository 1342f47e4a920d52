// SPDX-License-Identifier: Apache-2.0
// The hand-written SystemVerilog: which files a unit uses, and the ports of a module. Relies on the
// rules of rtl/: a module a file, named like it; one port a line, its meaning in a comment behind.
#pragma once
#include <set>
#include <string>
#include <vector>

namespace photonloom {

// The folder of the RTL sources: PHOTONLOOM_RTL of the environment, or rtl in data_dir().
std::string default_rtl_dir();

// The folder of the boards: PHOTONLOOM_BOARDS of the environment, or fpga/boards in data_dir().
std::string default_boards_dir();

// Files of `module` and of everything that it instantiates, directly or not, each after those it
// uses; paths relative to `rtl_dir`, which is searched one level deep (rtl/<folder>/<module>.sv,
// and rtl/<module>.sv as in generated packages). Modules named in `without` are left out with all
// that only they use. An unknown module is an error.
std::vector<std::string> module_files(const std::string& rtl_dir, const std::string& module,
                                      const std::set<std::string>& without = {});

// Modules in `dir` whose name stands in `text`, comments apart, in order.
std::vector<std::string> modules_named(const std::string& text, const std::string& dir);

struct ModulePort {
  bool output = false;
  std::string type;  // "logic", "logic [W-1:0]", "photonloom_pkg::gather_query_t"
  std::string name;
  std::string meaning;
};

// Ports of `module` in order. A line of the port list that is no port is an error naming file and
// line.
std::vector<ModulePort> module_ports(const std::string& rtl_dir, const std::string& module);

// Whether a unit has the port for a board's modules that share what it else has of its own: a unit
// alone leaves it open.
bool is_shared(const ModulePort& port);
// The pin of such a port on a unit alone.
std::string open_pin(const ModulePort& port);

// The type of a unit's port as seen from outside: widths that use the unit's parameters use the
// package's constants of the same name; the gatherer's own TagBits is that of its line port.
std::string package_type(const std::string& type, const std::string& unit);

}  // namespace photonloom
