// SPDX-License-Identifier: Apache-2.0
#include "tests/extremes/suite/suite.hpp"

#include <fmt/core.h>

#include <cmath>

#include "golden/image/pixel_sum.hpp"

namespace photonloom::extremes {

void Run::near(const std::string& what, double due, double golden, double bound) {
  const double error = std::fabs(golden - due);
  add(what, fmt::format("{:.6g}", due), fmt::format("{:.6g}", golden),
      std::isfinite(golden) ? error : HUGE_VAL, bound);
}

void Run::refused(const std::string& words, const std::function<void()>& f) {
  std::string said = "taken";
  try {
    f();
  } catch (const std::exception& error) {
    said = error.what();
  }
  const bool right = said.find(words) != std::string::npos;
  add("error", "\"" + words + "\"", right ? "the same" : said, right ? 0 : 1, 0);
}

void Run::add(const std::string& what, const std::string& due, const std::string& golden,
              double error, double bound) {
  ++checks_;
  const bool right = error <= bound;
  failed_ += !right;
  // How far off: above 1 is wrong.
  const double off = !right ? 2 + error : bound > 0 ? error / bound : 0;
  if (off < worst_ || (off == worst_ && (!showing_ || shows_counter_))) return;
  shows_counter_ = showing_;
  worst_ = off;
  worst_error_ = error;
  worst_bound_ = bound;
  what_ = what;
  due_ = due;
  golden_ = golden;
}

std::string Run::error() const {
  return worst_bound_ > 0 ? fmt::format("{:.2g} of {:.2g}", worst_error_, worst_bound_)
                          : fmt::format("{:.3g}", worst_error_);
}

RunOptions Run::options() const {
  RunOptions options;
  options.work_dir = settings_.work;
  return options;
}

void Run::hardware(const std::function<void()>& f) {
  ran_rtl_ = true;
  try {
    f();
  } catch (const ModelBuildError&) {
    throw;
  } catch (const std::exception& error) {
    differ(error.what());
  }
}

Run::Gathered Run::gather(const Plan& plan, std::span<const PackedPhoton> photons,
                          const std::vector<GatherQuery>& queries) {
  Gathered found;
  found.map = build_photon_map(photons, plan);
  const PhotonMap none = build_photon_map({}, plan);
  const auto golden = make_golden_photon_gatherer(plan);
  golden->load(found.map, none);
  golden->process(queries, found.results, found.photons);
  asked_ = offered_ = true;
  if (settings_.rtl) {
    hardware([&] {
      const auto rtl = make_rtl_photon_gatherer(plan, options());
      rtl->load(found.map, none);
      std::vector<GatherResult> results;
      std::vector<GatherPhoton> list;
      rtl->process(queries, results, list);
      rtl->finish();
      compare(plan, found.results, results);
      compare(plan, found.photons, list);
    });
  }
  return found;
}

Run::Rendered Run::frame(const Scene& scene, const FrameRequest& request, bool rtl,
                         Arithmetic arithmetic) {
  const PreparedFrame frame =
      prepare_frame(std::make_unique<World>(scene), request, arithmetic, nullptr);
  FrameUnits units = make_golden_units(frame.plan);
  Rendered rendered;
  rendered.image = render_frame(frame.input(arithmetic), units, rendered.counts);
  rendered.plan = frame.plan;
  rendered.packed = {frame.global_counts.zeroed + frame.caustic_counts.zeroed,
                     frame.global_counts.saturated + frame.caustic_counts.saturated,
                     frame.global_counts.outside + frame.caustic_counts.outside};
  rendered.photons = frame.global_pass.photons.size();
  rendered.paths = frame.global_pass.paths;
  const auto packets = [](const FrameCounts& c) {
    return c.table_gathers + c.caustic_queries + c.directions + 2 * c.final_gathers +
           c.cache_samples;
  };
  const bool asks = packets(rendered.counts) > 0;
  asked_ |= asks;
  offered_ |= rtl;
  if (rtl && asks && settings_.rtl) {
    hardware([&] {
      FrameUnits hardware_units = make_golden_units(frame.plan);
#define PHOTONLOOM_AS_RTL(Interface, name, ...)       \
  if (unit_info<Interface>.lacks(frame.plan).empty()) \
    hardware_units.name = make_rtl_##name(frame.plan, options());
      PHOTONLOOM_UNITS(PHOTONLOOM_AS_RTL)
#undef PHOTONLOOM_AS_RTL
      FrameCounts counts;
      const Image image = render_frame(frame.input(arithmetic), hardware_units, counts);
      rtl_packets_ += packets(counts);
      for (const auto member : {&FrameCounts::full, &FrameCounts::clamped, &FrameCounts::cache_full,
                                &FrameCounts::unmatched, &FrameCounts::unanswered})
        if (counts.*member != rendered.counts.*member)
          differ("a count of flags or packets is not golden's");
      if (pixel_sha256(image) != pixel_sha256(rendered.image))
        differ("the image is not golden's to the bit");
    });
  }
  return rendered;
}

}  // namespace photonloom::extremes
