// SPDX-License-Identifier: Apache-2.0
// Each bad scene or mesh is one clear error that names file and place.
#include <cmath>

#include "golden/scene/ply.hpp"
#include "tests/catch.hpp"
#include "tests/scene_files.hpp"

using namespace photonloom;

namespace {

std::string mesh_error(const std::string& name, const std::string& bytes) {
  const TestFolder folder;
  folder.write(name, bytes);
  const std::string type = name.substr(name.rfind('.') + 1);
  try {
    load_scene(folder.write(
        "scene.xml", scene_text("<shape type=\"" + type + "\"><string name=\"filename\" value=\"" +
                                name + "\"/></shape>" + kSensor + kLamp)));
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

std::string ply(const std::string& vertices, const std::string& faces, int vertex_count = 3,
                int face_count = 1) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertex_count) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(face_count) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         vertices + faces;
}

constexpr const char* kThree = "0 0 0\n1 0 0\n0 1 0\n";

}  // namespace

TEST_CASE("files that are no scene") {
  CHECK_THAT(load_error(""), ContainsSubstring("scene.xml:1: not an XML file"));
  CHECK_THAT(load_error(std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16)),
             ContainsSubstring("scene.xml:1: not an XML file"));
  CHECK_THAT(load_error(std::string("<scene version=\"0.6.0\">\0</scene>", 33)),
             ContainsSubstring("not an XML file"));
  CHECK_THAT(load_error("<scene version=\"0.6.0\">\n<shape type=\"cube\">\n"),
             ContainsSubstring("not well-formed XML: the file ends"));
  CHECK_THAT(load_error("<scene version=\"0.6.0\">\n<shape type=\"cu"),
             ContainsSubstring("not well-formed"));
  CHECK_THAT(load_error("<scene version=\"0.6.0\"/><scene version=\"0.6.0\"/>"),
             ContainsSubstring("second top-level element"));
  CHECK_THAT(load_error("<html/>"), ContainsSubstring("<html>, expected <scene>"));
  CHECK_THAT(load_error(scene_text("words")), ContainsSubstring("scene.xml:2: text 'words"));
  CHECK_THROWS_WITH(load_scene("/nowhere/scene.xml"),
                    ContainsSubstring("/nowhere/scene.xml: cannot be read"));
  // A byte order mark is no text.
  CHECK(load_error("\xEF\xBB\xBF" + scene_text(std::string(kSensor) + kLamp)) == "");
  const TestFolder folder;
  CHECK_THROWS_WITH(load_scene(folder / ""), ContainsSubstring("cannot be read"));
}

TEST_CASE("elements a million deep") {
  std::string text = "<scene version=\"0.6.0\">\n";
  for (int i = 0; i < 1000000; ++i) text += "<bsdf type=\"twosided\">";
  CHECK_THAT(load_error(text), ContainsSubstring("not well-formed"));
  for (int i = 0; i < 1000000; ++i) text += "</bsdf>";
  CHECK_THAT(load_error(text + "</scene>"),
             ContainsSubstring("scene.xml:2: elements are nested more than 64 deep"));
}

TEST_CASE("long chains of references and growing parameters") {
  std::string chain;
  for (int i = 0; i < 5000; ++i)
    chain += "<bsdf type=\"twosided\" id=\"b" + std::to_string(i) + "\"><ref id=\"b" +
             std::to_string(i + 1) + "\"/></bsdf>";
  CHECK_THAT(body_error(chain + "<bsdf type=\"diffuse\" id=\"b5000\"/>"),
             ContainsSubstring("more than 64 deep"));
  std::string doubling = "<default name=\"a0\" value=\"xx\"/>";
  for (int i = 0; i < 60; ++i)
    doubling += "<default name=\"a" + std::to_string(i + 1) + "\" value=\"$a" + std::to_string(i) +
                "$a" + std::to_string(i) + "\"/>";
  CHECK_THAT(body_error(doubling), ContainsSubstring("longer than 65536"));
}

