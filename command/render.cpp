// SPDX-License-Identifier: Apache-2.0
// photonloom render SCENE -o out.exr
#include <fmt/core.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "command/console.hpp"
#include "command/frame_options.hpp"
#include "command/json_text.hpp"
#include "command/unit_times.hpp"
#include "golden/image/pixel_sum.hpp"
#include "golden/image/sheet.hpp"
#include "golden/numeric/elementary.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/pipeline/record.hpp"
#include "golden/transport/path.hpp"

namespace photonloom {
namespace {

struct RenderOptions {
  FrameOptions frame;
  ThreadsOption threads;
  std::string output, integrator = "photonmap", arithmetic, record;
  bool json = false, substitute = false;
};

using Json = nlohmann::ordered_json;

std::string png_beside(const std::string& exr) {
  return std::filesystem::path(exr).replace_extension(".png").string();
}

// On screen and in the image: what stands for elements that are not supported.
void record_substitutions(const Scene& scene, Image& image, Json& summary) {
  size_t number = 0;
  for (const std::string& s : scene.substitutions)
    image.metadata[fmt::format("substitution.{}", ++number)] = s;
  if (number == 0) return;
  print_warnings(scene.substitutions);
  summary["substitutions"] = scene.substitutions;
}

// Renders by photon mapping; fills metadata and summary.
Image photon_map(const RenderOptions& o, const FrameRequest& request, ConsoleProgress& progress,
                 Json& summary, std::string& range_counts) {
  const Arithmetic arithmetic =
      o.arithmetic == "reference" ? Arithmetic::kReference : Arithmetic::kGolden;
  const char* const arithmetic_name = arithmetic == Arithmetic::kGolden ? "golden" : "reference";
  PreparedFrame frame = prepare_frame(request, arithmetic, &progress);
  print_warnings(frame.warnings);
  UnitTimes times;
  FrameUnits units = timed_units(make_golden_units(frame.plan), times);
  GatherWatch watch(frame.plan);
  units.photon_gatherer = watch.wrap(std::move(units.photon_gatherer));
  std::optional<OutputFolder> folder;
  std::optional<PacketRecorder> recorder;
  if (!o.record.empty()) {
    folder.emplace(o.record, OutputFolderKind{"gather_query.jsonl", "", {"plan.toml", "*.jsonl"}});
    recorder.emplace(frame.plan, folder->temporary());
    units = recorder->wrap(std::move(units));
  }
  FrameCounts counts;
  Image image = render_frame(frame.input(arithmetic), units, counts, &progress);
  if (recorder) {
    recorder->close();
    write_plan(frame.plan, folder->temporary() + "/plan.toml", frame.reasons);
    folder->commit();
  }
  print_warnings(count_messages(counts));
  range_counts = range_counts_text(counts);
  if (counts.unmatched || counts.unanswered)
    throw std::runtime_error(fmt::format("{} results answer no query and {} queries have no result",
                                         counts.unmatched, counts.unanswered));
  const Plan& plan = frame.plan;
  describe_frame(image, frame, request, arithmetic_name);
  record_substitutions(frame.world->scene(), image, summary);
  summary["pixels_sha256"] = pixel_sha256(image);  // of what the plan decides
  if (arithmetic == Arithmetic::kGolden) {
    const GatherDiagnosis diagnosis = diagnose_into(image, watch, frame, request);
    print_warnings(diagnosis_messages(diagnosis, request));
    summary["diagnosis"] = diagnosis_json(diagnosis);
  }
  summary["spp"] = plan.spp;
  summary["gather_rays"] = plan.gather_rays;
  summary["photons"] = frame.global.count;
  summary["caustic_photons"] = frame.caustic.count;
  summary["paths"] = frame.global_pass.paths;
  summary["caustic_paths"] = frame.caustic_pass.paths;
  summary.update(packed_json(frame));
  summary["k"] = plan.k;
  summary["radius"] = plan.global.radius;
  summary["caustic_radius"] = plan.caustic.radius;
  summary["arithmetic"] = arithmetic_name;
  summary["plan_hash"] = plan_hash_text(plan);
  summary["scene_hash"] = fmt::format("{:016x}", frame.world->scene().hash);
  summary["counts"] = counts_json(counts);
  if (arithmetic == Arithmetic::kGolden)
    for_each_unit([&](auto unit) {
      summary["units"][unit_name<typename decltype(unit)::type>] = units.of(unit)->counters();
    });
  for (const auto& [unit, time] : times)
    summary["unit_seconds"][unit] = {{"wall", time.wall}, {"cpu", time.cpu}};
  return image;
}

Image path_trace(const RenderOptions& o, const FrameRequest& request, ConsoleProgress& progress,
                 Json& summary) {
  std::unique_ptr<World> world;
  std::unique_ptr<RayCaster> caster;
  {
    const ProgressPhase phase(&progress, "scene", 0, "");
    world = load_world(request);
    caster = make_embree(*world);
  }
  print_warnings(world->scene().warnings);
  const double radiance =
      max_component(world->emitted_power()) / (kPi * std::max(world->surface_area(), 1e-290));
  if (radiance < std::numeric_limits<float>::min())
    print_warnings(
        {fmt::format("the lamps' mean radiance is {:.3g}, less than the image's single "
                     "precision holds: pixels lose it",
                     radiance)});
  PathOptions options;
  options.spp = samples_per_pixel(request, world->scene());
  options.seed = request.seed;
  options.bidirectional = o.integrator == "bdpt";
  options.progress = &progress;
  Image image = render_path(*world, *caster, options);
  image.metadata["spp"] = fmt::format("{}", options.spp);
  record_substitutions(world->scene(), image, summary);
  summary["spp"] = options.spp;
  summary["scene_hash"] = fmt::format("{:016x}", world->scene().hash);
  return image;
}

void render(const RenderOptions& o) {
  FrameRequest request = o.frame.request();
  if (o.substitute) request.unsupported = Unsupported::kSubstitute;
  const bool path = o.integrator != "photonmap";
  // What would be read, or shows in no path traced image, is refused; what only counts photons is
  // told, for scripts change the integrator alone.
  if (path)
    for (const auto& [option, given] : {std::pair{"--plan", !request.plan_file.empty()},
                                        {"--record", !o.record.empty()},
                                        {"--arithmetic", !o.arithmetic.empty()},
                                        {"--set", !request.set.empty()},
                                        {"--load-photons", !request.load_photons.empty()},
                                        {"--load-caustics", !request.load_caustics.empty()}})
      if (given)
        throw UsageError(
            fmt::format("{}: has no meaning with --integrator {}", option, o.integrator));
  require_suffix("--output", o.output, ".exr");
  if (path)
    for (const std::string& option : o.frame.photon_options())
      print_warnings(
          {fmt::format("{} changes nothing with --integrator {}", option, o.integrator)});
  if (!o.record.empty() && stands_in(o.output, o.record))
    throw UsageError(
        fmt::format("--output: {} is in the folder of --record, which is replaced as a whole; "
                    "expected another folder",
                    o.output));
  o.threads.apply();
  request.outputs = {o.output, png_beside(o.output)};
  check_outputs(request.outputs, frame_inputs(request));

  ConsoleProgress progress;
  Json summary;
  std::string range_counts;
  summary["scene"] = request.scene_file;
  summary["integrator"] = o.integrator;
  Image image = path ? path_trace(o, request, progress, summary)
                     : photon_map(o, request, progress, summary, range_counts);
  if (path) {
    summary["pixels_sha256"] = pixel_sha256(image);
    image.metadata["scene"] = std::filesystem::path(request.scene_file).stem().string();
    image.metadata["sceneHash"] = summary["scene_hash"].get<std::string>();
    image.metadata["seed"] = fmt::format("{}", request.seed);
    image.metadata["integrator"] = o.integrator;
  }
  {
    const ProgressPhase phase(&progress, "write", 0, "");
    write_exr(image, o.output);
    write_png(image, png_beside(o.output), exposure_for(image, o.output));
  }
  if (!o.json) {
    fmt::print("{}", progress.table());
    if (!path) fmt::print("at the ends of ranges: {}\n", range_counts);
    fmt::print("wrote {} and {}\n", o.output, png_beside(o.output));
    return;
  }
  summary["width"] = image.width;
  summary["height"] = image.height;
  summary["seed"] = request.seed;
  summary["threads"] = o.threads.threads();
  summary["output"] = o.output;
  summary["png"] = png_beside(o.output);
  summary["cpu_seconds"] = cpu_seconds();
  summary["phases"] = Json::array();
  for (const PhaseTime& t : progress.times())
    summary["phases"].push_back({{"phase", t.phase},
                                 {"wall", t.wall},
                                 {"cpu", t.cpu},
                                 {"steps", t.steps},
                                 {"unit", t.unit}});
  fmt::print("{}\n", json_text(summary));
}

void add_render(CLI::App& app) {
  auto o = std::make_shared<RenderOptions>();
  CLI::App* c = app.add_subcommand("render", "An image of a scene (EXR and PNG)");
  c->footer(
      "Photon mapping computes the frame of docs/frame.md with golden units: exact integers in "
      "the\n"
      "formats of the plan, the same bytes on every machine. --arithmetic reference answers the\n"
      "same queries in double. --integrator path is the unbiased path tracer; bdpt traces paths "
      "from\n"
      "both ends, several times slower: a check of the path tracer.\n"
      "The EXR has the layers direct, caustic, indirect, emission (their sum is R, G, B), albedo,\n"
      "N, Z, photonDensity and error (standard error of a pixel's mean), and where photons are\n"
      "short: noPhoton, fewPhotons and starvedLight (the part of a pixel's gathers). A warning "
      "says\n"
      "why, and which options mend it (docs/frame.md).\n\n"
      "Examples:\n"
      "  photonloom render scenes/cornell.xml -o cornell.exr\n"
      "  photonloom render scenes/cornell.xml -o path.exr --integrator path --spp 256\n"
      "  photonloom render scenes/cornell.xml -o coarse.exr --set photon.position_bits=12");
  o->frame.add_to(*c);
  c->add_option("-o,--output", o->output, "The EXR to write; a PNG appears beside it")
      ->required()
      ->type_name("FILE.exr");
  c->add_option("--integrator", o->integrator, "photonmap (default), path or bdpt")
      ->check(CLI::IsMember({"photonmap", "path", "bdpt"}))
      ->type_name("NAME");
  c->add_option("--arithmetic", o->arithmetic, "golden (default) or reference")
      ->check(CLI::IsMember({"golden", "reference"}))
      ->type_name("NAME");
  c->add_option("--record", o->record,
                "Write every packet of the frame to this folder, as JSON lines")
      ->type_name("DIR");
  c->add_flag("--substitute", o->substitute,
              "Render scenes with elements that are not supported, with the nearest that is "
              "(docs/materials.md); each is named on screen and in the EXR");
  c->add_flag("--json", o->json, "Print one JSON object: what was rendered, counts, phase times");
  o->threads.add_to(*c);
  c->callback([o] { render(*o); });
}

const Command render_command(11, add_render);

}  // namespace
}  // namespace photonloom
