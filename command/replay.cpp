// SPDX-License-Identifier: Apache-2.0
// photonloom replay UNIT --plan P --packets in.jsonl -o out.jsonl
#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "command/board_option.hpp"
#include "command/command.hpp"
#include "golden/packet/map_photon.hpp"
#include "golden/packet/trace.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/unit/photon_gatherer.hpp"
#include "verilator_tb/rig/rig_options.hpp"
#include "verilator_tb/unit/backends.hpp"

namespace photonloom {
namespace {

struct ReplayOptions {
  std::string unit, plan, packets, photons, caustics, backend = "rtl", output;
  RigFlags rig;
  BoardFlags board;
};

// out.jsonl, "photons" -> out.photons.jsonl
std::string beside(const std::string& output, const std::string& what) {
  std::filesystem::path path(output);
  const std::string extension = path.extension().string();
  return path.replace_extension().string() + "." + what + extension;
}

PhotonMap load_map(const std::string& file, const Plan& plan, bool is_caustic) {
  std::vector<PackedPhoton> photons;
  const PacketLayout layout = PacketLayout::of<MapPhoton>(plan);
  const MapPlan& map = plan.map(is_caustic);
  const char* section = is_caustic ? "caustic" : "global";
  const PowerCode unused = invalid_power(plan.exponent_bits);
  if (!file.empty() && !map.present)
    throw std::runtime_error(fmt::format("{}: the plan has no {} map; set {}.present and .photons",
                                         file, section, section));
  if (!file.empty())
    for_each_line(file, [&](const std::string& line, const std::string& where) {
      MapPhoton p{};
      packet_from_json(layout, line, where, &p);
      const PackedPhoton packed{
          p.position, {p.mantissa, p.exponent}, {p.direction[0], p.direction[1]}};
      if (packed.power == unused)
        throw std::runtime_error(fmt::format(
            "{}: mantissa 0 with exponent {} marks an unused slot of a line, so no photon can have "
            "it",
            where, unused.exponent));
      if (photons.size() == map.photons)
        throw std::runtime_error(
            fmt::format("{}: is one photon too many, the plan has {}.photons = {}", where, section,
                        map.photons));
      photons.push_back(packed);
    });
  return build_photon_map(photons, plan);
}

// The lines of a photon file again, in their order, each with the address its photon got.
void write_addresses(const PhotonMap& map, const Plan& plan, const std::string& path) {
  std::vector<uint64_t> index(map.count);
  for (uint64_t i = 0; i < map.count; ++i) index[map.source[i]] = i;
  const PacketLayout layout = PacketLayout::of<MapPhoton>(plan);
  OutputFile out(path);
  for (const uint64_t i : index) {
    const PackedPhoton& s = map.slots[i];
    const MapPhoton p{
        s.position, s.power.mantissa, s.power.exponent, {s.direction.u, s.direction.v}};
    out.write(fmt::format("{{\"index\": {}, {}\n", i, packet_to_json(layout, &p).substr(1)));
  }
  out.commit();
  fmt::print("wrote {}: the address of each photon\n", path);
}

template <class P>
void write_packets(const std::vector<P>& packets, const Plan& plan, const std::string& path) {
  TraceWriter<P> out(path, plan);
  for (const P& p : packets) out.write(p);
  out.commit();
  fmt::print("wrote {}: {} {} packets\n", path, packets.size(), P::kName);
}

// Options of a unit that runs as hardware.
RunOptions run_options(const ReplayOptions& o) {
  RunOptions run = o.rig.options(o.unit);
  run.kind = *model_kind(o.backend);
  return run;
}

void replay_photon_gatherer(const ReplayOptions& o, const Plan& plan) {
  const PhotonMap global = load_map(o.photons, plan, false);
  const PhotonMap caustic = load_map(o.caustics, plan, true);
  const std::vector<GatherQuery> in = read_trace<GatherQuery>(o.packets, plan);
  std::unique_ptr<PhotonGatherer> unit;
  ClockedPhotonGatherer* clocked = nullptr;
  if (model_kind(o.backend)) {
    auto rtl = make_rtl_photon_gatherer(plan, run_options(o));
    clocked = rtl.get();
    unit = std::move(rtl);
  } else if (const auto device = board_device(o.backend)) {
    unit = o.board.photon_gatherer(plan, *device, o.rig.options(o.unit).work_dir);
  } else {
    unit = o.backend == "golden" ? make_golden_photon_gatherer(plan)
                                 : make_brute_photon_gatherer(plan);
  }
  unit->load(global, caustic);
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  unit->process(in, results, photons);
  if (clocked) clocked->finish();
  write_packets(results, plan, o.output);
  bool wanted = false;
  for (const GatherQuery& q : in) wanted |= q.want_photons && !q.flush;
  if (wanted) write_packets(photons, plan, beside(o.output, "photons"));
  if (!o.photons.empty()) write_addresses(global, plan, beside(o.output, "addresses"));
  if (!o.caustics.empty()) write_addresses(caustic, plan, beside(o.output, "caustic_addresses"));
}

void replay_reorder_buffer(const ReplayOptions& o, const Plan& plan) {
  const std::vector<GatherQuery> in = read_trace<GatherQuery>(o.packets, plan);
  std::vector<GatherQuery> out;
  if (model_kind(o.backend)) {
    const auto rtl = make_rtl_reorder_buffer(plan, run_options(o));
    rtl->process(in, out);
    rtl->finish();
  } else {
    make_golden_reorder_buffer(plan)->process(in, out);
  }
  write_packets(out, plan, o.output);
  if (out.size() < in.size())
    fmt::print("{} packets are still held: no flush came after them\n", in.size() - out.size());
}

void replay_cdf_sampler(const ReplayOptions& o, const Plan& plan) {
  // The order of the one input stream is a rule of the unit, so it is checked here and nowhere in
  // hardware.
  std::vector<SamplerInput> in;
  const PacketLayout layout = PacketLayout::of<SamplerInput>(plan);
  int photons = 0;
  for_each_line(o.packets, [&](const std::string& line, const std::string& where) {
    SamplerInput p{};
    packet_from_json(layout, line, where, &p);
    if (p.kind > 2)
      throw std::runtime_error(fmt::format(
          "{}: field kind is {}, expected 0 header, 1 photon or 2 request", where, p.kind));
    if (in.empty() && p.kind != 0)
      throw std::runtime_error(fmt::format(
          "{}: field kind is {}, expected 0: a table begins with its header", where, p.kind));
    if (p.kind == 1 && in.back().kind == 2)
      throw std::runtime_error(fmt::format(
          "{}: field kind is 1, but a photon cannot follow a request of the same table", where));
    photons = p.kind == 0 ? 0 : photons + (p.kind == 1);
    if (photons > plan.k)
      throw std::runtime_error(fmt::format(
          "{}: is photon {} of its table, the plan has gather.k = {}", where, photons, plan.k));
    in.push_back(p);
  });
  std::vector<Sample> out;
  if (model_kind(o.backend)) {
    const auto rtl = make_rtl_cdf_sampler(plan, run_options(o));
    rtl->process(in, out);
    rtl->finish();
  } else {
    make_golden_cdf_sampler(plan)->process(in, out);
  }
  write_packets(out, plan, o.output);
}

void replay(const ReplayOptions& o) {
  const bool gatherer = o.unit == "photon_gatherer";
  if ((o.backend == "brute" || board_device(o.backend)) && !gatherer)
    throw UsageError(
        fmt::format("--backend {} answers gathers only, not packets of {}", o.backend, o.unit));
  if (!board_device(o.backend) && !model_kind(o.backend) && o.backend != "golden" &&
      o.backend != "brute")
    throw UsageError(
        fmt::format("--backend: '{}', expected rtl, netlist, cxxrtl, board:DEVICE, golden or brute",
                    o.backend));
  if (!gatherer && !(o.photons.empty() && o.caustics.empty()))
    throw UsageError(fmt::format("{} has no meaning for {}",
                                 o.photons.empty() ? "--caustics" : "--photons", o.unit));
  o.rig.check_netlist(o.backend == "netlist");
  const Plan plan = read_plan(o.plan);
  if (gatherer)
    replay_photon_gatherer(o, plan);
  else if (o.unit == "reorder_buffer")
    replay_reorder_buffer(o, plan);
  else
    replay_cdf_sampler(o, plan);
}

void add_replay(CLI::App& app) {
  auto o = std::make_shared<ReplayOptions>();
  CLI::App* c = app.add_subcommand("replay", "Feed a unit your own packets");
  c->footer(
      "Packets are JSON lines, one object each, all fields of the packet and no others\n"
      "(docs/packets.md). Photons are JSON lines too, in any order: position, mantissa, exponent,\n"
      "direction; the address each got in the map is written to OUT.addresses.jsonl. Photons that\n"
      "queries ask for (want_photons) are written to OUT.photons.jsonl, in query order.\n\n"
      "Examples:\n"
      "  photonloom replay photon_gatherer --plan plan.toml --photons photons.jsonl \\\n"
      "      --packets queries.jsonl --backend rtl -o results.jsonl\n"
      "  photonloom replay reorder_buffer --plan plan.toml --packets queries.jsonl -o out.jsonl");
  c->add_option("UNIT", o->unit, "photon_gatherer, reorder_buffer or cdf_sampler")
      ->required()
      ->check(CLI::IsMember({"photon_gatherer", "reorder_buffer", "cdf_sampler"}));
  c->add_option("--plan", o->plan, "The plan that defines formats and sizes")
      ->required()
      ->type_name("FILE");
  c->add_option("--packets", o->packets,
                "Packets to feed: gather_query, or sampler_input for cdf_sampler")
      ->required()
      ->type_name("FILE.jsonl");
  c->add_option("--photons", o->photons, "The global map's photons (photon_gatherer)")
      ->type_name("FILE.jsonl");
  c->add_option("--caustics", o->caustics, "The caustic map's photons (photon_gatherer)")
      ->type_name("FILE.jsonl");
  c->add_option("--backend", o->backend,
                "rtl (default), netlist, cxxrtl, board:DEVICE[@BAUD], golden, or brute: gathers by "
                "trying every photon")
      ->type_name("NAME");
  c->add_option("-o,--output", o->output, "Packets that came out")
      ->required()
      ->type_name("FILE.jsonl");
  o->rig.add_to(*c, "--seed");
  o->board.add_to(*c);
  c->callback([o] { replay(*o); });
}

const Command registered(60, add_replay);

}  // namespace
}  // namespace photonloom