TEST_CASE("no light, no camera, no shape, two cameras") {
  CHECK_THAT(load_error(scene_text(std::string(kSensor) + "<shape type=\"cube\"/>")),
             ContainsSubstring("no light"));
  CHECK_THAT(load_error(scene_text(std::string(kSensor) +
                                   "<shape type=\"cube\"><emitter type=\"area\"><rgb "
                                   "name=\"radiance\" value=\"0\"/></emitter></shape>")),
             ContainsSubstring("no light"));
  CHECK_THAT(load_error(scene_text(kLamp)), ContainsSubstring("no camera"));
  CHECK_THAT(load_error(scene_text(std::string(kSensor) + "<emitter type=\"point\"/>")),
             ContainsSubstring("no shape"));
  CHECK_THAT(body_error(kSensor), ContainsSubstring("second <sensor>"));
}

TEST_CASE("numbers that are none") {
  const auto radiance = [](const std::string& value) {
    return body_error(
        "<shape type=\"disk\"><emitter type=\"area\"><rgb name=\"radiance\" value=\"" + value +
        "\"/></emitter></shape>");
  };
  CHECK_THAT(radiance("1, -2, 3"),
             ContainsSubstring("scene.xml:2") && ContainsSubstring("negative"));
  CHECK_THAT(radiance("nan"), ContainsSubstring("not a finite number"));
  CHECK_THAT(radiance("1 inf 1"), ContainsSubstring("not a finite number"));
  CHECK_THAT(radiance("1e999"), ContainsSubstring("not a finite number"));
  CHECK_THAT(radiance("1 2"), ContainsSubstring("has 2 numbers, expected 1 or 3"));
  CHECK_THAT(radiance("#12345"), ContainsSubstring("expected #rrggbb"));
  CHECK_THAT(radiance("one"), ContainsSubstring("not a finite number"));
  CHECK_THAT(body_error("<integrator type=\"path\"><integer name=\"maxDepth\" value=\"2.5\"/>"
                        "</integrator>"),
             ContainsSubstring("not an integer"));
  CHECK_THAT(
      body_error("<shape type=\"disk\"><boolean name=\"flipNormals\" value=\"yes\"/></shape>"),
      ContainsSubstring("neither true nor false"));
  CHECK_THAT(body_error("<bsdf type=\"phong\"><float name=\"exponent\" value=\"1e30\"/></bsdf>"),
             ContainsSubstring("exponent is 1e+30, expected 0 to 1e15"));
  for (const char* scale : {"0", "1e-200", "1e200"})
    CHECK_THAT(body_error(std::string("<shape type=\"cube\"><transform name=\"toWorld\"><scale "
                                      "value=\"") +
                          scale + "\"/></transform></shape>"),
               ContainsSubstring("scene.xml:2"));
}

