// SPDX-License-Identifier: Apache-2.0
// photonloom replay UNIT --plan P --packets in.jsonl -o out.jsonl
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "command/backend_option.hpp"
#include "command/command.hpp"
#include "command/command_line.hpp"
#include "golden/packet/map_photon.hpp"
#include "golden/packet/trace.hpp"
#include "golden/plan/plan_file.hpp"
#include "verilator_tb/rig/compare.hpp"
#include "verilator_tb/rig/rig_options.hpp"

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

// Whether a file's first line has fields of such packets and the further one, and no others.
bool has_packets(const std::string& file, const PacketLayout& layout, const char* further) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  const auto object = nlohmann::json::parse(line, nullptr, false);
  if (!object.is_object() || object.empty() || (*further && !object.contains(further)))
    return false;
  for (const auto& [name, value] : object.items())
    if (!layout.find(name) && name != further) return false;
  return true;
}

// What an earlier run wrote does not stay beside results that have none of it. Another file of that
// name is somebody's own.
void remove_earlier(const std::string& file, const PacketLayout& layout, const char* further,
                    const char* what) {
  if (!std::filesystem::is_regular_file(file) || !has_packets(file, layout, further)) return;
  std::filesystem::remove(file);
  fmt::print("removed {}: {}\n", file, what);
}

// The unit by the backend that was asked for.
template <class Unit>
std::unique_ptr<Unit> make_unit(std::type_identity<Unit> unit, const ReplayOptions& o,
                                const Plan& plan) {
  return make_backend(unit, *parse_backend(o.backend), plan, o.rig.options(o.unit), o.board);
}

// Where it has a clock, no packet may come that nobody owed.
template <class Unit>
void finish(Unit& unit) {
  if (auto* clocked = dynamic_cast<Clocked*>(&unit)) clocked->finish();
}

// After all is written: whether the waveform is there.
template <class Unit>
void check_waveform(Unit& unit, const ReplayOptions& o) {
  if (auto* clocked = dynamic_cast<Clocked*>(&unit))
    o.rig.check_cycles_came(o.unit, clocked->cycles());
}

// A file's packets, in the order that the unit's stream must have.
template <class Unit>
std::vector<typename Unit::In> read_input(std::type_identity<Unit>, const std::string& file,
                                          const Plan& plan) {
  return read_trace<typename Unit::In>(file, plan);
}

void replay_unit(std::type_identity<PhotonGatherer> kind, const ReplayOptions& o,
                 const Plan& plan) {
  const PhotonMap global = load_map(o.photons, plan, false);
  const PhotonMap caustic = load_map(o.caustics, plan, true);
  const std::vector<GatherQuery> in = read_input(kind, o.packets, plan);
  const auto unit = make_unit(kind, o, plan);
  unit->load(global, caustic);
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  unit->process(in, results, photons);
  finish(*unit);
  write_packets(results, plan, o.output);
  const bool wanted = std::any_of(in.begin(), in.end(),
                                  [](const GatherQuery& q) { return q.want_photons && !q.flush; });
  if (wanted)
    write_packets(photons, plan, beside(o.output, "photons"));
  else
    remove_earlier(beside(o.output, "photons"), PacketLayout::of<GatherPhoton>(plan), "",
                   "photons of an earlier run, and no query wants any");
  for (const bool is_caustic : {false, true}) {
    const std::string file = beside(o.output, is_caustic ? "caustic_addresses" : "addresses");
    if (!(is_caustic ? o.caustics : o.photons).empty())
      write_addresses(is_caustic ? caustic : global, plan, file);
    else
      remove_earlier(file, PacketLayout::of<MapPhoton>(plan), "index",
                     "addresses of an earlier run, and this one has no such photons");
  }
  check_waveform(*unit, o);
}

