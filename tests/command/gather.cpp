// SPDX-License-Identifier: Apache-2.0
// photonloom photons and gather as a stranger would check them: from the files alone.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "golden/plan/plan_file.hpp"
#include "golden/scene/scene.hpp"
#include "golden/unit/photon_file.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using nlohmann::json;
using photonloom::test::Outcome;
using photonloom::test::run;
using photonloom::test::Scratch;
using photonloom::test::source;

namespace {

std::vector<json> lines_of(const std::string& path) {
  std::istringstream in(read_file(path));
  std::vector<json> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(json::parse(line));
  return lines;
}

// Queries at every 97th photon, lifted off it a little, with a fixed normal.
std::string query_text(const std::vector<Photon>& photons) {
  std::ostringstream out;
  out.precision(17);
  std::vector<const Photon*> at;
  for (size_t i = 0; i < photons.size(); i += 97) at.push_back(&photons[i]);
  out << "ply\nformat ascii 1.0\nelement vertex " << at.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\nproperty "
         "float ny\nproperty float nz\nend_header\n";
  for (const Photon* p : at)
    out << p->position.x * 0.999 << ' ' << p->position.y * 0.999 << ' ' << p->position.z * 0.999
        << " 0.3 0.2 -0.9\n";
  return out.str();
}

}  // namespace

TEST_CASE("photons writes the map that it says, equal for equal seeds") {
  const Scratch s;
  const std::string scene = source("scenes/cornell_balls.xml");
  const Outcome first = run("photons " + scene + " --photons 3000 --json -o " + s / "a.ply");
  INFO(first.err);
  REQUIRE(first.status == 0);
  const json report = json::parse(first.out);
  REQUIRE(run("photons " + scene + " --photons 3000 --threads 1 -o " + s / "b.ply").status == 0);
  REQUIRE(read_file(s / "a.ply") == read_file(s / "b.ply"));
  REQUIRE(run("photons " + scene + " --photons 3000 --seed 2 -o " + s / "c.ply").status == 0);
  REQUIRE(read_file(s / "a.ply") != read_file(s / "c.ply"));
  REQUIRE(run("photons " + scene + " --photons 500 --caustic -o " + s / "d.ply").status == 0);

  const PhotonFile global = read_photon_file(s / "a.ply"), caustic = read_photon_file(s / "d.ply");
  REQUIRE(global.kind == "global");
  REQUIRE(caustic.kind == "caustic");
  REQUIRE(global.photons.size() >= 3000);
  REQUIRE(report["photons"] == global.photons.size());
  REQUIRE(report["paths_emitted"] == *global.paths);
  REQUIRE(global.scene_hash == load_scene(scene).hash);
  Rgb power(0);
  for (const Photon& p : global.photons) power += p.power;
  REQUIRE(power.y != power.z);
  for (int c = 0; c < 3; ++c)
    REQUIRE(report["power"][static_cast<size_t>(c)].get<double>() == Approx(power[c]));
  for (const Photon& p : global.photons) REQUIRE(holds(*global.cube, p.position));
  for (const Photon& p : caustic.photons) REQUIRE(p.bounce > 0);
}

