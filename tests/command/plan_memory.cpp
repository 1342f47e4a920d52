// SPDX-License-Identifier: Apache-2.0
// What `photonloom plan` says of a unit's memories is what its RTL has, as Verilator elaborates it.
#include <fmt/core.h>

#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using photonloom::read_file;
using photonloom::test::run;
using photonloom::test::Scratch;

namespace {

// Words times bits of all instances of block_ram and block_ram_two_reads below the top.
uint64_t bits_in_rtl(const std::string& arguments, const std::string& unit) {
  const Scratch s;
  const auto o = run("generate " + arguments + " --unit " + unit + " -o '" + s / "package" + "'");
  INFO(o.err);
  REQUIRE(o.status == 0);
  const std::string elaborate = fmt::format(
      "cd '{}' && verilator --xml-only --xml-output '{}' -Wno-lint -Wno-fatal --top-module {} -f "
      "files.f >'{}' 2>&1",
      s / "package", s / "rtl.xml", unit, s / "said");
  const int status = std::system(elaborate.c_str());
  INFO(read_file(s / "said"));
  REQUIRE(status == 0);
  const std::string xml = read_file(s / "rtl.xml");

  const auto parameter = [](const std::string& module, const std::string& name) {
    std::smatch value;
    REQUIRE(std::regex_search(module, value,
                              std::regex("origName=\"" + name +
                                         "\" param=\"true\">\\s*<const [^>]*name=\"32&apos;"
                                         "s?h([0-9a-f]+)\"")));
    return std::stoull(value[1], nullptr, 16);
  };
  std::map<std::string, uint64_t> bits;  // of an instance, by module
  const std::regex head("<module [^>]*name=\"([^\"]+)\" origName=\"block_ram(?:_two_reads)?\"");
  for (std::sregex_iterator i(xml.begin(), xml.end(), head), end; i != end; ++i) {
    const auto at = static_cast<size_t>(i->position());
    const std::string module = xml.substr(at, xml.find("<begin", at) - at).substr(0, 4000);
    bits[(*i)[1]] = parameter(module, "Width") * parameter(module, "Depth");
  }
  const std::string cells =
      xml.substr(xml.find("<cells>"), xml.find("</cells>") - xml.find("<cells>"));
  uint64_t sum = 0;
  const std::regex cell("<cell [^>]*submodname=\"([^\"]+)\"");
  for (std::sregex_iterator i(cells.begin(), cells.end(), cell), end; i != end; ++i)
    if (const auto module = bits.find((*i)[1]); module != bits.end()) sum += module->second;
  return sum;
}

}  // namespace

TEST_CASE("plan: bits of a unit's memories are those of its RTL") {
  const std::string gatherer = photonloom::test::source("fpga/gatherer.toml");
  const auto plan = [](const char* name) {
    return photonloom::test::source(fmt::format("fpga/plans/{}.toml", name));
  };
  // 16 words more than the packets are a power of two, so that no pool has a rest in LUTs.
  const std::string plans[] = {
      gatherer + " --set reorder.packets=2032",
      gatherer +
          " --set board.parity=true --set gatherer.nodes_per_cycle=2 --set "
          "reorder.packets=2032 --set sampler.levels=3",
      gatherer +
          " --set gather.k=50 --set gatherer.candidates_per_cycle=2 --set "
          "gatherer.powers_per_cycle=2 --set gatherer.nodes_per_cycle=2 --set "
          "gatherer.contexts=32 --set cache.present=true --set reorder.drain=fullest --set "
          "reorder.packets=8176",
      plan("compressed8") + " --set reorder.packets=496",
      plan("uncached") +
          " --set board.gatherers=5 --set gatherer.nodes_per_cycle=2 --set "
          "reorder.packets=100 --set board.lut_ram_words=64"};
  for (const std::string& arguments : plans) {
    CAPTURE(arguments);
    const auto o = run("plan " + arguments + " --json");
    INFO(o.err);
    REQUIRE(o.status == 0);
    const auto memory = nlohmann::json::parse(o.out)["memory_bits"];
    for (const std::string unit :
         {"photon_gatherer", "reorder_buffer", "cdf_sampler", "irradiance_cache"}) {
      if (unit == "irradiance_cache" && arguments.find("cache.present") == std::string::npos)
        continue;
      uint64_t said = 0;
      for (const auto& [place, bits] : memory.items())
        if (place.rfind(unit + ", ", 0) == 0) said += bits.get<uint64_t>();
      CAPTURE(unit);
      CHECK(said == bits_in_rtl(arguments, unit));
    }
  }
}

TEST_CASE("plan: a pool has 16 words more than packets") {
  const auto pool = [](int packets) {
    const auto o = run("plan " + photonloom::test::source("fpga/gatherer.toml") +
                       fmt::format(" --json --set reorder.packets={}", packets));
    REQUIRE(o.status == 0);
    return nlohmann::json::parse(o.out)["memory_bits"]["reorder_buffer, pool"].get<uint64_t>();
  };
  CHECK(pool(2048) * 2048 == pool(2032) * 2064);
}