std::vector<SamplerInput> read_input(std::type_identity<CdfSampler>, const std::string& file,
                                     const Plan& plan) {
  // The order of the one input stream is a rule of the unit, so it is checked here and nowhere in
  // hardware.
  std::vector<SamplerInput> in;
  const PacketLayout layout = PacketLayout::of<SamplerInput>(plan);
  int photons = 0;
  for_each_line(file, [&](const std::string& line, const std::string& where) {
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
  return in;
}

// A unit of one stream in and one out.
template <class Unit>
void replay_unit(std::type_identity<Unit> kind, const ReplayOptions& o, const Plan& plan) {
  const std::vector<typename Unit::In> in = read_input(kind, o.packets, plan);
  std::vector<typename Unit::FirstOut> out;
  const auto unit = make_unit(kind, o, plan);
  unit->process(in, out);
  finish(*unit);
  write_packets(out, plan, o.output);
  if constexpr (std::is_same_v<typename Unit::In, typename Unit::FirstOut>)
    if (out.size() < in.size())
      fmt::print("{} packets are still held: no flush came after them\n", in.size() - out.size());
  check_waveform(*unit, o);
}

void replay(const ReplayOptions& o) {
  const bool gatherer = o.unit == unit_name<PhotonGatherer>;
  const std::optional<Backend> backend = parse_backend(o.backend);
  if (!backend)
    throw UsageError(
        fmt::format("--backend: '{}', expected {}", o.backend, backend_kinds_text(false)));
  if (!backend->kind.serves(find_unit(o.unit)))
    throw UsageError(
        fmt::format("--backend {} answers gathers only, not packets of {}", o.backend, o.unit));
  if (!gatherer && !(o.photons.empty() && o.caustics.empty()))
    throw UsageError(fmt::format("{} has no meaning for {}",
                                 o.photons.empty() ? "--caustics" : "--photons", o.unit));
  std::set<ModelKind> models;
  if (backend->kind.model) models.insert(*backend->kind.model);
  o.rig.refuse_unread(models);
  if (backend->device.empty()) o.board.refuse_alone();
  if (models.empty() && backend->device.empty()) o.rig.refuse_work();
  o.rig.check_netlist(models.count(ModelKind::kNetlist));
  const std::string waveform = waveform_of(*backend);
  o.rig.check_waveform(waveform.empty() ? std::set<std::string>{} : std::set{o.unit});
  std::vector<std::string> outputs{o.output, o.rig.options(o.unit).waveform};
  if (gatherer)  // each is written, or removed
    for (const char* what : {"photons", "addresses", "caustic_addresses"})
      outputs.push_back(beside(o.output, what));
  check_outputs(outputs, {o.plan, o.packets, o.photons, o.caustics, o.rig.netlist()});
  const Plan plan = read_plan(o.plan);
  try {
    with_unit(o.unit, [&](auto unit) { replay_unit(unit, o, plan); });
  } catch (const RigError& error) {
    CompareContext context;
    context.unit = o.unit;
    context.waveform = waveform;
    context.rerun = command_line(RigFlags::waveform_options());
    context.writes(o.rig.options(o.unit));
    throw std::runtime_error(fmt::format("{}\n{}", error.what(), again_text(context, error.cycle)));
  }
}

void add_replay(CLI::App& app) {
  auto o = std::make_shared<ReplayOptions>();
  CLI::App* c = app.add_subcommand("replay", "Feed a unit your own packets");
  c->footer(fmt::format(
      "Packets are JSON lines, one object each, all fields of the packet and no others\n"
      "(docs/packets.md). Photons are JSON lines too, in any order: position, mantissa, exponent,\n"
      "direction; the address each got in the map is written to OUT.addresses.jsonl. Photons that\n"
      "queries ask for (want_photons) are written to OUT.photons.jsonl, in query order.\n\n"
      "Examples:\n"
      "  photonloom replay {} --plan plan.toml --photons photons.jsonl \\\n"
      "      --packets queries.jsonl --backend rtl -o results.jsonl\n"
      "  photonloom replay {} --plan plan.toml --packets queries.jsonl -o out.jsonl",
      unit_name<PhotonGatherer>, unit_name<ReorderBuffer>));
  c->add_option("UNIT", o->unit, unit_names_text())->required()->check(CLI::IsMember(unit_names()));
  c->add_option("--plan", o->plan, "The plan that defines formats and sizes")
      ->required()
      ->type_name("FILE");
  std::string inputs;
  for_each_unit([&](auto unit) {
    using Unit = typename decltype(unit)::type;
    inputs +=
        fmt::format("{}{} for {}", inputs.empty() ? "" : ", ", Unit::In::kName, unit_name<Unit>);
  });
  c->add_option("--packets", o->packets, "Packets to feed: " + inputs)
      ->required()
      ->type_name("FILE.jsonl");
  c->add_option("--photons", o->photons,
                fmt::format("The global map's photons ({})", unit_name<PhotonGatherer>))
      ->type_name("FILE.jsonl");
  c->add_option("--caustics", o->caustics,
                fmt::format("The caustic map's photons ({})", unit_name<PhotonGatherer>))
      ->type_name("FILE.jsonl");
  c->add_option("--backend", o->backend,
                "What answers (default rtl): " + backend_kinds_text(false) + "; docs/units.md")
      ->type_name("NAME");
  c->add_option("-o,--output", o->output, "Packets that came out")
      ->required()
      ->type_name("FILE.jsonl");
  o->rig.add_to(*c, "--seed");
  o->board.add_to(*c);
  c->callback([o] { replay(*o); });
}

const Command replay_command(61, add_replay);

}  // namespace
}  // namespace photonloom
