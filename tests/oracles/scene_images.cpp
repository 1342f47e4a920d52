// SPDX-License-Identifier: Apache-2.0
// What scene files mean, seen in images: a small file for each statement, rendered by the path
// tracer, against its closed form.
#include <array>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/transport/path.hpp"
#include "tests/catch.hpp"
#include "tests/scene_files.hpp"

using namespace photonloom;

namespace {

struct Rendered {
  Image image;
  Rgb at(int x, int y, const std::string& layer = "") const {
    Rgb out;
    const char* const names[] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
      const std::string name = layer.empty() ? names[c] : layer + "." + names[c];
      const Channel* channel = image.find(name);
      REQUIRE(channel);
      out[c] = static_cast<double>(
          channel->pixels[static_cast<size_t>(y) * static_cast<size_t>(image.width) +
                          static_cast<size_t>(x)]);
    }
    return out;
  }
};

Rendered render(const std::string& text, int spp = 4) {
  const TestFolder folder;
  const World world(load_scene(folder.write("scene.xml", text)));
  PathOptions options;
  options.spp = spp;
  return {render_path(world, *make_double_bvh(world), options)};
}

std::string sensor(const std::string& lookat, double fov, int width, int height,
                   const std::string& more = "") {
  return "<sensor type=\"perspective\"><float name=\"fov\" value=\"" + std::to_string(fov) +
         "\"/>" + more + "<transform name=\"toWorld\"><lookat " + lookat +
         "/></transform><film type=\"hdrfilm\"><integer name=\"width\" value=\"" +
         std::to_string(width) + "\"/><integer name=\"height\" value=\"" + std::to_string(height) +
         "\"/><rfilter type=\"box\"/></film></sensor>";
}

std::string emitter(const std::string& rgb) {
  return "<emitter type=\"area\"><rgb name=\"radiance\" value=\"" + rgb + "\"/></emitter>";
}

// What a narrow camera at `origin` sees at `target`.
Rgb probe(const std::string& body, const std::string& origin, const std::string& target,
          const std::string& version = "0.6.0", const std::string& up = "0.1, 0.2, 0.3") {
  return render(scene_text(body + sensor("origin=\"" + origin + "\" target=\"" + target +
                                             "\" up=\"" + up + "\"",
                                         0.01, 1, 1),
                           version))
      .at(0, 0);
}

std::string rectangle(const std::string& steps, const std::string& inside) {
  return "<shape type=\"rectangle\"><transform name=\"toWorld\">" + steps + "</transform>" +
         inside + "</shape>";
}

constexpr const char* kPoint =
    "<emitter type=\"point\"><point name=\"position\" x=\"0\" y=\"0\" z=\"2\"/>"
    "<rgb name=\"intensity\" value=\"8\"/></emitter>";
const std::string kDim = "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.25\"/></bsdf>";

}  // namespace

TEST_CASE("a lookat image is not mirrored, pixel (0,0) is top left") {
  const auto ball = [](const std::string& at, const std::string& rgb) {
    return "<shape type=\"sphere\"><point name=\"center\" value=\"" + at +
           "\"/><float name=\"radius\" value=\"0.3\"/>" + emitter(rgb) + "</shape>";
  };
  const Rendered r =
      render(scene_text(ball("1 1 0", "1 0 0") + ball("-1 1 0", "0 1 0") + ball("1 -1 0", "0 0 1") +
                        sensor("origin=\"0,0,5\" target=\"0,0,0\" up=\"0,1,0\"", 40, 8, 8)));
  // One unit is 0.549 of the half width: pixels 6.2 and 1.8.
  CHECK(r.at(6, 1).x > 0.3);
  CHECK(r.at(1, 1).y > 0.3);
  CHECK(r.at(6, 6).z > 0.3);
  CHECK(r.at(1, 6) == Rgb(0));
  CHECK(r.at(6, 1).y == 0);
}