TEST_CASE("cameras that send no rays") {
  const auto camera = [](const std::string& lines, const std::string& type = "perspective") {
    return load_error(scene_text("<sensor type=\"" + type + "\">" + lines + "</sensor>" + kLamp));
  };
  const auto line = [](const std::string& name, const std::string& value) {
    return "<float name=\"" + name + "\" value=\"" + value + "\"/>";
  };
  CHECK_THAT(camera(line("nearClip", "1e300") + line("farClip", "1e301")),
             ContainsSubstring("nearClip is 1e+300, expected 0 to 1e+18"));
  for (const char* offset : {"1e155", "-1e300"})
    CHECK_THAT(camera(line("principalPointOffsetX", offset)),
               ContainsSubstring("scene.xml:2: principalPointOffsetX is") &&
                   ContainsSubstring("expected -1e+06 to 1e+06"));
  CHECK_THAT(camera("<string name=\"focalLength\" value=\"1e-300mm\"/>"),
             ContainsSubstring("focalLength is 1e-300 mm, expected at least 1e-06 mm"));
  for (const auto& [radius, distance] :
       {std::pair("1", "1e-300"), std::pair("1e300", "1"), std::pair("1e154", "1e154")})
    CHECK_THAT(camera(line("apertureRadius", radius) + line("focusDistance", distance), "thinlens"),
               ContainsSubstring("scene.xml:2: apertureRadius is"));
  const auto looking = [&](const std::string& from, const std::string& to, const std::string& up) {
    return camera("<transform name=\"toWorld\"><lookat origin=\"" + from + "\" target=\"" + to +
                  "\" up=\"" + up + "\"/></transform>");
  };
  CHECK(looking("0,0,0", "0,0,-1", "0,1e200,0").empty());
  CHECK(looking("0,0,0", "0,0,-1", "0,1e-200,0").empty());
  CHECK(looking("0,0,0", "0,0,1e200", "0,1,0").empty());
  CHECK(looking("0,0,0", "0,0,1e-200", "0,1,0").empty());
  CHECK_THAT(looking("0,0,-1e308", "0,0,1e308", "0,1,0"), ContainsSubstring("farther apart"));
  CHECK_THAT(looking("1,2,3", "1,2,3", "0,1,0"), ContainsSubstring("from a point to itself"));
  CHECK_THAT(camera("<film type=\"hdrfilm\"><integer name=\"cropOffsetX\" "
                    "value=\"-9223372036854775808\"/></film>"),
             ContainsSubstring("cropOffsetX is -9223372036854775808, expected 0 to 767"));
  CHECK_THAT(body_error("<emitter type=\"spot\">" + line("cutoffAngle", "1e-9") +
                        line("beamWidth", "0") + "</emitter>"),
             ContainsSubstring("cutoffAngle is 1e-09, expected at least 0.0001"));
}

TEST_CASE("optics whose products are no numbers") {
  const auto bsdf = [](const std::string& type, const std::string& lines) {
    return body_error("<bsdf type=\"" + type + "\">" + lines + "</bsdf>");
  };
  const auto indices = [](const std::string& in, const std::string& out) {
    return "<float name=\"intIOR\" value=\"" + in + "\"/><float name=\"extIOR\" value=\"" + out +
           "\"/>";
  };
  for (const char* type : {"dielectric", "thindielectric", "roughdielectric", "plastic"}) {
    CHECK_THAT(bsdf(type, indices("1e200", "1e-200")),
               ContainsSubstring("scene.xml:2") && ContainsSubstring("is inf times that outside"));
    CHECK(bsdf(type, indices("1e90", "1")).empty());
  }
  for (const char* values : {"1e155", "1e300"})
    for (const char* name : {"eta", "k"})
      CHECK_THAT(bsdf("conductor", std::string("<rgb name=\"eta\" value=\"") +
                                       (name == std::string("eta") ? values : "0") +
                                       "\"/><rgb name=\"k\" value=\"" +
                                       (name == std::string("k") ? values : "0") + "\"/>"),
                 ContainsSubstring("scene.xml:2: eta or k of"));
  CHECK_THAT(bsdf("mixturebsdf",
                  "<string name=\"weights\" value=\"1e308,1e308\"/><bsdf "
                  "type=\"diffuse\"/><bsdf type=\"conductor\"/>"),
             ContainsSubstring("weights add up to inf, expected a finite number"));
}

