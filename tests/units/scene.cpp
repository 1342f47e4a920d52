// SPDX-License-Identifier: Apache-2.0
// What scene files mean, sentence by sentence: see docs/scene.md.
#include "golden/scene/scene.hpp"

#include <fmt/core.h>

#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/text.hpp"
#include "golden/transport/emitters.hpp"
#include "golden/transport/world.hpp"
#include "tests/catch.hpp"
#include "tests/scene_files.hpp"

using namespace photonloom;

namespace {

bool near(const Vec3& a, const Vec3& b) {
  return glm::length(a - b) <= 1e-12 * (1 + glm::length(b));
}

Vec3 apply(const Mat4& m, const Vec3& p) { return Vec3(m * glm::dvec4(p, 1)); }

// toWorld of a disk with the given steps.
Mat4 transform(const std::string& steps, const std::string& version = "0.6.0") {
  return load_body(
             "<shape type=\"disk\"><transform name=\"toWorld\">" + steps + "</transform></shape>",
             version)
      .shapes[0]
      .to_world;
}

Bsdf bsdf(const std::string& text, const std::string& version = "0.6.0") {
  const Scene s = load_body("<shape type=\"disk\">" + text + "</shape>", version);
  return s.bsdfs[static_cast<size_t>(s.shapes[0].bsdf)];
}

Vec3 face_normal(const Mesh& mesh, size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return glm::normalize(glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                   mesh.positions[t[2]] - mesh.positions[t[0]]));
}

// Six times the volume that the triangles enclose: positive where they face outward.
// outward.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += glm::dot(mesh.positions[t[0]], glm::cross(mesh.positions[t[1]], mesh.positions[t[2]]));
  return sum;
}

Scene with_mesh(const std::string& name, const std::string& file, const std::string& properties,
                const std::string& version = "0.6.0") {
  const TestFolder folder;
  folder.write(name, file);
  const std::string type = name.substr(name.rfind('.') + 1);
  return load_scene(folder.write(
      "scene.xml", scene_text("<shape type=\"" + type + "\"><string name=\"filename\" value=\"" +
                                  name + "\"/>" + properties + "</shape>" + kSensor + kLamp,
                              version)));
}

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

}  // namespace

TEST_CASE("integrators and samplers of any type are accepted") {
  const Scene s = load_body(
      "<integrator type=\"whatever\"><integer name=\"directSamples\" value=\"3\"/>"
      "<integrator type=\"inner\"><integer name=\"maxDepth\" value=\"7\"/>"
      "<integer name=\"rrDepth\" value=\"3\"/></integrator></integrator>");
  CHECK(s.max_depth == 7);
  CHECK(s.rr_depth == 3);
  CHECK_THAT(body_error("<integrator type=\"path\"><boolean name=\"hideEmitters\" value=\"true\"/>"
                        "</integrator>"),
             ContainsSubstring("scene.xml:2") && ContainsSubstring("hidden emitters"));
}

TEST_CASE("depths in both spellings, no limit by default") {
  CHECK(load_body("").max_depth == -1);
  CHECK(load_body("").rr_depth == 5);
  const Scene s = load_body(
      "<integrator type=\"path\"><integer name=\"max_depth\" value=\"4\"/>"
      "<integer name=\"rr_depth\" value=\"9\"/></integrator>",
      "3.0.0");
  CHECK(s.max_depth == 4);
  CHECK(s.rr_depth == 9);
  CHECK_THAT(body_error("<integrator type=\"path\"><integer name=\"maxDepth\" value=\"0\"/>"
                        "</integrator>"),
             ContainsSubstring("expected -1 for no limit or 1 to 2147483647"));
}

TEST_CASE("film size, sample count, and keys that do not change pixels") {
  const auto sensor = [](const std::string& inside) {
    return "<sensor type=\"perspective\">" + inside + "</sensor>" + kLamp;
  };
  const TestFolder folder;
  const Scene s = load_scene(folder.write(
      "a.xml", scene_text(sensor("<sampler type=\"ldsampler\"><integer name=\"sampleCount\" "
                                 "value=\"36\"/></sampler><film type=\"ldrfilm\">"
                                 "<integer name=\"width\" value=\"30\"/>"
                                 "<integer name=\"height\" value=\"20\"/>"
                                 "<integer name=\"cropWidth\" value=\"30\"/>"
                                 "<string name=\"pixelFormat\" value=\"rgb\"/>"
                                 "<string name=\"label[10, 10]\" value=\"x\"/>"
                                 "<boolean name=\"banner\" value=\"true\"/>"
                                 "<rfilter type=\"box\"/></film>"))));
  CHECK(s.film.width == 30);
  CHECK(s.film.height == 20);
  CHECK(s.sample_count == 36);
  CHECK(s.warnings.empty());
  CHECK(load_body("").film.width == 768);
  CHECK(load_body("").film.height == 576);
}