TEST_CASE("fovAxis: x by default, y, diagonal, smaller, larger") {
  // A square of half width 1/4 at distance 1, 90 degrees, 40 x 20 pixels: the lit parts of the
  // middle row and column are 40 / (4 tan_x) and 20 / (4 tan_y) pixels, tan_x = 2 tan_y.
  const double diagonal = 2 / std::sqrt(5.0);
  for (const auto& [axis, tan_x] :
       {std::pair("", 1.0), std::pair("x", 1.0), std::pair("y", 2.0),
        std::pair("diagonal", diagonal), std::pair("smaller", 2.0), std::pair("larger", 1.0)}) {
    INFO("axis " << axis);
    const std::string property =
        *axis ? std::string("<string name=\"fovAxis\" value=\"") + axis + "\"/>" : "";
    const Rendered r = render(
        scene_text(rectangle("<scale value=\"0.25\"/>", emitter("1")) +
                   sensor("origin=\"0,0,1\" target=\"0,0,0\" up=\"0,1,0\"", 90, 40, 20, property)),
        64);
    double row = 0, column = 0;
    for (int x = 0; x < 40; ++x) row += r.at(x, 10).x;
    for (int y = 0; y < 20; ++y) column += r.at(20, y).x;
    // Two edge pixels at most are partly lit, with 64 samples.
    CHECK(row == Approx(10 / tan_x).margin(0.25));
    CHECK(column == Approx(10 / tan_x).margin(0.25));
  }
}

TEST_CASE("clipping planes cut where they are given, along the viewing direction") {
  const std::string body = rectangle("", emitter("1"));
  const auto seen = [&](const std::string& clip) {
    return render(scene_text(body + sensor("origin=\"0,0,2\" target=\"0,0,0\" up=\"0,1,0\"", 40, 3,
                                           3, clip)))
        .at(0, 0)
        .x;
  };
  CHECK(seen("") == 1);
  CHECK(seen("<float name=\"nearClip\" value=\"1.99\"/>") == 1);
  CHECK(seen("<float name=\"nearClip\" value=\"2.01\"/>") == 0);
  CHECK(seen("<float name=\"farClip\" value=\"2.01\"/>") == 1);
  CHECK(seen("<float name=\"farClip\" value=\"1.99\"/>") == 0);
}

TEST_CASE("a file's area emitters radiate from the normal side only") {
  const std::string far = "<emitter type=\"point\"/>";  // so that there is light in any case
  for (const char* type : {"rectangle", "disk"}) {
    INFO(type);
    const auto shape = [&](const std::string& more) {
      return std::string("<shape type=\"") + type + "\">" + more + emitter("1 2 3") + "</shape>" +
             far;
    };
    CHECK(probe(shape(""), "0.1,0.1,3", "0.1,0.1,0") == Rgb(1, 2, 3));
    CHECK(probe(shape(""), "0.1,0.1,-3", "0.1,0.1,0") == Rgb(0));
    const std::string flip = "<boolean name=\"flipNormals\" value=\"true\"/>";
    CHECK(probe(shape(flip), "0.1,0.1,3", "0.1,0.1,0") == Rgb(0));
    CHECK(probe(shape(flip), "0.1,0.1,-3", "0.1,0.1,0") == Rgb(1, 2, 3));
    const std::string both =
        "<bsdf type=\"twosided\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" "
        "value=\"0\"/></bsdf></bsdf>";
    CHECK(probe(shape(both), "0.1,0.1,-3", "0.1,0.1,0") == Rgb(0));
  }
  for (const char* type : {"sphere", "cube"}) {
    INFO(type);
    const auto shape = [&](const std::string& flip) {
      return std::string("<shape type=\"") + type + "\"><boolean name=\"flipNormals\" value=\"" +
             flip + "\"/>" + emitter("1") + "</shape>" + far;
    };
    CHECK(probe(shape("false"), "0,0,3", "0,0,0") == Rgb(1));
    CHECK(probe(shape("false"), "0,0,0", "0,0,1") == Rgb(0));
    CHECK(probe(shape("true"), "0,0,3", "0,0,0") == Rgb(0));
    CHECK(probe(shape("true"), "0,0,0", "0,0,1") == Rgb(1));
  }
}