TEST_CASE("gather answers what its help says, in both arithmetics") {
  const Scratch s;
  REQUIRE(
      run("photons " + source("scenes/cornell_balls.xml") + " --photons 2000 -o " + s / "map.ply")
          .status == 0);
  const PhotonFile file = read_photon_file(s / "map.ply");
  write_file(s / "q.ply", query_text(file.photons));
  const std::vector<QueryPoint> queries = read_query_file(s / "q.ply");
  const double extent = file.cube->extent, unit = extent / 65536;
  const std::string files = "gather --photons " + s / "map.ply" + " --queries " + s / "q.ply";
  for (const char* options : {" --k 7", " --k 40 --radius 0.15"}) {
    INFO(options);
    const bool bounded = std::string(options).find("radius") != std::string::npos;
    const size_t k = bounded ? 40 : 7;
    const Outcome golden = run(files + options + " -o " + s / "golden.jsonl");
    INFO(golden.err);
    REQUIRE(golden.status == 0);
    REQUIRE(run(files + options + " --arithmetic reference -o " + s / "reference.jsonl").status ==
            0);
    REQUIRE(run(files + options + " --arithmetic reference --kernel epanechnikov -o " +
                s / "epanechnikov.jsonl")
                .status == 0);
    const auto g = lines_of(s / "golden.jsonl"), r = lines_of(s / "reference.jsonl"),
               e = lines_of(s / "epanechnikov.jsonl");
    REQUIRE(g.size() == queries.size());
    REQUIRE(r.size() == queries.size());
    REQUIRE(e.size() == queries.size());
    for (size_t i = 0; i < queries.size(); ++i) {
      INFO("query " << i);
      // The reference from scratch.
      std::vector<std::pair<double, size_t>> near;
      for (size_t p = 0; p < file.photons.size(); ++p) {
        const Vec3 d = file.photons[p].position - queries[i].position;
        const double d2 = glm::dot(d, d);
        if (glm::dot(file.photons[p].direction, queries[i].normal) > 0 &&
            (!bounded || d2 <= 0.15 * 0.15))
          near.emplace_back(d2, p);
      }
      std::sort(near.begin(), near.end());
      if (near.size() > k) near.resize(k);
      REQUIRE(r[i]["count"] == near.size());
      REQUIRE(r[i]["full"] == (near.size() == k));
      Rgb flux(0);
      for (size_t j = 0; j < near.size(); ++j) {
        REQUIRE(r[i]["photons"][j] == near[j].second);
        flux += file.photons[near[j].second].power;
      }
      REQUIRE(r[i]["flux"][1].get<double>() == Approx(flux.y));
      const double r2 = near.size() == k ? near.back().first : 0.15 * 0.15;
      REQUIRE(r[i]["r2_scene"].get<double>() == Approx(r2));
      const double c = near.size() == k ? (static_cast<double>(k) - 1) / static_cast<double>(k) : 1;
      REQUIRE(r[i]["irradiance"][0].get<double>() ==
              Approx(flux.x * c / (M_PI * r2)).margin(1e-300));
      Rgb weighted(0);
      for (const auto& [d2, p] : near) weighted += file.photons[p].power * (2 * (1 - d2 / r2));
      for (int channel = 0; channel < 3; ++channel)
        REQUIRE(e[i]["irradiance"][static_cast<size_t>(channel)].get<double>() ==
                Approx(weighted[channel] / (M_PI * r2)).margin(1e-300));

      // Golden: distances of the photons it names, in its units, from the files alone.
      REQUIRE(g[i]["query"] == i);
      const size_t count = g[i]["count"];
      REQUIRE(g[i]["photons"].size() == count);
      const auto quantise = [&](const Vec3& x, int axis) {
        return static_cast<int64_t>(
            std::floor((x[axis] - file.cube->origin[axis]) * (65536 / extent)));
      };
      Rgb golden_flux(0);
      for (size_t j = 0; j < count; ++j) {
        const Photon& photon = file.photons[g[i]["photons"][j]];
        golden_flux += photon.power;
        int64_t d2 = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const int64_t d = quantise(photon.position, axis) - quantise(queries[i].position, axis);
          d2 += d * d;
        }
        REQUIRE(g[i]["d2"][j] == d2);
        if (j > 0) REQUIRE(g[i]["d2"][j - 1] <= d2);
      }
      // Nine bits of mantissa: a photon is off by at most 2^-9 of its largest channel.
      for (int channel = 0; channel < 3; ++channel)
        REQUIRE(std::fabs(g[i]["flux"][static_cast<size_t>(channel)].get<double>() -
                          golden_flux[channel]) <= std::ldexp(max_component(golden_flux) * 3, -9));
      if (g[i]["full"]) REQUIRE(g[i]["r2"] == g[i]["d2"].back());
      REQUIRE(g[i]["r2_scene"].get<double>() == Approx(g[i]["r2"].get<double>() * unit * unit));
      REQUIRE(g[i]["full"] == (count == k));
      const double golden_c = count == k ? 1 - 1 / static_cast<double>(k) : 1;
      const double divisor =
          M_PI * std::max(g[i]["r2"].get<double>(), static_cast<double>(Plan{}.r2_floor)) * unit *
          unit;
      for (size_t channel = 0; channel < 3; ++channel)
        REQUIRE(g[i]["irradiance"][channel].get<double>() ==
                Approx(g[i]["flux"][channel].get<double>() * golden_c / divisor).margin(1e-300));
    }
  }
}