TEST_CASE("reconstruction filters and windows, in both versions' spelling") {
  const TestFolder folder;
  const auto film = [&](const std::string& inside, const std::string& type = "hdrfilm",
                        const std::string& version = "0.6.0") {
    return load_scene(
        folder.write("a.xml", scene_text("<sensor type=\"perspective\"><film type=\"" + type +
                                             "\">" + inside + "</film></sensor>" + kLamp,
                                         version)));
  };
  const auto filter = [&](const std::string& type, const std::string& inside) {
    return film("<rfilter type=\"" + type + "\">" + inside + "</rfilter>").film.filter;
  };
  const auto given = [](const char* name, const char* value) {
    return std::string("<float name=\"") + name + "\" value=\"" + value + "\"/>";
  };
  CHECK(filter("box", "").is_plain_box());
  CHECK(filter("box", given("radius", "1.5")).radius == 1.5);
  CHECK(filter("tent", "").kind == FilterKind::kTent);
  CHECK(filter("tent", "").radius == 1);
  CHECK(filter("gaussian", given("stddev", "0.25")).stddev == 0.25);
  CHECK(filter("gaussian", given("stddev", "0.25")).radius == 1);
  CHECK(filter("mitchell", "").b == Approx(1.0 / 3));
  CHECK(filter("mitchell", given("B", "0.2") + given("C", "0.4")).c == 0.4);
  CHECK(filter("catmullrom", "").b == 0);
  CHECK(filter("catmullrom", "").c == 0.5);
  CHECK(filter("lanczos", "").radius == 3);
  CHECK(filter("lanczos", "<integer name=\"lobes\" value=\"2\"/>").radius == 2);
  // Mitsuba's default, but for mfilm.
  CHECK(film("").film.filter.kind == FilterKind::kGaussian);
  CHECK(film("").film.filter.stddev == 0.5);
  CHECK(film("").warnings.empty());
  CHECK(load_body("").film.filter.kind == FilterKind::kGaussian);
  CHECK(film("", "mfilm").film.filter.is_plain_box());
  CHECK(film("").hash != film("<rfilter type=\"box\"/>").hash);
  const auto integer = [](const char* name, int value) {
    return std::string("<integer name=\"") + name + "\" value=\"" + std::to_string(value) + "\"/>";
  };
  const std::string size = integer("width", 30) + integer("height", 20);
  for (const Scene& s : {film(size + integer("cropOffsetX", 3) + integer("cropOffsetY", 4) +
                              integer("cropWidth", 10) + integer("cropHeight", 6)),
                         film(size + integer("crop_offset_x", 3) + integer("crop_offset_y", 4) +
                                  integer("crop_width", 10) + integer("crop_height", 6),
                              "hdrfilm", "3.0.0")}) {
    CHECK(s.film.width == 10);
    CHECK(s.film.height == 6);
    CHECK(s.film.left == 3);
    CHECK(s.film.top == 4);
    CHECK(s.film.whole_width == 30);
    CHECK(s.film.whole_height == 20);
  }
  CHECK_FALSE(film(size + integer("cropWidth", 30)).film.is_window());
  CHECK(film(size + integer("cropOffsetX", 3)).film.width == 27);
  const auto error = [&](const std::string& inside) {
    try {
      film(inside);
    } catch (const SceneError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK_THAT(error(size + integer("cropOffsetX", 30)),
             ContainsSubstring("a.xml:2: cropOffsetX is 30, expected 0 to 29"));
  CHECK_THAT(error(size + integer("cropOffsetY", 4) + integer("cropHeight", 17)),
             ContainsSubstring("cropHeight is 17, expected 1 to 16"));
  CHECK_THAT(error("<rfilter type=\"gaussian\">" + given("stddev", "9") + "</rfilter>"),
             ContainsSubstring("a.xml:2: stddev is 9, expected 0.025 to 2"));
  CHECK_THAT(error("<rfilter type=\"mitchell\">" + given("B", "2") + "</rfilter>"),
             ContainsSubstring("B is 2, expected 0 to 1"));
  CHECK_THAT(error("<rfilter type=\"wavelet\"/>"),
             ContainsSubstring("<rfilter type=\"wavelet\">") && ContainsSubstring("lanczos"));
}

TEST_CASE("sensors: thinlens, orthographic, shifted principal point") {
  const TestFolder folder;
  const auto camera = [&](const std::string& type, const std::string& inside) {
    return load_scene(folder.write("a.xml", scene_text("<sensor type=\"" + type + "\">" + inside +
                                                       "</sensor>" + kLamp)))
        .camera;
  };
  const std::string aperture = "<float name=\"apertureRadius\" value=\"0.1\"/>";
  const Camera thin = camera("thinlens", aperture + "<float name=\"focusDistance\" value=\"2\"/>");
  CHECK(thin.kind == CameraKind::kThinLens);
  CHECK(thin.aperture_radius == 0.1);
  CHECK(thin.focus_distance == 2);
  CHECK(camera("thinlens", aperture).focus_distance == 10000);
  CHECK(camera("thinlens", aperture + "<float name=\"farClip\" value=\"7\"/>").focus_distance == 7);
  CHECK(camera("thinlens", "<float name=\"apertureRadius\" value=\"0\"/>").kind ==
        CameraKind::kPerspective);
  const Camera flat =
      camera("orthographic", "<transform name=\"toWorld\"><scale x=\"3\" y=\"2\"/></transform>");
  CHECK(flat.kind == CameraKind::kOrthographic);
  CHECK(flat.to_world[0][0] == 3);
  CHECK(camera("perspective", "<float name=\"principalPointOffsetX\" value=\"0.2\"/>").offset_x ==
        0.2);
  const auto error = [&](const std::string& type, const std::string& inside) {
    return load_error(scene_text("<sensor type=\"" + type + "\">" + inside + "</sensor>" + kLamp));
  };
  CHECK_THAT(error("thinlens", ""),
             ContainsSubstring("scene.xml:2") && ContainsSubstring("has no apertureRadius"));
  CHECK_THAT(error("thinlens", aperture + "<float name=\"focusDistance\" value=\"0\"/>"),
             ContainsSubstring("focusDistance is 0, expected more than 0"));
  CHECK_THAT(error("spherical", ""),
             ContainsSubstring("<sensor type=\"spherical\">") && ContainsSubstring("thinlens"));
  CHECK_THAT(error("orthographic", "<float name=\"fov\" value=\"30\"/>"), ContainsSubstring("fov"));
}

TEST_CASE("cylinder: from p0 to p1 with a radius, then toWorld") {
  const Scene s = load_body(
      "<shape type=\"cylinder\"><point name=\"p0\" x=\"1\" y=\"0\" z=\"0\"/><point name=\"p1\" "
      "x=\"1\" y=\"3\" z=\"4\"/><float name=\"radius\" value=\"0.5\"/><transform "
      "name=\"toWorld\"><scale value=\"2\"/></transform></shape><shape type=\"cylinder\"/>");
  CHECK(s.shapes[0].kind == ShapeKind::kCylinder);
  CHECK(Vec3(s.shapes[0].to_world[3]) == Vec3(2, 0, 0));
  CHECK(glm::length(Vec3(s.shapes[0].to_world[2]) - Vec3(0, 6, 8)) < 1e-15);
  for (int i : {0, 1}) {
    CHECK(glm::length(Vec3(s.shapes[0].to_world[i])) == Approx(1));
    CHECK(std::fabs(glm::dot(Vec3(s.shapes[0].to_world[i]), Vec3(0, 6, 8))) < 1e-14);
  }
  CHECK(Vec3(s.shapes[1].to_world[2]) == Vec3(0, 0, 1));
  CHECK_THAT(body_error("<shape type=\"cylinder\"><point name=\"p1\" x=\"0\" y=\"0\" z=\"0\"/>"
                        "</shape>"),
             ContainsSubstring("p0 and p1 are the same point"));
  CHECK_THAT(body_error("<shape type=\"cylinder\"><transform name=\"toWorld\"><scale x=\"2\"/>"
                        "</transform></shape>"),
             ContainsSubstring("expected equal scales"));
}

TEST_CASE("parameters: defaults, -D, substitution everywhere") {
  const std::string body =
      "<default name=\"r\" value=\"2\"/><default name=\"radius\" value=\"$r.5\"/>"
      "<shape type=\"sphere\" id=\"s$r\"><float name=\"radius\" value=\"$radius\"/></shape>";
  const Scene s = load_body(body);
  CHECK(s.shapes[0].to_world[0][0] == 2.5);
  CHECK(s.shapes[0].id == "s2");
  CHECK(load_body(body, "0.6.0", {{"r", "3"}}).shapes[0].to_world[0][0] == 3.5);
  CHECK_THAT(load_error(scene_text(body + kSensor + kLamp), {{"size", "3"}}),
             ContainsSubstring("'size'") && ContainsSubstring("not used") &&
                 ContainsSubstring("r, radius"));
  CHECK_THAT(body_error("<shape type=\"sphere\"><float name=\"radius\" value=\"$x\"/></shape>"),
             ContainsSubstring("'$x' is not defined"));
  CHECK_THAT(load_error(scene_text(body + kSensor + kLamp), {{"r", "3"}, {"r", "4"}}),
             ContainsSubstring("given twice"));
}

TEST_CASE("versions that are read are 0.3 to 0.6, 2.x and 3.x") {
  for (const char* version : {"0.3", "0.4.0", "0.6.0", "2.1.0", "3.0.0", "3.6"}) {
    INFO(version);
    CHECK(load_error(scene_text(std::string(kSensor) + kLamp, version)) == "");
  }
  for (const char* version : {"", "0.2", "0.7", "0.9.1", "0.10", "0.60", "-0.6", "0.-6", "0..6",
                              "0.6.", "1.0", "4.0", "0.6.0.junk", "3.0.0a", "3.x"}) {
    INFO(version);
    CHECK_THAT(load_error(scene_text(std::string(kSensor) + kLamp, version)),
               ContainsSubstring("expected 0.3 to 0.6, 2.x or 3.x"));
  }
}

TEST_CASE("an included file has the rules of the scene, or is refused") {
  const TestFolder folder;
  const std::string whole = std::string("<include filename=\"more.xml\"/>") + kSensor + kLamp;
  folder.write("more.xml", scene_text("<bsdf type=\"diffuse\" id=\"b\"/>", "3.0.0"));
  CHECK_THROWS_WITH(load_scene(folder.write("old.xml", scene_text(whole, "0.6.0"))),
                    ContainsSubstring("more.xml:1: ") &&
                        ContainsSubstring("version '3.0.0' has other rules") &&
                        ContainsSubstring("expected 0.3 to 0.6"));
  CHECK_NOTHROW(load_scene(folder.write("new.xml", scene_text(whole, "2.2.1"))));
  folder.write("more.xml", "<scene><bsdf type=\"diffuse\" id=\"b\"/></scene>");
  CHECK_NOTHROW(load_scene(folder.write("old.xml", scene_text(whole, "0.6.0"))));
}

TEST_CASE("numbers nearer to 0 than any double are 0, those beyond the largest no numbers") {
  for (const char* tiny : {"1e-400", "-1e-400", "0.000e-999", "1e-320"}) {
    INFO(tiny);
    const auto value = parse_double(tiny);
    REQUIRE(value);
    CHECK(std::fabs(*value) < 1e-300);
    CHECK(std::signbit(*value) == (tiny[0] == '-'));
  }
  for (const char* other : {"1e400", "-1e400", "1e-400x", "1e"}) {
    INFO(other);
    CHECK_FALSE(parse_double(other));
  }
}

TEST_CASE("files are found from the scene file, includes too") {
  const TestFolder folder;
  folder.write("meshes/a.obj", kTriangle);
  folder.write("parts/more.xml",
               scene_text("<shape type=\"obj\"><string name=\"filename\" value=\"meshes/a.obj\"/>"
                          "<ref id=\"b\"/></shape>"));
  const Scene s = load_scene(
      folder.write("scene.xml", scene_text(std::string("<include filename=\"parts/more.xml\"/>") +
                                           "<bsdf type=\"diffuse\" id=\"b\"/>" + kSensor + kLamp)));
  CHECK(s.shapes.size() == 2);
  CHECK(s.shapes[0].mesh.triangles.size() == 1);
  folder.write("loop.xml", scene_text("<include filename=\"loop.xml\"/>"));
  CHECK_THROWS_WITH(load_scene(folder / "loop.xml"),
                    ContainsSubstring("loop.xml:2: cyclic include"));
  CHECK_THROWS_WITH(
      load_scene(folder.write("missing.xml", scene_text("<include filename=\"none.xml\"/>"))),
      ContainsSubstring("missing.xml:2") && ContainsSubstring("none.xml' does not exist"));
}

TEST_CASE("transforms apply in document order") {
  const Mat4 m = transform("<scale value=\"2\"/><translate x=\"1\"/>");
  CHECK(apply(m, {1, 0, 0}) == Vec3(3, 0, 0));
  const Mat4 n = transform("<translate x=\"1\"/><scale value=\"2\"/>");
  CHECK(apply(n, {1, 0, 0}) == Vec3(4, 0, 0));
}

TEST_CASE("rotations are in degrees, counter-clockwise about the axis") {
  CHECK(near(apply(transform("<rotate z=\"1\" angle=\"90\"/>"), {1, 0, 0}), {0, 1, 0}));
  CHECK(near(apply(transform("<rotate value=\"0, 2 0\" angle=\"-90\"/>", "3.0.0"), {1, 0, 0}),
             {0, 0, 1}));
  CHECK(near(apply(transform("<rotate x=\"1\" y=\"1\" z=\"1\" angle=\"120\"/>"), {1, 0, 0}),
             {0, 1, 0}));
}

TEST_CASE("matrices are row-major, vectors separated by commas, blanks or both") {
  const Mat4 m = transform("<matrix value=\"1 2, 3 4  0 5 6 7 0,0,8,9 0 0 0 1\"/>");
  CHECK(apply(m, {0, 0, 0}) == Vec3(4, 7, 9));
  CHECK(apply(m, {0, 1, 0}) == Vec3(6, 12, 9));
  CHECK_THAT(body_error("<shape type=\"disk\"><transform name=\"toWorld\">"
                        "<matrix value=\"1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1\"/></transform></shape>"),
             ContainsSubstring("singular"));
}

TEST_CASE("scale and translate as x, y, z or value") {
  CHECK(apply(transform("<scale x=\"2\" z=\"3\"/>"), {1, 1, 1}) == Vec3(2, 1, 3));
  CHECK(apply(transform("<scale value=\"2, 4 8\"/>", "3.0.0"), {1, 1, 1}) == Vec3(2, 4, 8));
  CHECK(apply(transform("<translate value=\"2,4,8\"/>", "3.0.0"), {0, 0, 0}) == Vec3(2, 4, 8));
}

TEST_CASE("lookat, lookAt and look_at: z forward, y up, x to the image's left") {
  for (const char* tag : {"lookat", "lookAt", "look_at"}) {
    const Mat4 m =
        transform(std::string("<") + tag + " origin=\"1,2,3\" target=\"1 2 -7\" up=\"0, 5, 0\"/>");
    CHECK(near(Vec3(m[2]), {0, 0, -1}));
    CHECK(near(Vec3(m[1]), {0, 1, 0}));
    // Looking along -z with y up, the viewer's left is -x: not mirrored.
    CHECK(near(Vec3(m[0]), {-1, 0, 0}));
    CHECK(apply(m, {0, 0, 0}) == Vec3(1, 2, 3));
  }
  CHECK_THAT(body_error("<shape type=\"disk\"><transform name=\"toWorld\"><lookat origin=\"0,0,0\" "
                        "target=\"0,2,0\" up=\"0,1,0\"/></transform></shape>"),
             ContainsSubstring("parallel"));
}

TEST_CASE("the camera's field of view and its axis") {
  const auto camera = [](const std::string& inside) {
    const TestFolder folder;
    return load_scene(folder.write("scene.xml", scene_text("<sensor type=\"perspective\">" +
                                                           inside + "</sensor>" + kLamp)))
        .camera;
  };
  CHECK(camera("<float name=\"fov\" value=\"30\"/>").fov == 30);
  CHECK(camera("<float name=\"fov\" value=\"30\"/>").fov_axis == FovAxis::kX);
  for (const auto& [name, axis] :
       {std::pair("x", FovAxis::kX), std::pair("y", FovAxis::kY),
        std::pair("diagonal", FovAxis::kDiagonal), std::pair("smaller", FovAxis::kSmaller),
        std::pair("larger", FovAxis::kLarger)})
    CHECK(
        camera(std::string("<float name=\"fov\" value=\"30\"/><string name=\"fovAxis\" value=\"") +
               name + "\"/>")
            .fov_axis == axis);
  // 50 mm on 36 by 24 mm film: 2 atan(sqrt(36^2 + 24^2) / 100) = 46.7930 degrees along the
  // diagonal.
  CHECK(camera("").fov == Approx(46.7930).epsilon(1e-5));
  CHECK(camera("").fov_axis == FovAxis::kDiagonal);
  CHECK(camera("<string name=\"focalLength\" value=\"21.6333mm\"/>").fov ==
        Approx(90).epsilon(1e-5));
  CHECK(camera("").near_clip == 0);
  CHECK(std::isinf(camera("").far_clip));
  CHECK(camera("<float name=\"nearClip\" value=\"2\"/>").near_clip == 2);
  CHECK_THAT(load_error(scene_text(std::string("<sensor type=\"perspective\"><float name=\"fov\" "
                                               "value=\"180\"/></sensor>") +
                                   kLamp)),
             ContainsSubstring("fov is 180"));
}

TEST_CASE("rectangle: [-1,1]^2, normal +z; cube: [-1,1]^3, normals outward") {
  const Scene s = load_body("<shape type=\"rectangle\"/><shape type=\"cube\"/>");
  CHECK(face_normal(s.shapes[0].mesh, 0) == Vec3(0, 0, 1));
  CHECK(face_normal(s.shapes[0].mesh, 1) == Vec3(0, 0, 1));
  CHECK(s.shapes[0].mesh.normals.empty());
  CHECK(s.shapes[1].mesh.triangles.size() == 12);
  CHECK(volume(s.shapes[1].mesh) == Approx(6 * 8));
  for (const Vec3& p : s.shapes[1].mesh.positions) CHECK(glm::abs(p) == Vec3(1));
}

TEST_CASE("a reflection keeps rectangles' and cubes' sides") {
  const std::string mirror = "<transform name=\"toWorld\"><scale x=\"-1\"/></transform>";
  const Scene s = load_body("<shape type=\"rectangle\">" + mirror +
                            "</shape><shape type=\"cube\">" + mirror + "</shape>");
  CHECK(face_normal(s.shapes[0].mesh, 0) == Vec3(0, 0, 1));
  CHECK(volume(s.shapes[1].mesh) == Approx(6 * 8));
}

TEST_CASE("sphere: center and radius, then toWorld") {
  const Scene s = load_body(
      "<shape type=\"sphere\"><point name=\"center\" x=\"1\" y=\"2\" z=\"3\"/>"
      "<float name=\"radius\" value=\"0.5\"/><transform name=\"toWorld\"><scale value=\"2\"/>"
      "<translate x=\"10\"/></transform></shape>"
      "<shape type=\"sphere\"><point name=\"center\" value=\"1 2 3\"/></shape>");
  CHECK(apply(s.shapes[0].to_world, {0, 0, 0}) == Vec3(12, 4, 6));
  CHECK(apply(s.shapes[0].to_world, {1, 0, 0}) == Vec3(13, 4, 6));
  CHECK(apply(s.shapes[1].to_world, {0, 0, 0}) == Vec3(1, 2, 3));
  CHECK_THAT(body_error("<shape type=\"sphere\"><transform name=\"toWorld\"><scale x=\"2\"/>"
                        "</transform></shape>"),
             ContainsSubstring("ellipsoid"));
  CHECK_THAT(body_error("<shape type=\"sphere\"><float name=\"radius\" value=\"0\"/></shape>"),
             ContainsSubstring("radius is 0"));
}

TEST_CASE("flipNormals turns every shape") {
  const std::string flip = "<boolean name=\"flipNormals\" value=\"true\"/>";
  const Scene s = load_body("<shape type=\"rectangle\">" + flip + "</shape><shape type=\"cube\">" +
                            flip + "</shape><shape type=\"sphere\">" + flip + "</shape>");
  CHECK(face_normal(s.shapes[0].mesh, 0) == Vec3(0, 0, -1));
  CHECK(volume(s.shapes[1].mesh) == Approx(-6 * 8));
  CHECK(s.shapes[2].flip_normals);
  const Scene m =
      with_mesh("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n", flip);
  CHECK(face_normal(m.shapes[0].mesh, 0) == Vec3(0, 0, -1));
  CHECK(m.shapes[0].mesh.normals[0] == Vec3(0, 0, -1));
}

TEST_CASE("mesh normals follow winding; missing ones are smooth; faceNormals discards them") {
  CHECK(face_normal(with_mesh("a.obj", kTriangle, "").shapes[0].mesh, 0) == Vec3(0, 0, 1));
  // Two triangles at a right angle over the edge from (0,0,0) to (0,1,0).
  const std::string bent = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\n";
  const Mesh smooth = with_mesh("a.obj", bent, "").shapes[0].mesh;
  REQUIRE(smooth.normals.size() == 4);
  // Angles at the first vertex are equal, 90 degrees each.
  for (size_t i = 0; i < 4; ++i)
    if (smooth.positions[i] == Vec3(0))
      CHECK(near(smooth.normals[i], glm::normalize(Vec3(1, 0, 1))));
  const std::string faceted = "<boolean name=\"faceNormals\" value=\"true\"/>";
  CHECK(with_mesh("a.obj", bent, faceted).shapes[0].mesh.normals.empty());
  const std::string tilted = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3 4\nf 1//1 2//1 3//1\n";
  CHECK(near(with_mesh("a.obj", tilted, "").shapes[0].mesh.normals[0], {0, 0.6, 0.8}));
  CHECK(with_mesh("a.obj", tilted, faceted).shapes[0].mesh.normals.empty());
  // Normals of the file say which side is outside, as in Mitsuba, also where the winding disagrees.
  const std::string against = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 -1\nf 1//1 2//1 3//1\n";
  CHECK(face_normal(with_mesh("a.obj", against, "").shapes[0].mesh, 0) == Vec3(0, 0, -1));
  CHECK(face_normal(with_mesh("a.obj", against, faceted).shapes[0].mesh, 0) == Vec3(0, 0, 1));
}

TEST_CASE("normals go by the inverse transpose") {
  const Mesh m =
      with_mesh("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 1\nf 1//1 2//1 3//1\n",
                "<transform name=\"toWorld\"><scale x=\"2\" y=\"1\" z=\"1\"/></transform>")
          .shapes[0]
          .mesh;
  CHECK(near(m.normals[0], glm::normalize(Vec3(0.5, 0, 1))));
}

TEST_CASE("area emitters radiate from the normal side, and are black without a BSDF") {
  const Scene s = load_body(
      "<shape type=\"rectangle\"><emitter type=\"area\"><rgb name=\"radiance\" value=\"1, 2 3\"/>"
      "</emitter></shape><shape type=\"rectangle\"/>"
      "<shape type=\"cube\"><ref id=\"later\"/><ref id=\"glow\"/></shape>"
      "<bsdf type=\"diffuse\" id=\"later\"><rgb name=\"reflectance\" value=\"#ff0000\"/></bsdf>"
      "<emitter type=\"area\" id=\"glow\"><spectrum name=\"radiance\" value=\"4\"/></emitter>");
  CHECK(*s.shapes[0].radiance == Rgb(1, 2, 3));
  CHECK(s.bsdfs[static_cast<size_t>(s.shapes[0].bsdf)].diffuse == Rgb(0));
  CHECK(!s.shapes[1].radiance);
  CHECK(s.bsdfs[static_cast<size_t>(s.shapes[1].bsdf)].diffuse == Rgb(0.5));
  CHECK(*s.shapes[2].radiance == Rgb(4));
  CHECK(s.bsdfs[static_cast<size_t>(s.shapes[2].bsdf)].diffuse == Rgb(1, 0, 0));
}

TEST_CASE("black from behind unless inside twosided") {
  const Scene s = load_body(
      "<bsdf type=\"twosided\" id=\"both\"><ref id=\"r\"/></bsdf>"
      "<bsdf type=\"diffuse\" id=\"r\"/>"
      "<bsdf type=\"twosided\" id=\"two\"><ref id=\"r\"/><bsdf type=\"conductor\">"
      "<string name=\"material\" value=\"none\"/></bsdf></bsdf>"
      "<shape type=\"disk\"><ref id=\"r\"/></shape><shape type=\"disk\"><ref id=\"both\"/></shape>"
      "<shape type=\"disk\"><ref id=\"two\"/></shape>"
      "<shape type=\"disk\"><bsdf type=\"dielectric\"/></shape>");
  CHECK(s.shapes[0].back_bsdf == -1);
  CHECK(s.shapes[1].back_bsdf == s.shapes[1].bsdf);
  CHECK(s.bsdfs[static_cast<size_t>(s.shapes[1].bsdf)].two_sided);
  CHECK(s.bsdfs[static_cast<size_t>(s.shapes[2].bsdf)].kind == BsdfKind::kDiffuse);
  CHECK(s.bsdfs[static_cast<size_t>(s.shapes[2].back_bsdf)].kind == BsdfKind::kConductor);
  CHECK(s.shapes[3].back_bsdf == s.shapes[3].bsdf);
  CHECK_THAT(body_error("<bsdf type=\"twosided\" id=\"x\"><bsdf type=\"dielectric\"/></bsdf>"),
             ContainsSubstring("dielectric in <bsdf type=\"twosided\">"));
}

TEST_CASE("point, spot and directional emitters") {
  const Scene s = load_body(
      "<emitter type=\"point\"><point name=\"position\" x=\"1\" y=\"2\" z=\"3\"/>"
      "<rgb name=\"intensity\" value=\"5\"/></emitter>"
      "<emitter type=\"point\"><transform name=\"toWorld\"><translate "
      "y=\"4\"/></transform></emitter>"
      "<emitter type=\"spot\"><transform name=\"toWorld\"><lookat origin=\"0,5,0\" "
      "target=\"0,0,0\" up=\"0,0,1\"/></transform></emitter>"
      "<emitter type=\"spot\"><float name=\"cutoffAngle\" value=\"60\"/>"
      "<float name=\"beamWidth\" value=\"30\"/></emitter>"
      "<emitter type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"-2\" z=\"0\"/>"
      "<spectrum name=\"irradiance\" value=\"1 2 3\"/></emitter>");
  REQUIRE(s.lights.size() == 5);
  CHECK(s.lights[0].position == Vec3(1, 2, 3));
  CHECK(s.lights[0].intensity == Rgb(5));
  CHECK(s.lights[1].position == Vec3(0, 4, 0));
  CHECK(s.lights[1].intensity == Rgb(1));
  CHECK(near(s.lights[2].position, {0, 5, 0}));
  CHECK(near(s.lights[2].direction, {0, -1, 0}));
  CHECK(s.lights[2].cutoff_angle == Approx(20 * kPi / 180));
  CHECK(s.lights[2].beam_angle == Approx(15 * kPi / 180));
  CHECK(s.lights[3].direction == Vec3(0, 0, 1));
  CHECK(s.lights[3].cutoff_cos == Approx(0.5));
  CHECK(s.lights[3].beam_cos == Approx(std::sqrt(0.75)));
  CHECK(s.lights[4].direction == Vec3(0, -1, 0));
  CHECK(s.lights[4].intensity == Rgb(1, 2, 3));
  CHECK_THAT(body_error("<emitter type=\"projector\"/>"),
             ContainsSubstring("<emitter type=\"projector\">"));
}

TEST_CASE("dielectric: indices as numbers or names") {
  CHECK(bsdf("<bsdf type=\"dielectric\"/>").ior == Approx(1.5046 / 1.000277).epsilon(1e-15));
  CHECK(bsdf("<bsdf type=\"dielectric\"><float name=\"intIOR\" value=\"1.6\"/><string "
             "name=\"extIOR\" value=\"vacuum\"/></bsdf>")
            .ior == 1.6);
  CHECK(bsdf("<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"Water\"/><float "
             "name=\"ext_ior\" value=\"1\"/></bsdf>",
             "3.0.0")
            .ior == 1.333);
  CHECK_THAT(
      body_error("<bsdf type=\"dielectric\"><string name=\"intIOR\" value=\"jelly\"/></bsdf>"),
      ContainsSubstring("'jelly' is unknown") && ContainsSubstring("diamond"));
}

TEST_CASE("conductor: Cu by default in 0.x files, an ideal mirror in 3.x") {
  const Bsdf copper = bsdf("<bsdf type=\"conductor\"/>");
  CHECK(copper.eta.x == Approx(0.2004376970 / 1.000277));
  CHECK(copper.k.z == Approx(2.1421879552 / 1.000277));
  CHECK(is_black(bsdf("<bsdf type=\"conductor\"/>", "3.0.0").eta));
  CHECK(is_black(
      bsdf("<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/></bsdf>").k));
  const Bsdf given = bsdf(
      "<bsdf type=\"conductor\"><spectrum name=\"eta\" value=\"1,2,3\"/><rgb name=\"k\" "
      "value=\"4\"/>"
      "<float name=\"extEta\" value=\"1\"/><rgb name=\"specularReflectance\" "
      "value=\"0.9\"/></bsdf>");
  CHECK(given.eta == Rgb(1, 2, 3));
  CHECK(given.k == Rgb(4));
  CHECK(given.specular == Rgb(0.9));
  CHECK_THAT(body_error("<bsdf type=\"conductor\"><string name=\"material\" value=\"Xx\"/></bsdf>"),
             ContainsSubstring("'Xx' is unknown") && ContainsSubstring("Au"));
}

TEST_CASE("phong defaults 0.5, 0.2, n = 30") {
  const Bsdf b = bsdf("<bsdf type=\"phong\"/>");
  CHECK(b.diffuse == Rgb(0.5));
  CHECK(b.specular == Rgb(0.2));
  CHECK(b.exponent == 30);
}

TEST_CASE("colors: rgb is linear, #rrggbb, spectrum as triple or scalar, srgb decoded") {
  const auto diffuse = [](const std::string& color) {
    return bsdf("<bsdf type=\"diffuse\">" + color + "</bsdf>").diffuse;
  };
  CHECK(diffuse("<rgb name=\"reflectance\" value=\"0.1, 0.2 0.3\"/>") == Rgb(0.1, 0.2, 0.3));
  CHECK(diffuse("<rgb name=\"reflectance\" value=\"#3300FF\"/>") == Rgb(0.2, 0, 1));
  CHECK(diffuse("<spectrum name=\"reflectance\" value=\"0.1 0.2 0.3\"/>") == Rgb(0.1, 0.2, 0.3));
  CHECK(diffuse("<spectrum name=\"reflectance\" value=\"0.4\"/>") == Rgb(0.4));
  CHECK(diffuse("<srgb name=\"reflectance\" value=\"#808080\"/>").x ==
        Approx(0.2158605).epsilon(1e-6));
  CHECK(diffuse("<rgb name=\"diffuseReflectance\" value=\"0.1\"/>") == Rgb(0.1));
  const Rgb flat = diffuse("<spectrum name=\"reflectance\" value=\"300:0.4, 900:0.4\"/>");
  for (int i = 0; i < 3; ++i) CHECK(flat[i] == Approx(0.4));
  CHECK_THAT(body_error("<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"400:0.1, "
                        "400:0.2\"/></bsdf>"),
             ContainsSubstring("scene.xml:2: 400 nm does not lie above 400 nm"));
}

TEST_CASE("a BSDF that reflects more than arrives is scaled in 0.x files and refused in 3.x") {
  const Bsdf b = bsdf(
      "<bsdf type=\"phong\"><rgb name=\"diffuseReflectance\" value=\"0.9\"/>"
      "<rgb name=\"specularReflectance\" value=\"0.6\"/></bsdf>");
  CHECK(b.diffuse.x == Approx(0.9 * 0.99 / 1.5));
  CHECK(b.specular.x == Approx(0.6 * 0.99 / 1.5));
  CHECK(bsdf("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1\"/></bsdf>").diffuse ==
        Rgb(1));
  CHECK_THAT(body_error("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1.5\"/></bsdf>",
                        "3.0.0"),
             ContainsSubstring("1.5 times the light"));
}

TEST_CASE("what is not supported is an error with file, line and name") {
  CHECK_THAT(body_error("\n<bsdf type=\"hair\" id=\"p\"/>"),
             ContainsSubstring("scene.xml:3: <bsdf type=\"hair\" id=\"p\">"));
  CHECK_THAT(body_error("<texture type=\"wireframe\" id=\"t\"/>"),
             ContainsSubstring("<texture type=\"wireframe\""));
  CHECK_THAT(body_error("<shape type=\"bsplinecurve\"/>"),
             ContainsSubstring("<shape type=\"bsplinecurve\">"));
  CHECK_THAT(body_error("<shape type=\"disk\"><medium type=\"x\"/></shape>"),
             ContainsSubstring("<medium"));
  CHECK_THAT(body_error("<bsdf type=\"diffuse\"><float name=\"glow\" value=\"1\"/></bsdf>"),
             ContainsSubstring("<float name=\"glow\">") && ContainsSubstring("reflectance"));
  CHECK_THAT(
      body_error("<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"1\" extra=\"2\"/>"
                 "</bsdf>"),
      ContainsSubstring("attribute 'extra'"));
  CHECK_THAT(body_error("<bsdf type=\"diffuse\"><texture name=\"glow\" type=\"checkerboard\"/>"
                        "</bsdf>"),
             ContainsSubstring("<texture type=\"checkerboard\""));
  CHECK_THAT(
      body_error("<bsdf type=\"diffuse\"><string name=\"reflectance\" value=\"red\"/></bsdf>"),
      ContainsSubstring("expected <rgb> or <spectrum>"));
  CHECK_THAT(load_error("<scene>" + std::string(kSensor) + kLamp + "</scene>"),
             ContainsSubstring("no version"));
  CHECK_THAT(load_error(scene_text(std::string(kSensor) + kLamp, "0.2.1")),
             ContainsSubstring("'0.2.1'"));
}

TEST_CASE("references, aliases and identifiers") {
  CHECK_THAT(body_error("<shape type=\"disk\"><ref id=\"nobody\"/></shape>"),
             ContainsSubstring("scene.xml:2") && ContainsSubstring("'nobody'"));
  CHECK_THAT(body_error("<bsdf type=\"diffuse\" id=\"a\"/><bsdf type=\"diffuse\" id=\"a\"/>"),
             ContainsSubstring("'a' is used twice"));
  CHECK_THAT(body_error("<bsdf type=\"twosided\" id=\"a\"><ref id=\"a\"/></bsdf>"),
             ContainsSubstring("cyclic reference"));
  CHECK_THAT(body_error("<bsdf type=\"twosided\" id=\"a\"><ref id=\"b\"/></bsdf>"
                        "<bsdf type=\"twosided\" id=\"b\"><ref id=\"a\"/></bsdf>"),
             ContainsSubstring("cyclic reference"));
  const Scene s = load_body(
      "<bsdf type=\"phong\" id=\"a\"/><alias id=\"a\" as=\"b\"/>"
      "<shape type=\"disk\"><ref id=\"b\"/></shape>");
  CHECK(s.bsdfs[static_cast<size_t>(s.shapes[0].bsdf)].kind == BsdfKind::kPhong);
}

TEST_CASE("the hash is of what touches the image, not of how the file is written") {
  const std::string body = "<shape type=\"sphere\"><float name=\"radius\" value=\"2\"/></shape>";
  const uint64_t hash = load_body(body).hash;
  CHECK(load_body("<!-- text -->\n" + body).hash == hash);
  CHECK(load_body("<bsdf type=\"phong\" id=\"unused\"/>" + body).hash == hash);
  CHECK(load_body("<default name=\"r\" value=\"2\"/><shape type=\"sphere\" id=\"x\"><float "
                  "name=\"radius\" value=\"$r\"/></shape>")
            .hash == hash);
  CHECK(load_body("<shape type=\"sphere\"><float name=\"radius\" value=\"2.0000001\"/></shape>")
            .hash != hash);
  CHECK(load_body(body + "<integrator type=\"path\"><integer name=\"maxDepth\" value=\"3\"/>"
                         "</integrator>")
            .hash != hash);
  CHECK(load_body(body + "<emitter type=\"point\"/>").hash != hash);
}

TEST_CASE("names of versions 0.3 and 0.4 are those of 0.6") {
  const TestFolder folder;
  const Scene s = load_scene(folder.write(
      "old.xml",
      "<scene version=\"0.3.0\"><camera type=\"perspective\"><float name=\"fov\" "
      "value=\"40\"/><boolean name=\"mapSmallerSide\" "
      "value=\"false\"/><transform name=\"toWorld\"><translate x=\"1\"/></transform>"
      "<film type=\"exrfilm\"><boolean name=\"alpha\" value=\"true\"/></film></camera>"
      "<shape type=\"disk\"><luminaire type=\"area\"><rgb name=\"intensity\" value=\"2\"/>"
      "</luminaire></shape><luminaire type=\"directional\"><rgb name=\"intensity\" value=\"3\"/>"
      "</luminaire></scene>"));
  CHECK(s.camera.fov_axis == FovAxis::kLarger);
  // Mirrored first, then moved.
  CHECK(apply(s.camera.to_world, Vec3(1, 0, 0)) == Vec3(0, 0, 0));
  CHECK(*s.shapes[0].radiance == Rgb(2));
  CHECK(s.lights[0].intensity == Rgb(3));
  // Between 0.4 and 0.5 one name changed.
  CHECK_THAT(body_error("<bsdf type=\"bump\"><bsdf type=\"diffuse\"/></bsdf>", "0.4.4"),
             ContainsSubstring("<bsdf type=\"bumpmap\">"));
}

TEST_CASE("all that is not supported is named in one message, each with its line") {
  const std::string body =
      "<bsdf type=\"hair\" id=\"a\"/>\n"
      "<shape type=\"disk\"><ref id=\"a\"/><medium type=\"homogeneous\"/></shape>\n"
      "<shape type=\"hair\"><bsdf type=\"irawan\"/></shape>\n"
      "<emitter type=\"sky\"/>\n"
      "<bsdf type=\"diffuse\"><float name=\"glow\" value=\"1\"/></bsdf>\n";
  const TestFolder folder;
  const auto error_of = [&](const std::string& text) {
    try {
      load_scene(folder.write("scene.xml", scene_text(text + kSensor + kLamp)));
    } catch (const SceneError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string error = error_of(body);
  for (const char* part :
       {"6 elements are not supported", "scene.xml:2: <bsdf type=\"hair\" id=\"a\">",
        "scene.xml:3: <medium type=\"homogeneous\">", "scene.xml:4: <shape type=\"hair\">",
        "scene.xml:4: <bsdf type=\"irawan\">", "scene.xml:5: <emitter type=\"sky\">",
        "scene.xml:6: <float name=\"glow\">"})
    CHECK_THAT(error, ContainsSubstring(part));
  // What is wrong comes first and does not hide them.
  CHECK_THAT(error_of(body + "<bsdf type=\"phong\"><float name=\"exponent\" value=\"-1\"/></bsdf>"),
             ContainsSubstring("scene.xml:7: exponent is -1") &&
                 ContainsSubstring("6 elements are not supported"));
  const Scene s = load_scene(folder.write("s.xml", scene_text(body + kSensor + kLamp)), {},
                             Unsupported::kSubstitute);
  REQUIRE(s.substitutions.size() == 6);
  CHECK_THAT(s.substitutions[0], ContainsSubstring("s.xml:2: <bsdf type=\"hair\" id=\"a\">") &&
                                     ContainsSubstring("a diffuse BSDF stands for it"));
  CHECK(s.shapes.size() == 2);  // a disk and the lamp
  CHECK(s.lights.size() == 1);
  CHECK(s.lights[0].kind == LightKind::kEnvironment);
  CHECK(s.bsdfs[static_cast<size_t>(s.shapes[0].bsdf)].diffuse == Rgb(0.5));
  CHECK(load_body("").substitutions.empty());
}

TEST_CASE("the nearest supported BSDF is the one inside, or one of the same color") {
  const TestFolder folder;
  const auto loaded = [&](const std::string& bsdf) {
    const Scene s = load_scene(folder.write("s.xml", scene_text("<shape type=\"disk\">" + bsdf +
                                                                "</shape>" + kSensor + kLamp)),
                               {}, Unsupported::kSubstitute);
    CHECK(s.substitutions.size() == 1);
    return s;
  };
  const auto first = [&](const std::string& bsdf) {
    const Scene s = loaded(bsdf);
    return s.bsdfs[static_cast<size_t>(s.shapes[0].bsdf)];
  };
  CHECK(first("<bsdf type=\"coating\"><bsdf type=\"plastic\"/></bsdf>").kind == BsdfKind::kPlastic);
  CHECK(first("<bsdf type=\"roughcoating\"><float name=\"alpha\" value=\"0.3\"/><bsdf "
              "type=\"diffuse\"/></bsdf>")
            .alpha_u == 0.3);
  CHECK(
      first("<bsdf type=\"principledthin\"><rgb name=\"base_color\" value=\"0.1 0.2 0.3\"/></bsdf>")
          .diffuse == Rgb(0.1, 0.2, 0.3));
}

TEST_CASE("coatings: index, absorption across the thickness, what lies below, both sides") {
  const Bsdf varnish = bsdf(
      "<bsdf type=\"coating\"><float name=\"intIOR\" value=\"1.7\"/><float name=\"extIOR\" "
      "value=\"1\"/><float name=\"thickness\" value=\"2\"/><rgb name=\"sigmaA\" value=\"0.1 0.2 "
      "0.5\"/><rgb name=\"specularReflectance\" value=\"0.9\"/><bsdf "
      "type=\"roughconductor\"><float "
      "name=\"alpha\" value=\"0.3\"/></bsdf></bsdf>");
  CHECK(varnish.kind == BsdfKind::kRoughConductor);
  CHECK(varnish.alpha_u == 0.3);
  CHECK(varnish.coat_ior == 1.7);
  CHECK(varnish.coat_absorption == Rgb(0.2, 0.4, 1));
  CHECK(varnish.coat_specular == Rgb(0.9));
  const Bsdf plain = bsdf("<bsdf type=\"coating\"><bsdf type=\"diffuse\"/></bsdf>");
  CHECK(plain.coat_ior == Approx(1.5046 / 1.000277));
  CHECK(plain.coat_absorption == Rgb(0));
  CHECK(bsdf("<bsdf type=\"twosided\"><bsdf type=\"coating\"><bsdf "
             "type=\"conductor\"/></bsdf></bsdf>")
            .two_sided);
  CHECK(!bsdf("<bsdf type=\"diffuse\"/>").is_coated());
  CHECK_THAT(body_error("<bsdf type=\"coating\"><float name=\"intIOR\" value=\"1\"/><float "
                        "name=\"extIOR\" value=\"1.2\"/><bsdf type=\"diffuse\"/></bsdf>"),
             ContainsSubstring("expected more than 1"));
  CHECK_THAT(body_error("<bsdf type=\"coating\"/>"),
             ContainsSubstring("has no BSDF, expected one"));
  CHECK_THAT(body_error("<bsdf type=\"coating\"><bsdf type=\"dielectric\"/></bsdf>"),
             ContainsSubstring("expected a diffuse, phong, conductor or roughconductor"));
}

TEST_CASE("principled: its numbers, defaults and ranges") {
  const auto principled = [](const std::string& inside) {
    return "<bsdf type=\"principled\"><rgb name=\"base_color\" value=\"0.1 0.2 0.3\"/>" + inside +
           "</bsdf>";
  };
  const auto number = [](const char* name, const char* value) {
    return std::string("<float name=\"") + name + "\" value=\"" + value + "\"/>";
  };
  const Bsdf plain = bsdf(principled(""), "3.0.0");
  CHECK(plain.kind == BsdfKind::kPrincipled);
  CHECK(plain.diffuse == Rgb(0.1, 0.2, 0.3));
  CHECK(plain.ior == Approx(1.5));
  CHECK(plain.principled.roughness == 0.5);
  CHECK(plain.principled.metallic == 0);
  CHECK(!plain.transmits());
  CHECK(plain.has_diffuse());
  const Bsdf glass = bsdf(principled(number("spec_trans", "1") + number("eta", "1.3")), "3.0.0");
  CHECK(glass.ior == 1.3);
  CHECK(glass.transmits());
  CHECK(!glass.has_diffuse());
  const Bsdf paint =
      bsdf(principled(number("clearcoat", "0.7") + number("clearcoat_gloss", "0.2") +
                      number("sheen", "0.3") + number("sheen_tint", "0.4") +
                      number("flatness", "0.5") + number("spec_tint", "0.6") +
                      number("anisotropic", "0.8") + number("metallic", "0.9") +
                      number("roughness", "0.25") + number("main_specular_sampling_rate", "2")),
           "3.0.0");
  CHECK(paint.principled.clearcoat == 0.7);
  CHECK(paint.principled.clearcoat_gloss == 0.2);
  CHECK(paint.principled.sheen == 0.3);
  CHECK(paint.principled.sheen_tint == 0.4);
  CHECK(paint.principled.flatness == 0.5);
  CHECK(paint.principled.spec_tint == 0.6);
  CHECK(paint.principled.anisotropic == 0.8);
  CHECK(paint.principled.metallic == 0.9);
  CHECK(paint.principled.roughness == 0.25);
  CHECK_THAT(body_error(principled(number("sheen", "1.5"))),
             ContainsSubstring("sheen is 1.5, expected 0 to 1"));
  CHECK_THAT(body_error(principled(number("eta", "1.5") + number("specular", "0.5"))),
             ContainsSubstring("both eta and specular"));
  CHECK_THAT(body_error(principled(number("subsurface", "1"))), ContainsSubstring("subsurface"));
}

TEST_CASE("rough and coated BSDFs, their names and defaults") {
  const Bsdf metal = bsdf("<bsdf type=\"roughconductor\"/>");
  CHECK(metal.kind == BsdfKind::kRoughConductor);
  CHECK(metal.microfacets == Microfacets::kBeckmann);
  CHECK(metal.alpha_u == 0.1);
  CHECK(metal.alpha_v == 0.1);
  CHECK(metal.eta.x == Approx(0.2004376970 / 1.000277));
  const Bsdf brushed = bsdf(
      "<bsdf type=\"roughconductor\"><string name=\"distribution\" value=\"ggx\"/>"
      "<float name=\"alpha_u\" value=\"0.05\"/><float name=\"alpha_v\" value=\"0.3\"/></bsdf>",
      "3.0.0");
  CHECK(brushed.microfacets == Microfacets::kGgx);
  CHECK(brushed.alpha_u == 0.05);
  CHECK(brushed.alpha_v == 0.3);
  CHECK(brushed.eta == Rgb(0));
  const Bsdf plastic = bsdf("<bsdf type=\"plastic\"/>");
  CHECK(plastic.ior == Approx(1.49 / 1.000277));
  CHECK(plastic.diffuse == Rgb(0.5));
  CHECK(plastic.specular == Rgb(1));
  CHECK(!plastic.nonlinear);
  CHECK(bsdf("<bsdf type=\"roughdielectric\"/>").ior == Approx(1.5046 / 1.000277));
  CHECK(bsdf("<bsdf type=\"thindielectric\"/>").kind == BsdfKind::kThinDielectric);
  CHECK(bsdf("<bsdf type=\"null\"/>").opacity == 0);
  CHECK_THAT(body_error("<bsdf type=\"roughplastic\"><float name=\"alpha\" value=\"0\"/></bsdf>"),
             ContainsSubstring("alpha is 0, expected more than 0"));
  CHECK_THAT(body_error("<bsdf type=\"roughconductor\"><float name=\"alpha\" value=\"0.1\"/><float "
                        "name=\"alphaU\" value=\"0.1\"/></bsdf>"),
             ContainsSubstring("both alpha and alphaU"));
  CHECK_THAT(body_error("<bsdf type=\"roughconductor\"><string name=\"distribution\" "
                        "value=\"phong\"/></bsdf>"),
             ContainsSubstring("'phong' is not supported, expected beckmann or ggx"));
  CHECK_THAT(body_error("<bsdf type=\"plastic\"><float name=\"intIOR\" value=\"0.9\"/></bsdf>"),
             ContainsSubstring("expected more than 1"));
}

TEST_CASE("mask, blendbsdf and mixturebsdf: both sides, shares, what they refuse") {
  const auto disk = [](const std::string& text) {
    return load_body("<shape type=\"disk\">" + text + "</shape>");
  };
  const Scene s = disk(
      "<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.25\"/><bsdf "
      "type=\"diffuse\"/></bsdf>");
  const Bsdf front = s.bsdfs[static_cast<size_t>(s.shapes[0].bsdf)],
             back = s.bsdfs[static_cast<size_t>(s.shapes[0].back_bsdf)];
  CHECK(front.opacity == 0.25);
  CHECK(front.diffuse == Rgb(0.5));
  CHECK(back.opacity == 0.25);
  CHECK(back.diffuse == Rgb(0));
  const Bsdf blend = bsdf(
      "<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.75\"/><bsdf "
      "type=\"diffuse\"/><bsdf type=\"roughconductor\"/></bsdf>");
  CHECK(blend.shares == std::vector<double>{0.25, 0.75});
  CHECK(blend.parts.size() == 2);
  const Bsdf mix = bsdf(
      "<bsdf type=\"mixturebsdf\"><string name=\"weights\" value=\"0.9, 0.9\"/>"
      "<bsdf type=\"diffuse\"/><bsdf type=\"conductor\"/></bsdf>");
  CHECK(mix.shares == std::vector<double>{0.5, 0.5});
  CHECK_THAT(body_error("<bsdf type=\"mixturebsdf\"><string name=\"weights\" value=\"1\"/></bsdf>"),
             ContainsSubstring("has 0 BSDFs and 1 weights"));
  CHECK_THAT(body_error("<bsdf type=\"mask\"/>"), ContainsSubstring("has no BSDF"));
  // One map knows one coat, or none.
  const auto follows = [&](const std::string& inside,
                           const std::string& weights = "0.3, 0.3, 0.3") {
    const std::string file = "<bsdf type=\"mixturebsdf\"><string name=\"weights\" value=\"" +
                             weights + "\"/>" + inside + "</bsdf>";
    const Scene s = load_body("<shape type=\"disk\">" + file + "</shape>");
    std::vector<bool> followed;
    for (const int part : s.bsdfs[static_cast<size_t>(s.shapes[0].bsdf)].parts)
      followed.push_back(s.bsdfs[static_cast<size_t>(part)].follow_diffuse);
    return followed;
  };
  const std::string bare = "<bsdf type=\"diffuse\"/>", plastic = "<bsdf type=\"plastic\"/>",
                    rough_plastic = "<bsdf type=\"roughplastic\"/>",
                    metal = "<bsdf type=\"conductor\"/>";
  CHECK(follows(plastic + bare + rough_plastic) == std::vector<bool>{false, true, true});
  CHECK(follows(plastic + bare + rough_plastic, "0.3, 0.4, 0.3") ==
        std::vector<bool>{true, false, true});
  CHECK(follows(plastic + bare + bare, "0.4, 0.3, 0.3") == std::vector<bool>{true, false, false});
  CHECK(follows(bare + plastic + metal, "0, 0.2, 0.8") == std::vector<bool>{false, false, false});
  CHECK(follows(plastic + rough_plastic + plastic) == std::vector<bool>{false, true, false});
  CHECK(follows(plastic + metal + plastic) == std::vector<bool>{false, false, false});
  CHECK(follows(bare + metal + bare) == std::vector<bool>{false, false, false});
  CHECK_THAT(body_error("<bsdf type=\"twosided\"><bsdf type=\"mask\"><bsdf type=\"diffuse\"/>"
                        "</bsdf></bsdf>"),
             ContainsSubstring("it transmits"));
  CHECK_THAT(
      body_error("<shape type=\"disk\"><bsdf type=\"null\"/><emitter type=\"area\"/></shape>"),
      ContainsSubstring("emits and lets light pass"));
}

TEST_CASE("mixtures of mixtures: parts are counted, and copied only where they change") {
  std::string body = "<bsdf type=\"roughplastic\" id=\"m0\"/>";
  for (int i = 1; i <= 9; ++i)
    body +=
        fmt::format("<bsdf type=\"blendbsdf\" id=\"m{}\"><ref id=\"m{}\"/><ref id=\"m{}\"/></bsdf>",
                    i, i - 1, i - 1);
  const auto shown = [&](int i) {
    return body + fmt::format("<shape type=\"disk\"><ref id=\"m{}\"/></shape>", i);
  };
  CHECK_THAT(body_error(shown(9)),
             ContainsSubstring("has 512 parts") && ContainsSubstring("expected at most 256"));
  body.resize(body.rfind("<bsdf type=\"blendbsdf\" id=\"m9\">"));
  const Scene s = load_body(shown(8));
  const std::vector<bool> used = used_bsdfs(s);
  // The plastic, a mixture for each level, the lamp's.
  CHECK(std::count(used.begin(), used.end(), true) <= 10);
  CHECK(s.bsdfs.size() <= 20);
}

TEST_CASE("environments: one, of one radiance or with a map") {
  const Scene s = load_body(
      "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"1 2 3\"/>"
      "</emitter>");
  REQUIRE(s.lights.size() == 1);
  CHECK(s.lights[0].kind == LightKind::kEnvironment);
  CHECK(s.lights[0].intensity == Rgb(1, 2, 3));
  CHECK_THAT(body_error("<emitter type=\"constant\"/><emitter type=\"constant\"/>"),
             ContainsSubstring("second <emitter>"));
  CHECK_THAT(body_error("<emitter type=\"envmap\"/>"), ContainsSubstring("has no filename"));
  CHECK_THAT(body_error("<emitter type=\"envmap\"><string name=\"filename\" value=\"no.exr\"/>"
                        "</emitter>"),
             ContainsSubstring("no.exr' does not exist"));
}

TEST_CASE("groups and instances: meshes once, round shapes copied; merge as if outside") {
  const std::string group =
      "<shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"><bsdf type=\"dielectric\"/></shape>"
      "<shape type=\"sphere\"/><shape type=\"cylinder\"><float name=\"radius\" "
      "value=\"0.1\"/></shape></shape>";
  const auto instance = [](const std::string& inside) {
    return "<shape type=\"instance\"><ref id=\"g\"/>" + inside + "</shape>";
  };
  const std::string moved =
      "<transform name=\"toWorld\"><scale value=\"2\"/><translate x=\"5\"/></transform>";
  const Scene s = load_body(instance("") + group + instance(moved));
  // The group's cube, a sphere and a cylinder of each instance, the lamp.
  REQUIRE(s.shapes.size() == 6);
  CHECK(s.shapes[0].kind == ShapeKind::kCube);
  CHECK(s.shapes[0].group == 0);
  CHECK(s.bsdfs[static_cast<size_t>(s.shapes[0].bsdf)].kind == BsdfKind::kDielectric);
  REQUIRE(s.instances.size() == 2);
  CHECK(s.instances[0].to_world == Mat4(1));
  CHECK(Vec3(s.instances[1].to_world[3]) == Vec3(5, 0, 0));
  CHECK(Vec3(s.shapes[3].to_world[3]) == Vec3(5, 0, 0));
  CHECK(glm::length(Vec3(s.shapes[3].to_world[0])) == 2);
  CHECK(glm::length(Vec3(s.shapes[4].to_world[0])) == Approx(0.2));
  CHECK(Vec3(s.shapes[4].to_world[2]) == Vec3(0, 0, 2));
  CHECK(s.hash != load_body(instance("") + group + instance("")).hash);
  // A group that nobody shows is not there.
  CHECK(load_body(group).shapes.size() == 1);
  const Scene merged =
      load_body("<shape type=\"merge\"><shape type=\"cube\"/><shape type=\"rectangle\"/></shape>");
  CHECK(merged.shapes.size() == 3);
  CHECK(merged.hash == load_body("<shape type=\"cube\"/><shape type=\"rectangle\"/>").hash);
  CHECK_THAT(body_error("<shape type=\"instance\"/>"), ContainsSubstring("has no group"));
  CHECK_THAT(body_error("<shape type=\"cube\" id=\"g\"/>" + instance("")),
             ContainsSubstring("expected a reference to a shapegroup"));
  CHECK_THAT(body_error("<shape type=\"shapegroup\"/>"), ContainsSubstring("has no id"));
  CHECK_THAT(body_error("<shape type=\"shapegroup\" id=\"g\"/>" + instance("")),
             ContainsSubstring("has no shapes"));
  CHECK_THAT(body_error("<shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"><emitter "
                        "type=\"area\"/></shape></shape>" +
                        instance("")),
             ContainsSubstring("emits and stands in <shape type=\"shapegroup\""));
  CHECK_FALSE(s.shapes[3].uneven);
  const Scene stretched =
      load_body(group + instance("<transform name=\"toWorld\"><scale x=\"2\"/></transform>"));
  CHECK(stretched.shapes[1].uneven);
  CHECK(Vec3(stretched.shapes[1].to_world[0]) == Vec3(2, 0, 0));
  CHECK(Vec3(stretched.shapes[1].to_world[1]) == Vec3(0, 1, 0));
  CHECK(stretched.shapes[2].uneven);
}

TEST_CASE("a collimated beam: power along +z of its frame") {
  const TestFolder folder;
  const Scene s = load_scene(folder.write(
      "s.xml",
      scene_text("<shape type=\"cube\"/><emitter type=\"collimated\"><transform "
                 "name=\"toWorld\"><lookat origin=\"1,2,3\" target=\"1,2,9\" "
                 "up=\"0,1,0\"/></transform><rgb name=\"power\" value=\"1 2 3\"/></emitter>" +
                 std::string(kSensor))));
  REQUIRE(s.lights.size() == 1);
  CHECK(s.lights[0].kind == LightKind::kCollimated);
  CHECK(s.lights[0].position == Vec3(1, 2, 3));
  CHECK(s.lights[0].direction == Vec3(0, 0, 1));
  CHECK(s.lights[0].intensity == Rgb(1, 2, 3));
  CHECK_THAT(body_error("<emitter type=\"collimated\"><transform name=\"toWorld\"><scale "
                        "x=\"2\"/></transform></emitter>"),
             ContainsSubstring("the beam's transform is uneven"));
}

TEST_CASE("meshes are read at once: a file of several shapes, errors in the file's order") {
  const TestFolder folder;
  folder.write("a.obj", kTriangle);
  const auto mesh = [](const std::string& file, const std::string& steps) {
    return "<shape type=\"obj\"><string name=\"filename\" value=\"" + file +
           "\"/><transform name=\"toWorld\">" + steps + "</transform></shape>\n";
  };
  const Scene s = load_scene(folder.write(
      "scene.xml", scene_text(mesh("a.obj", "") + mesh("a.obj", "<translate z=\"2\"/>") +
                              mesh("a.obj", "<scale value=\"3\"/>") + kSensor + kLamp)));
  const Vec3 corner = s.shapes[0].mesh.positions[1];
  CHECK(s.shapes[1].mesh.positions[1] == corner + Vec3(0, 0, 2));
  CHECK(s.shapes[2].mesh.positions[1] == corner * 3.0);
  folder.write("bad.obj", "v 1 2\n");
  // Line 3 is read before line 4, whatever its mesh needs.
  const std::string file = folder.write(
      "scene.xml",
      scene_text(mesh("a.obj", "") + mesh("bad.obj", "") + mesh("none.obj", "") + kSensor + kLamp));
  CHECK_THROWS_WITH(load_scene(file), ContainsSubstring("bad.obj:1: 'v' has 2 numbers"));
  folder.write("bad.obj", kTriangle);
  CHECK_THROWS_WITH(load_scene(file),
                    ContainsSubstring("scene.xml:4") && ContainsSubstring("none.obj"));
}

TEST_CASE("triangles of equal corners are told of where it matters which of them is met") {
  const std::string diffuse = "<bsdf type=\"diffuse\"/>", lamp = "<emitter type=\"area\"/>",
                    away = "<transform name=\"toWorld\"><translate x=\"5\"/></transform>";
  const auto warnings = [](const std::string& first, const std::string& second) {
    const auto shape = [](const std::string& id, const std::string& inside) {
      return "<shape type=\"rectangle\" id=\"" + id + "\">" + inside + "</shape>";
    };
    const World world(load_body(shape("floor", first) + shape("rug", second)));
    return world.scene().warnings;
  };
  const auto one = warnings(diffuse, diffuse);
  REQUIRE(one.size() == 1);
  CHECK_THAT(one[0], ContainsSubstring("scene.xml: 2 triangles have the corners of another") &&
                         ContainsSubstring("the first triangle 0 of shape 0 (floor) and triangle 0 "
                                           "of shape 1 (rug)"));
  CHECK(warnings(lamp, lamp).size() == 1);
  CHECK(warnings(diffuse, away).empty());
  const std::string shared = "<bsdf type=\"diffuse\" id=\"paint\"/>";
  CHECK(World(load_body(shared + "<shape type=\"rectangle\"><ref id=\"paint\"/></shape>"
                                 "<shape type=\"rectangle\"><ref id=\"paint\"/></shape>"))
            .scene()
            .warnings.empty());
  // The same surface seen from the other side is black.
  CHECK(World(load_body(shared +
                        "<shape type=\"rectangle\"><ref id=\"paint\"/></shape><shape "
                        "type=\"rectangle\"><boolean name=\"flipNormals\" value=\"true\"/><ref "
                        "id=\"paint\"/></shape>"))
            .scene()
            .warnings.size() == 1);
}