TEST_CASE("point light: intensity over distance squared; diffuse is black from behind") {
  // L = rho / pi I / d^2 = 0.25 / pi * 8 / 4.
  const double front = 0.5 / kPi;
  CHECK(probe(rectangle("", kDim) + kPoint, "0,0,1", "0,0,0").x == Approx(front).epsilon(1e-4));
  CHECK(probe(rectangle("", "") + kPoint, "0,0,1", "0,0,0").x == Approx(2 * front).epsilon(1e-4));
  const std::string turn = "<rotate y=\"1\" angle=\"180\"/>";
  CHECK(probe(rectangle(turn, kDim) + kPoint, "0,0,1", "0,0,0") == Rgb(0));
  CHECK(probe(rectangle(turn, "<bsdf type=\"twosided\">" + kDim + "</bsdf>") + kPoint, "0,0,1",
              "0,0,0")
            .x == Approx(front).epsilon(1e-4));
  CHECK(probe(rectangle(turn, "<bsdf type=\"twosided\"><bsdf type=\"phong\"/>" + kDim + "</bsdf>") +
                  kPoint,
              "0,0,1", "0,0,0")
            .x == Approx(front).epsilon(1e-4));
}

TEST_CASE("spot: along +z, constant to beamWidth, linear in angle to cutoffAngle") {
  // A diffuse square facing the spot at distance 3, seen from the spot: L = rho / pi I f / d^2.
  for (const auto& [degrees, factor] :
       {std::pair(0.0, 1.0), std::pair(14.0, 1.0), std::pair(17.5, 0.5), std::pair(19.0, 0.2),
        std::pair(21.0, 0.0)}) {
    INFO(degrees << " degrees");
    const std::string turn = "<rotate y=\"1\" angle=\"" + std::to_string(degrees) + "\"/>";
    const std::string body =
        rectangle("<rotate y=\"1\" angle=\"180\"/><translate z=\"3\"/>" + turn, "") +
        "<emitter type=\"spot\"><rgb name=\"intensity\" value=\"2\"/></emitter>";
    const std::string camera =
        "<sensor type=\"perspective\"><float name=\"fov\" value=\"0.01\"/><transform "
        "name=\"toWorld\">" +
        turn +
        "</transform><film type=\"hdrfilm\"><integer name=\"width\" value=\"1\"/><integer "
        "name=\"height\" value=\"1\"/><rfilter type=\"box\"/></film></sensor>";
    CHECK(render(scene_text(body + camera)).at(0, 0).x ==
          Approx(0.5 / kPi * 2 * factor / 9).epsilon(1e-3).margin(1e-12));
  }
}

TEST_CASE("directional: irradiance across the beam") {
  // 60 degrees off the normal: E cos = 3 / 2.
  const std::string body =
      rectangle("", "") +
      "<emitter type=\"directional\"><vector name=\"direction\" x=\"0\" "
      "y=\"1.7320508075688772\" z=\"-1\"/><rgb name=\"irradiance\" value=\"3\"/>"
      "</emitter>";
  CHECK(probe(body, "0,0,1", "0,0,0").x == Approx(0.5 / kPi * 1.5).epsilon(1e-4));
}

TEST_CASE("conductor at normal incidence: Cu in 0.x files, an ideal mirror in 3.x") {
  // A lamp at z = 4 facing down, seen in a mirror at z = 0 from z = 1.
  const std::string body =
      rectangle("<rotate y=\"1\" angle=\"180\"/><translate z=\"4\"/>", emitter("1")) +
      rectangle("", "<bsdf type=\"conductor\"/>");
  const double n = 0.2004376970 / 1.000277, k = 3.9129485033 / 1.000277;
  const double copper = ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
  CHECK(probe(body, "0,0,1", "0,0,0").x == Approx(copper).epsilon(1e-5));
  CHECK(probe(body, "0,0,1", "0,0,0", "3.0.0") == Rgb(1));
  CHECK(probe(body, "0,0,-1", "0,0,0") == Rgb(0));
}