TEST_CASE("gather gives photons of one channel their colour back, and counts what it rounds") {
  const Scratch s;
  PhotonFile file;
  const auto gathers = [&](const std::string& more) {
    write_photon_file(file, s / "p.ply");
    write_file(s / "q.ply",
               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
               "y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
               "nz\nend_header\n0 0 0 0 0 1\n");
    const Outcome o = run("gather --k 9 --radius 1 --photons " + s / "p.ply" + " --queries " +
                          s / "q.ply" + " " + more + " -o " + s / "out");
    INFO(o.err);
    REQUIRE(o.status == 0);
    return o.err;
  };
  const auto photons = [&](const std::vector<Rgb>& powers) {
    file.photons.clear();
    for (const Rgb& power : powers)
      file.photons.push_back({Vec3(0.1 * static_cast<double>(file.photons.size()), 0, 0),
                              Vec3(0, 0, 1), power, file.photons.size(), 1});
  };
  // Powers that a mantissa of nine bits holds exactly.
  const Rgb colour(0.25, 1, 0.5);
  photons({colour * 8.0, colour * 2.0});
  gathers("--set photon.channels=1 --set 'photon.channel_color=[0.25, 1, 0.5]'");
  const json one = lines_of(s / "out")[0];
  REQUIRE(one["count"] == 2);
  CHECK(one["flux_units"].size() == 1);
  gathers("");
  const json three = lines_of(s / "out")[0];
  CHECK(three["flux_units"].size() == 3);
  for (const json& answer : {one, three})
    for (int c = 0; c < 3; ++c)
      CHECK(answer["flux"][static_cast<size_t>(c)].get<double>() == colour[c] * (8.0 + 2.0));

  // A plan's power unit, for photons far below it and one far above its largest code.
  const std::string scene = source("scenes/cornell_balls.xml");
  REQUIRE(
      run("plan " + scene + " --photons 200 --caustic-photons 100 -o " + s / "plan.toml").status ==
      0);
  const Plan plan = read_plan(s / "plan.toml");
  const double unit = std::ldexp(1.0, plan.global.power_exponent);
  photons({Rgb(unit * 0x1p-9), Rgb(0), Rgb(unit * 0x1p9), Rgb(unit * 0x1p-7), Rgb(unit * 0x1p50)});
  CHECK_THAT(gathers("--plan " + s / "plan.toml"),
             ContainsSubstring("; 2 photons became zero, 1 saturated\n"));
}

TEST_CASE("integers wider than 53 bits leave as decimal strings") {
  const Scratch s;
  write_file(s / "p.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
             "y\nproperty float z\nproperty float dx\nproperty float dy\nproperty float "
             "dz\nproperty float power_r\nproperty float power_g\nproperty float "
             "power_b\nend_header\n0 0 0 0 0 1 1 1 1\n");
  write_file(s / "q.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
             "y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
             "nz\nend_header\n1 1 1 0 0 1\n");
  const std::string files = "gather --photons " + s / "p.ply" + " --queries " + s / "q.ply";
  REQUIRE(run(files + " --k 200 --set photon.mantissa_bits=16 -o " + s / "out").status == 0);
  REQUIRE(lines_of(s / "out")[0]["flux_units"][0].is_string());
  REQUIRE(run(files + " --k 1 --set photon.mantissa_bits=9 -o " + s / "out").status == 0);
  REQUIRE(lines_of(s / "out")[0]["flux_units"][0].is_number_unsigned());
}

TEST_CASE("gather and photons refuse what they cannot do, in one line") {
  const Scratch s;
  write_file(s / "q.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
             "y\nproperty float z\nend_header\n1 1 1\n");
  const std::string scene = source("scenes/cornell.xml");
  struct Case {
    std::string arguments;
    int status;
  };
  for (const Case& c : {
           Case{"gather --photons " + s / "none.ply --queries none.ply -o " + s / "o", 1},
           Case{"gather --photons " + s / "q.ply" + " --queries " + s / "q.ply" + " -o " + s / "o",
                1},
           Case{"gather --photons " + s / "q.ply" + " --queries " + s / "q.ply" +
                    " --set gather.k=3 -o " + s / "o",
                2},
           Case{"gather --photons " + s / "q.ply" + " --queries " + s / "q.ply" +
                    " --kernel epanechnikov -o " + s / "o",
                2},
           Case{"photons " + scene + " --caustic --photons 10 -o " + s / "o.ply", 1},
           Case{"photons " + scene + " --photons 10 -D novalue -o " + s / "o.ply", 2},
           Case{"photons " + scene + " --photons 10 -o " + s / "no/such/folder/o.ply", 1},
       }) {
    INFO(c.arguments);
    const Outcome o = run(c.arguments);
    INFO(o.err);
    CHECK(o.status == c.status);
    CHECK(o.one_error_line());
  }
  for (const char* line :
       {"global.photons=3", "global.present=false", "caustic.photons=3", "frame.width=8",
        "pixel.integer_bits=9", "gather.k=3", "scene.extent=2", "global.power_exponent=-9",
        "photon.mantissa_bits=9 --set photon.mantissa_bits=8"}) {
    const Outcome o = run("gather --photons " + s / "q.ply" + " --queries " + s / "q.ply" +
                          " --set " + line + " -o " + s / "o");
    INFO(line << ": " << o.err);
    CHECK(o.status == 2);
    CHECK(o.one_error_line());
    CHECK(o.err.starts_with("photonloom: --set "));
  }
  for (const char* line : {"gather.leaf_limit=1", "photon.mantissa_bits=4"}) {
    const Outcome o = run("gather --photons " + s / "q.ply" + " --queries " + s / "q.ply" +
                          " --arithmetic reference --set " + line + " -o " + s / "o");
    CHECK(o.status == 2);
    CHECK(o.err.find("has no effect on a gather with --arithmetic reference") != std::string::npos);
  }
  CHECK(run("gather --k 0 --photons a --queries b -o c").status == 2);
  CHECK(run("photons " + scene + " --photons 0 -o c").status == 2);
  CHECK(s.entries() == 1);
}

