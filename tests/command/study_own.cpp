// SPDX-License-Identifier: Apache-2.0
// What photonloom study concludes from study files of the user's own: lines of the base, points of
// other lines, scenes without figures, folders of other studies.
#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using photonloom::test::Outcome;
using photonloom::test::run;
using photonloom::test::Scratch;

namespace {

std::string box_scene() { return photonloom::test::source("scenes/cornell.xml"); }

// A study of 8 x 8 pixels with few photons; `list` is of points.
void write_own(const Scratch& s, const std::string& name, const std::string& measures,
               const std::string& base, const std::string& list,
               const std::string& scene = box_scene()) {
  write_file(s / (name + ".toml"),
             fmt::format("[study]\nname = \"{}\"\nscenes = [\"{}\"]\nseeds = [1]\nsize = \"8x8\"\n"
                         "measure = [{}]\n[references]\nspp = 2\n[gather]\nqueries = 16\n[base]\n"
                         "photons = 500\ncaustic_photons = 100\nframe.spp = 1\n{}\n[[points]]\n"
                         "strategy = \"list\"\nlines = [{}]\n",
                         name, scene, measures, base, list));
}

Outcome own_study(const Scratch& s, const std::string& name, const std::string& file,
                  const std::string& folder = "out") {
  return run(fmt::format("study {} --study '{}' -o '{}'", name, s / (file + ".toml"), s / folder));
}

// The page of a study that ended well.
std::string own_page(const Scratch& s, const std::string& name, const std::string& file) {
  const Outcome o = own_study(s, name, file);
  INFO(o.err);
  REQUIRE(o.status == 0);
  return read_file(s / ("out/" + name + ".md"));
}

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// A rectangle that shines: no surface holds photons.
std::string lamp_scene(const Scratch& s) {
  write_file(s / "lamp.xml",
             "<scene version=\"0.6.0\"><integrator type=\"path\"/><sensor type=\"perspective\">"
             "<float name=\"fov\" value=\"40\"/><transform name=\"toWorld\"><lookat "
             "origin=\"0, 0, 4\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform><film "
             "type=\"hdrfilm\"><integer name=\"width\" value=\"8\"/><integer name=\"height\" "
             "value=\"8\"/><rfilter type=\"box\"/></film></sensor><shape type=\"rectangle\">"
             "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0, 0, 0\"/></bsdf>"
             "<emitter type=\"area\"><rgb name=\"radiance\" value=\"1, 1, 1\"/></emitter></shape>"
             "</scene>");
  return s / "lamp.xml";
}

}  // namespace

TEST_CASE("study system takes rays and ports from base and plan") {
  const Scratch s;
  write_own(s, "system", "\"gather\", \"resources\"", "frame.gather_rays = 4\ngather.k = 8",
            "{ gatherer.nodes_per_cycle = 1 }, { gatherer.contexts = 32 }");
  const std::string text = own_page(s, "system", "system");
  CHECK(says(text, "| 8 | one a cycle |"));
  CHECK(says(text, "| 8 | one a cycle, gatherer.contexts 32 |"));
  CHECK_FALSE(says(text, "wide"));
  const auto points = nlohmann::json::parse(read_file(s / "out/summary.json")).at("points");
  const double bytes = points[1].at("values").at("gather.bytes").at("mean");
  CHECK(says(text, fmt::format("| {:.0f} | {:.1f} |", bytes, 385e6 * (1 + 1.0 / 4) * bytes / 1e9)));
}

TEST_CASE("study sampling takes rays from the base") {
  const Scratch s;
  write_own(s, "sampling_means", "\"ray_means\"", "frame.gather_rays = 2\ngather.k = 8",
            "{ sampler.levels = 1 }, { sampler.combine = \"cosine\" }");
  const std::string text = own_page(s, "sampling", "sampling_means");
  CHECK(says(text, "| cornell | sum | 1 | all | 2 |"));
  // No section of a file that was not asked for.
  CHECK_FALSE(says(text, "seeds none"));
}

TEST_CASE("study caching says what it measured, and what a part lacks") {
  const Scratch s;
  const std::string base = "frame.gather_rays = 2\ngather.k = 8\ncache.present = true";
  write_own(s, "caching", "\"caching\"", base,
            "{ frame.tile = 8 }, { frame.tile = 4 }, { cache.accuracy = 0.2 }");
  const std::string text = own_page(s, "caching", "caching");
  CHECK(says(text, "8 × 8, 2 rays a sample:"));
  CHECK(says(text, "| 0.1, frame.tile 8 |"));
  CHECK(says(text, "| 0.1, frame.tile 4 |"));
  CHECK_FALSE(says(text, "256 × 256"));
  CHECK_FALSE(says(read_file(s / "out/caching_cornell.gp"), "256"));
  write_own(s, "caching_converged", "\"caching\", \"visible\"", base, "{ cache.accuracy = 0.2 }");
  const Outcome o = own_study(s, "caching", "caching_converged", "converged");
  INFO(o.err);
  CHECK(o.status == 1);
  CHECK(says(o.err, "expected one with cache.present = false"));
}