TEST_CASE(
    "dielectric at normal incidence: Fresnel, and radiance by the index squared, within 0.5 %") {
  // Below one boundary of water a lamp: L = (1 - F) Le / n^2; the reflected part sees nothing.
  const std::string body =
      rectangle("<translate z=\"-3\"/>", emitter("1")) +
      rectangle("",
                "<bsdf type=\"dielectric\"><string name=\"intIOR\" value=\"water\"/>"
                "<float name=\"extIOR\" value=\"1\"/></bsdf>");
  const double n = 1.333, reflected = (n - 1) * (n - 1) / ((n + 1) * (n + 1));
  const TestFolder folder;
  const Rendered r = render(
      scene_text(body + sensor("origin=\"0,0,1\" target=\"0,0,0\" up=\"0,1,0\"", 0.01, 1, 1)),
      16384);
  const double expected = (1 - reflected) / (n * n);
  // Standard error of a choice of probability F among 16384.
  const double error = std::sqrt(reflected * (1 - reflected) / 16384) / (n * n);
  CHECK(error <= 0.005 * expected / 4);
  CHECK(std::fabs(r.at(0, 0).x - expected) <= 0.005 * expected);
}

TEST_CASE("phong: rho_d / pi + rho_s (n + 2) / (2 pi) at the mirror direction") {
  const std::string phong =
      "<bsdf type=\"phong\"><rgb name=\"diffuseReflectance\" value=\"0.3\"/><rgb "
      "name=\"specularReflectance\" value=\"0.4\"/><float name=\"exponent\" value=\"20\"/></bsdf>";
  const double f = 0.3 / kPi + 0.4 * 22 / (2 * kPi);
  CHECK(probe(rectangle("", phong) + kPoint, "0,0,1", "0,0,0").x == Approx(f * 2).epsilon(1e-4));
  // 30 degrees off: cos^20.
  const double tilted = 0.3 / kPi + 0.4 * 22 / (2 * kPi) * pow_exact(std::sqrt(0.75), 20);
  CHECK(probe(rectangle("", phong) + kPoint, "0,1,1.7320508075688772", "0,0,0").x ==
        Approx(tilted * 2).epsilon(1e-4));
}

TEST_CASE("maxDepth: 1 shows emitters, 2 adds direct light, more adds the rest") {
  const auto layers = [](int depth) {
    const std::string body =
        "<integrator type=\"path\"><integer name=\"maxDepth\" value=\"" + std::to_string(depth) +
        "\"/></integrator>" + rectangle("", "") +
        rectangle("<rotate y=\"1\" angle=\"180\"/><translate z=\"1\"/>", emitter("1") + kDim) +
        rectangle("<rotate y=\"1\" angle=\"90\"/><translate x=\"-1\"/>", "");
    const Rendered r =
        render(scene_text(body + sensor("origin=\"0.9,0,0.5\" target=\"0,0,0.5\" up=\"0,0,1\"", 100,
                                        8, 8)),
               16);
    std::array<double, 3> sums{};
    const char* const names[] = {"emission", "direct", "indirect"};
    for (size_t i = 0; i < 3; ++i)
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) sums[i] += r.at(x, y, names[i]).x;
    return sums;
  };
  const auto one = layers(1), two = layers(2), three = layers(3), all = layers(-1);
  CHECK(one[0] > 0);
  CHECK(one[1] == 0);
  CHECK(one[2] == 0);
  CHECK(two[0] == one[0]);
  CHECK(two[1] > 0);
  CHECK(two[2] == 0);
  CHECK(three[1] == two[1]);
  CHECK(three[2] > 0);
  CHECK(all[2] > three[2]);
}