TEST_CASE("meshes that are missing, empty or not meshes") {
  CHECK_THAT(
      body_error("<shape type=\"obj\"><string name=\"filename\" value=\"none.obj\"/></shape>"),
      ContainsSubstring("scene.xml:2") && ContainsSubstring("none.obj' does not exist"));
  CHECK_THAT(body_error("<shape type=\"ply\"/>"), ContainsSubstring("has no filename"));
  CHECK_THAT(mesh_error("a.obj", ""), ContainsSubstring("a.obj: the file has no faces"));
  CHECK_THAT(mesh_error("a.obj", "\x89PNG\r\n\x1a\n"),
             ContainsSubstring("a.obj:1") && ContainsSubstring("not supported"));
  CHECK_THAT(mesh_error("a.obj", "v 0 0\n"), ContainsSubstring("a.obj:1: 'v' has 2 numbers"));
  CHECK_THAT(mesh_error("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
             ContainsSubstring("a.obj:4: '4' is not the number of a vertex"));
  CHECK_THAT(mesh_error("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n"),
             ContainsSubstring("a.obj:4: '0'"));
  CHECK_THAT(mesh_error("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"),
             ContainsSubstring("a.obj:3: the face has 2"));
  CHECK_THAT(mesh_error("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1/1 2 3\n"),
             ContainsSubstring("a.obj:4"));
  CHECK_THAT(mesh_error("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2 3\n"),
             ContainsSubstring(
                 "a.obj:4: '1' is the number of a normal, but there is none above this line"));
  CHECK_THAT(mesh_error("a.obj", std::string("v 0 0 1\0x\n", 10)),
             ContainsSubstring("a.obj:1: '1\\x00x' is not a finite number"));
  CHECK(mesh_error("a.obj", "# c\nv 0 0 0 # c\nv 1 0 0\nv 0 1 0\nf 1 2 3 # c d\n") == "");
  CHECK(mesh_error("a.obj", "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n") == "");
  CHECK_THAT(
      body_error("<shape type=\"ply\"><string name=\"filename\" value=\"/tmp\"/></shape>"),
      ContainsSubstring("scene.xml:2") && ContainsSubstring("'/tmp' is a folder, expected a file"));
  CHECK_THAT(mesh_error("a.ply", "plz\n"), ContainsSubstring("a.ply:1: not a PLY file"));
  CHECK_THAT(mesh_error("a.ply", ply(kThree, "", 3, 0)), ContainsSubstring("no faces"));
  CHECK_THAT(mesh_error("a.ply", ply(kThree, "3 0 1 3\n")),
             ContainsSubstring("face 0: vertex number 3"));
  CHECK_THAT(mesh_error("a.ply", ply(kThree, "3 0 1 -1\n")), ContainsSubstring("vertex number -1"));
  CHECK_THAT(mesh_error("a.ply", ply(kThree, "2 0 1\n")),
             ContainsSubstring("the face has 2 vertices"));
  // A row is a line.
  CHECK_THAT(mesh_error("a.ply", ply("0 0 0\n1 0 0 9\n0 1 0\n", "3 0 1 2\n")),
             ContainsSubstring("a.ply:11: expected the line's end after the last value of a row of "
                               "element 'vertex', not '9'"));
  CHECK_THAT(mesh_error("a.ply", ply("0 0 0\n1 0\n0 0 1 0\n", "3 0 1 2\n")),
             ContainsSubstring("a.ply:11: the line ends early, before property 'z'"));
  CHECK_THAT(mesh_error("a.ply", ply(kThree, "3 0 1 2 7\n")),
             ContainsSubstring("a.ply:13: expected the line's end") && ContainsSubstring("'7'"));
  CHECK(mesh_error("a.ply", ply("\n 0 0 0 \r\n\n1 0 0\t\n0 1 0\n", "3 0 1 2")) == "");
  CHECK_THAT(mesh_error("a.ply", ply("0 0 0\n1 0\n", "", 2, 1)), ContainsSubstring("ends early"));
}

TEST_CASE("depths are named as the file names them, with both limits") {
  const auto depth = [](const std::string& line) {
    return load_error(scene_text("<integrator type=\"path\">\n<integer name=\"" + line +
                                 "\"/></integrator>" + kSensor + kLamp));
  };
  CHECK_THAT(depth("maxDepth\" value=\"99999999999"),
             ContainsSubstring("scene.xml:3: <integer name=\"maxDepth\"> is 99999999999, expected "
                               "-1 for no limit or 1 to 2147483647"));
  CHECK_THAT(depth("rrDepth\" value=\"0"),
             ContainsSubstring("<integer name=\"rrDepth\"> is 0, expected 1 to 2147483647"));
}

TEST_CASE("NaN and infinite vertices") {
  for (const char* bad : {"nan", "inf", "-inf", "1e400"}) {
    CHECK_THAT(mesh_error("a.obj", std::string("v 0 0 0\nv 1 ") + bad + " 0\nv 0 1 0\nf 1 2 3\n"),
               ContainsSubstring("a.obj:2") && ContainsSubstring("not a finite number"));
    CHECK_THAT(
        mesh_error("a.ply", ply(std::string("0 0 0\n1 ") + bad + " 0\n0 1 0\n", "3 0 1 2\n")),
        ContainsSubstring("a.ply"));
  }
  PlyTable table;
  PlyElement vertex;
  vertex.name = "vertex";
  vertex.rows = 3;
  vertex.add("x", PlyType::kFloat).values = {0, 1, 0};
  vertex.add("y", PlyType::kFloat).values = {0, std::nan(""), 1};
  vertex.add("z", PlyType::kFloat).values = {0, 0, 0};
  PlyElement face;
  face.name = "face";
  face.rows = 1;
  PlyColumn& list = face.add("vertex_indices", PlyType::kInt32);
  list.is_list = true;
  list.values = {0, 1, 2};
  list.starts = {0, 3};
  table.elements = {vertex, face};
  const TestFolder folder;
  write_ply(table, folder / "a.ply");
  CHECK_THROWS_WITH(
      load_scene(folder.write("s.xml", scene_text(std::string("<shape type=\"ply\"><string "
                                                              "name=\"filename\" value=\"a.ply\"/>"
                                                              "</shape>") +
                                                  kSensor + kLamp))),
      ContainsSubstring("a.ply: vertex 1 is not finite"));
}

TEST_CASE("triangles without area") {
  CHECK_THAT(mesh_error("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n"),
             ContainsSubstring("a.obj:6: the face has no area"));
  CHECK_THAT(mesh_error("a.obj", "v 0 0 0\nv 1e300 0 0\nv 0 1e300 0\nf 1 2 3\n"),
             ContainsSubstring("a.obj:4: a corner of the face lies 1e+300 from the origin"));
  CHECK_THAT(mesh_error("a.obj", "v 0.1 0.1 0.1\nv 0.2 0.2 0.2\nv 0.7 0.7 0.7\nf 1 2 3\n"),
             ContainsSubstring("no area"));
  CHECK_THAT(mesh_error("a.ply", ply(kThree, "3 0 1 1\n")),
             ContainsSubstring("face 0: the face has no area"));
  // Small is not degenerate, wherever it stands.
  CHECK(mesh_error("a.obj", "v 0 0 0\nv 1e-9 0 0\nv 0 1e-9 0\nf 1 2 3\n") == "");
  CHECK(mesh_error("a.obj", "v 1000 0 0\nv 1000.000001 0 0\nv 1000 0.000001 0\nf 1 2 3\n") == "");
  // A quad with a corner on its edge has area.
  CHECK(mesh_error("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nf 1 2 3 4\n") == "");
}

TEST_CASE("PLY counts larger than the file are refused before anything is reserved") {
  const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  const std::string tail =
      "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uint int vertex_indices\nend_header\n";
  CHECK_THAT(mesh_error("a.ply", head + "4000000000000" + tail), ContainsSubstring("ends early"));
  CHECK_THAT(mesh_error("a.ply", head + "9223372036854775807" + tail),
             ContainsSubstring("ends early"));
  CHECK_THAT(mesh_error("a.ply", head + "-1" + tail), ContainsSubstring("count of at least 0"));
  CHECK_THAT(mesh_error("a.ply", head + "0" + tail + "\xff\xff\xff\xff"),
             ContainsSubstring("does not fit"));
  CHECK_THAT(mesh_error("a.ply",
                        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty "
                        "half x\nend_header\n"),
             ContainsSubstring("a.ply:4: property type 'half'"));
}

namespace {

std::string picture_error(const std::string& name, const std::string& bytes) {
  const TestFolder folder;
  folder.write(name, bytes);
  try {
    load_scene(folder.write("scene.xml",
                            scene_text("<bsdf type=\"diffuse\"><texture type=\"bitmap\" "
                                       "name=\"reflectance\"><string name=\"filename\" value=\"" +
                                       name + "\"/></texture></bsdf>" + kSensor + kLamp)));
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

// A PNG that says it has so many pixels, and ends there.
std::string png_header(uint32_t width, uint32_t height) {
  std::string bytes("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  for (const uint32_t n : {width, height})
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(n >> shift & 255);
  return bytes + std::string("\x08\x02\0\0\0\0\0\0\0", 9);
}

}  // namespace

TEST_CASE("pictures that are none, empty, too large or cut short") {
  CHECK_THAT(picture_error("a.png", "no picture"),
             ContainsSubstring("scene.xml:2") && ContainsSubstring("a.png: cannot be read as PNG"));
  CHECK_THAT(picture_error("a.png", ""), ContainsSubstring("a.png: cannot be read"));
  CHECK_THAT(picture_error("a.png", png_header(0, 0)),
             ContainsSubstring("a.png: has 0 x 0 pixels, expected at least 1 x 1"));
  CHECK_THAT(picture_error("a.png", png_header(0, 7)), ContainsSubstring("a.png: has 0 x 7"));
  // Four gigabytes of texels in 41 bytes: refused by its header.
  CHECK_THAT(picture_error("a.png", png_header(40000, 36000)),
             ContainsSubstring("a.png: has 40000 x 36000 pixels, expected at most 2^26"));
  CHECK_THAT(picture_error("a.png", png_header(4, 4)), ContainsSubstring("a.png: cannot be read"));
  CHECK_THAT(picture_error("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 70000 +X 70000\n"),
             ContainsSubstring("a.hdr: "));
  CHECK_THAT(picture_error("a.exr", "\x76\x2f\x31\x01garbage"), ContainsSubstring("a.exr: "));
}

TEST_CASE("textures on meshes without coordinates, without colors, and of bad values") {
  const std::string textured =
      "<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/><bsdf "
      "type=\"diffuse\"><texture "
      "name=\"reflectance\" type=\"checkerboard\"/></bsdf></shape>";
  const TestFolder folder;
  folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto error = [&](const std::string& body) {
    try {
      load_scene(folder.write("scene.xml", scene_text(body + kSensor + kLamp)));
    } catch (const SceneError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK_THAT(error(textured),
             ContainsSubstring("scene.xml:2: <shape type=\"obj\"> has a texture, but "
                               "its file has no texture coordinates"));
  folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  CHECK(error(textured) == "");
  folder.write("b.ply", ply(kThree, "3 0 1 2\n"));
  CHECK_THAT(error("<shape type=\"ply\"><string name=\"filename\" value=\"b.ply\"/><bsdf "
                   "type=\"diffuse\"><texture name=\"reflectance\" type=\"vertexcolors\"/></bsdf>"
                   "</shape>"),
             ContainsSubstring("has a texture of vertex colors, but its file has none"));
  for (const std::string type : {"sphere", "rectangle", "cube", "disk", "cylinder"})
    CHECK_THAT(error("<shape type=\"" + type +
                     "\"><bsdf type=\"diffuse\"><texture name=\"reflectance\" "
                     "type=\"vertexcolors\"/></bsdf></shape>"),
               ContainsSubstring("<shape type=\"" + type +
                                 "\"> has a texture of vertex colors, which only meshes have"));
  CHECK_THAT(error("<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"bitmap\"/></bsdf>"),
             ContainsSubstring("has no filename"));
  CHECK_THAT(
      error("<texture type=\"scale\" id=\"a\"><ref id=\"b\"/></texture><texture type=\"scale\" "
            "id=\"b\"><ref id=\"a\"/></texture>"),
      ContainsSubstring("cyclic reference"));
  folder.write("other.xml", "<scene version=\"0.6.0\"><include filename=\"scene.xml\"/></scene>");
  CHECK_THAT(error("<include filename=\"other.xml\"/>"), ContainsSubstring("cyclic include"));
}