TEST_CASE("study reordering and layouts name points by all lines that they differ in") {
  const Scratch s;
  write_own(s, "reordering", "\"traffic\"",
            "frame.gather_rays = 2\ngather.k = 8\nframe.tile = 8\nframe.order = \"tile\"\n"
            "reorder.key = \"hilbert\"\nreorder.drain = \"sweep\"\nreorder.packets = 128\n"
            "gatherer.cache_bytes = 131072",
            "{ reorder.bins = 64 }, { reorder.bins = 256 }");
  const std::string text = own_page(s, "reordering", "reordering");
  for (const char* bins : {"64", "256"})
    CHECK(says(text, fmt::format("| tile of 8 × 8, Hilbert bins, sweep, reorder.bins {} |", bins)));
  write_own(s, "layouts", "\"layouts\"", "frame.gather_rays = 2\ngather.k = 8",
            "{ gatherer.cache_bytes = 4096 }, { gatherer.cache_bytes = 16384 }");
  const Outcome o = own_study(s, "layouts", "layouts", "layouts");
  INFO(o.err);
  REQUIRE(o.status == 0);
  for (const char* bytes : {"4096", "16384"}) {
    CHECK(says(o.out, fmt::format("k = 8, gatherer.cache_bytes {}: compressed", bytes)));
    CHECK(says(read_file(s / "layouts/layouts.md"),
               fmt::format("| k = 8, gatherer.cache_bytes {} |", bytes)));
  }
}

TEST_CASE("a scene without figures is left out by name, and alone makes no page") {
  const Scratch s;
  struct Case {
    const char *study, *file, *measures, *base, *list;
  };
  for (const Case& c :
       {Case{"layouts", "layouts", "\"layouts\"", "", "{ gather.k = 8 }"},
        Case{"caching", "caching", "\"caching\"", "cache.present = true",
             "{ cache.accuracy = 0.2 }"},
        Case{"system", "system", "\"gather\", \"resources\"", "", "{ gather.k = 8 }"},
        Case{"sampling", "sampling", "\"noise\"", "", "{ sampler.combine = \"cosine\" }"},
        Case{"reordering", "reordering", "\"traffic\"", "", "{ gather.k = 8 }"}}) {
    const std::string base = fmt::format("frame.gather_rays = 2\n{}", c.base);
    write_own(s, c.file, c.measures, base, c.list, lamp_scene(s));
    const std::string folder = std::string(c.file) + "_lamp";
    const Outcome alone = own_study(s, c.study, c.file, folder);
    INFO(c.study << "\n" << alone.out << alone.err);
    CHECK(alone.status == 1);
    CHECK(says(alone.err, "is not written"));
    CHECK(says(alone.err, "scene lamp: all 1 points are left out"));
    CHECK_FALSE(says(alone.out + alone.err, "nan"));
    CHECK_FALSE(says(alone.err, "gnuplot"));
    CHECK_FALSE(std::filesystem::exists(s / (folder + "/" + c.study + ".md")));
  }
  write_own(s, "layouts", "\"layouts\"", "frame.gather_rays = 2", "{ gather.k = 8 }",
            lamp_scene(s) + "\", \"" + box_scene());
  const std::string text = own_page(s, "layouts", "layouts");
  CHECK(says(text, "### cornell"));
  CHECK_FALSE(says(text, "### lamp"));
  CHECK(says(text, "- study layouts, scene lamp: all 1 points are left out, layouts.plain has no"));
}

TEST_CASE("a study refuses a folder with another study's page") {
  const Scratch s;
  write_own(s, "layouts", "\"layouts\", \"traffic\"", "frame.gather_rays = 2", "{ gather.k = 8 }");
  own_page(s, "layouts", "layouts");
  const Outcome o = own_study(s, "reordering", "layouts");
  CHECK(o.status == 1);
  CHECK(o.one_error_line());
  CHECK(says(o.err, "out/layouts.md: is the page of study layouts, expected a new folder"));
  CHECK_FALSE(std::filesystem::exists(s / "out/reordering.md"));
}

TEST_CASE("where all points failed a study says so, not that points are missing") {
  const Scratch s;
  write_own(s, "layouts", "\"layouts\"", "frame.gather_rays = 2", "{ gather.k = 8 }",
            s / "none.xml");
  write_file(s / "none.xml", "<scene");
  const Outcome o = own_study(s, "layouts", "layouts");
  INFO(o.err);
  CHECK(o.status == 1);
  CHECK(says(o.err, "of scenes and points failed; what they said stands above"));
  CHECK(says(o.err, "layouts.md is not written"));
  CHECK_FALSE(says(o.err, "[[points]]"));
}