TEST_CASE("gather refuses lines that no plan may have, other colours and powers without end") {
  const Scratch s;
  const auto photons = [&](const std::string& power) {
    std::string text = "ply\nformat ascii 1.0\nelement vertex 1\n";
    for (const char* name :
         {"x", "y", "z", "dx", "dy", "dz", "power_r", "power_g", "power_b", "nx", "ny", "nz"})
      text += fmt::format("property double {}\n", name);
    write_file(s / "p.ply", text + "end_header\n0 0 0 0 0 1 " + power + " 0 0 1\n");
  };
  const auto gathers = [&](const std::string& more) {
    return run("gather --k 1 --photons " + s / "p.ply" + " --queries " + s / "p.ply" + " -o " +
               s / "out" + " " + more);
  };
  photons("1 2 3");
  const auto refused = [&](const std::string& more, const std::string& said) {
    const Outcome o = gathers(more);
    INFO(more << ": " << o.err);
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    CHECK_THAT(o.err, ContainsSubstring(said));
  };
  refused("--set gatherer.candidates_per_cycle=3",
          "--set: gatherer.candidates_per_cycle is 3, expected");
  refused("--set photon.channels=1", "photon.channels is 1, but photons of " + s / "p.ply");
  CHECK(gathers("--set photon.mantissa_bits=8").status == 0);
  CHECK(gathers("--set photon.channels=1 --arithmetic reference").status == 2);  // it reads none
  CHECK(gathers("--set photon.position_bits=20 --arithmetic reference").status == 0);
  photons("2 2 2");
  CHECK(gathers("--set photon.channels=1").status == 0);
  photons("1 1.797e308 1");
  refused("", "p.ply: vertex 0: power_g is 1.797e+308, expected at most 1e+100");
  photons("1e50 1e50 1e50");
  const Outcome o = run("plan " + source("scenes/cornell.xml") + " --load-photons " + s / "p.ply" +
                        " --size 4x4 --spp 1 -o " + s / "p.toml");
  CHECK(o.status == 1);
  CHECK_THAT(o.err, ContainsSubstring("p.ply: pixel.integer_bits has no value"));
}

TEST_CASE("gather refuses points so far apart, or so close, that squares of distances are lost") {
  const Scratch s;
  const auto points = [&](const std::string& names, const std::string& low,
                          const std::string& high) {
    std::string text = "ply\nformat ascii 1.0\nelement vertex 2\n";
    std::istringstream words(names);
    for (std::string name; words >> name;) text += "property double " + name + "\n";
    return text + "end_header\n" + low + "\n" + high + "\n";
  };
  const auto gathers = [&](double width) {
    const std::string x = fmt::format(" {} 0 0 ", width);
    write_file(s / "p.ply",
               points("x y z dx dy dz power_r power_g power_b",
                      fmt::format(" {} 0 0 0 0 1 1 1 1", -width / 2), x + "0 0 1 1 1 1"));
    write_file(s / "q.ply", points("x y z nx ny nz", "0 0 0 0 0 1", x + "0 0 1"));
    return run("gather --k 1 --photons " + s / "p.ply" + " --queries " + s / "q.ply" + " -o " +
               s / "out");
  };
  for (const double width : {1.5e308, 1e151, 1e-150}) {
    const Outcome o = gathers(width);
    INFO(width << ": " << o.err);
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    CHECK_THAT(o.err, ContainsSubstring("so that squares stay finite"));
  }
  for (const double width : {1e149, 1e-139}) {
    const Outcome o = gathers(width);
    INFO(width << ": " << o.err);
    CHECK(o.status == 0);
  }
}
