// SPDX-License-Identifier: Apache-2.0
// Some sixty small scenes in the style of public ones. Each renders by path tracing and by photons,
// or is refused in one message that names every element that is not supported, with its line.
// Spellings are those of the plugin documentation: Mitsuba 0.5/0.6 (documentation.pdf, chapter 8)
// in the files of version 0.x, Mitsuba 3 (mitsuba.readthedocs.io, plugin reference) in the others.
#include <cmath>
#include <sstream>

#include "golden/image/image.hpp"
#include "golden/transport/path.hpp"
#include "golden/transport/world.hpp"
#include "tests/catch.hpp"
#include "tests/scene_files.hpp"

using namespace photonloom;

namespace {

struct File {
  const char* name;
  const char* version;
  const char* body;     // lines from 4 on; line 3 is the camera
  const char* refused;  // "LINE WORD, LINE WORD": elements that the message must name; "": renders
  const char* sensor = "perspective";          // its type
  const char* lens = "";                       // its properties
  const char* film = "<rfilter type='box'/>";  // what stands in the film, but for its size
};

constexpr File kFiles[] = {
    // Reflectances and textures.
    {"srgb", "0.5.0",
     "<shape type='rectangle'><bsdf type='diffuse'><srgb name='reflectance' "
     "value='#6d7185'/></bsdf></shape>",
     ""},
    {"bitmap", "0.6.0",
     "<shape type='rectangle'><bsdf type='diffuse'><texture type='bitmap' name='reflectance'>"
     "<string name='filename' value='wood.png'/></texture></bsdf></shape>",
     ""},
    {"bitmap filters", "0.6.0",
     "<texture type='bitmap' id='t'><string name='filename' value='wood.png'/><string "
     "name='filterType' "
     "value='ewa'/><float name='maxAnisotropy' value='8'/><string name='wrapModeU' "
     "value='clamp'/><string "
     "name='wrapModeV' value='mirror'/><float name='uscale' value='4'/><float name='voffset' "
     "value='.5'/>"
     "<float name='gamma' value='2.2'/><boolean name='cache' value='false'/></texture>\n"
     "<shape type='rectangle'><bsdf type='diffuse'><ref name='reflectance' id='t'/></bsdf></shape>",
     ""},
    {"bitmap 3", "3.0.0",
     "<shape type='rectangle'><bsdf type='diffuse'><texture name='reflectance' "
     "type='bitmap'><string "
     "name='filename' value='wood.png'/><string name='filter_type' value='nearest'/><string "
     "name='wrap_mode' value='mirror'/><boolean name='raw' value='true'/><transform "
     "name='to_uv'><scale "
     "x='2' y='2'/></transform></texture></bsdf></shape>",
     ""},
    {"checkerboard", "0.6.0",
     "<shape type='cube'><bsdf type='diffuse'><texture type='checkerboard' "
     "name='reflectance'><float "
     "name='uvscale' value='6'/><spectrum name='color0' value='0.1'/></texture></bsdf></shape>",
     ""},
    {"checkerboard 3", "3.0.0",
     "<shape type='cube'><bsdf type='diffuse'><texture type='checkerboard' name='reflectance'><rgb "
     "name='color0' value='.1'/><rgb name='color1' value='.5'/><transform name='to_uv'><scale "
     "value='10'/>"
     "</transform></texture></bsdf></shape>",
     ""},
    {"scale", "0.6.0",
     "<shape type='disk'><bsdf type='diffuse'><texture type='scale' name='reflectance'><float "
     "name='scale' "
     "value='0.5'/><texture type='bitmap'><string name='filename' "
     "value='wood.png'/></texture></texture>"
     "</bsdf></shape>",
     ""},
    {"vertex colors", "0.6.0",
     "<shape type='ply'><string name='filename' value='colored.ply'/><bsdf type='diffuse'><texture "
     "type='vertexcolors' name='reflectance'/></bsdf></shape>",
     ""},
    {"mesh attribute", "3.0.0",
     "<shape type='ply'><string name='filename' value='colored.ply'/><bsdf type='diffuse'><texture "
     "type='mesh_attribute' name='reflectance'><string name='name' "
     "value='vertex_color'/></texture></bsdf>"
     "</shape>",
     ""},
    {"grid and wireframe", "0.6.0",
     "<shape type='rectangle'><bsdf type='diffuse'>\n<texture type='gridtexture' "
     "name='reflectance'/></bsdf>"
     "</shape>\n<shape type='cube'><bsdf type='diffuse'><texture type='wireframe' "
     "name='reflectance'/></bsdf>"
     "</shape>",
     "5 gridtexture, 6 wireframe"},
    // Rough and coated.
    {"roughconductor", "0.6.0",
     "<shape type='sphere'><bsdf type='roughconductor'><string name='material' value='Cu'/><string "
     "name='distribution' value='beckmann'/><float name='alpha' value='0.1'/></bsdf></shape>",
     ""},
    {"anisotropic", "0.5.0",
     "<shape type='sphere'><bsdf type='roughconductor'><string name='material' value='Al'/><string "
     "name='distribution' value='ggx'/><float name='alphaU' value='0.05'/><float name='alphaV' "
     "value='0.3'/>"
     "</bsdf></shape>",
     ""},
    {"ashikhmin", "0.5.0",
     "<shape type='sphere'><bsdf type='roughconductor'>\n<string name='distribution' "
     "value='phong'/></bsdf>"
     "</shape>",
     "5 phong"},
    {"roughconductor 3", "3.5.0",
     "<shape type='sphere'><bsdf type='roughconductor'><string name='material' value='Al'/><string "
     "name='distribution' value='ggx'/><float name='alpha_u' value='0.05'/><float name='alpha_v' "
     "value='0.3'/></bsdf></shape>",
     ""},
    {"textured alpha", "3.0.0",
     "<shape type='rectangle'><bsdf type='roughconductor'><texture name='alpha' "
     "type='bitmap'><string "
     "name='filename' value='wood.png'/><boolean name='raw' "
     "value='true'/></texture></bsdf></shape>",
     ""},
    {"roughdielectric", "0.6.0",
     "<shape type='sphere'><bsdf type='roughdielectric'><string name='distribution' "
     "value='beckmann'/><float "
     "name='alpha' value='0.1'/><string name='intIOR' value='bk7'/><string name='extIOR' "
     "value='air'/></bsdf>"
     "</shape>",
     ""},
    {"roughdielectric 3", "3.0.0",
     "<shape type='sphere'><bsdf type='roughdielectric'><string name='distribution' "
     "value='ggx'/><float "
     "name='alpha' value='0.304'/><string name='int_ior' value='bk7'/><string name='ext_ior' "
     "value='air'/>"
     "</bsdf></shape>",
     ""},
    {"thindielectric", "0.6.0",
     "<shape type='rectangle'><bsdf type='thindielectric'><string name='intIOR' "
     "value='bk7'/></bsdf></shape>",
     ""},
    {"plastic", "0.6.0",
     "<shape type='sphere'><bsdf type='plastic'><srgb name='diffuseReflectance' "
     "value='#18455c'/><float "
     "name='intIOR' value='1.9'/></bsdf></shape>",
     ""},
    {"plastic 3", "3.0.0",
     "<shape type='sphere'><bsdf type='plastic'><rgb name='diffuse_reflectance' value='0.1, 0.27, "
     "0.36'/>"
     "<float name='int_ior' value='1.9'/><boolean name='nonlinear' value='true'/></bsdf></shape>",
     ""},
    {"roughplastic", "0.6.0",
     "<shape type='sphere'><bsdf type='twosided'><bsdf type='roughplastic'><string "
     "name='distribution' "
     "value='beckmann'/><float name='intIOR' value='1.61'/><spectrum name='diffuseReflectance' "
     "value='0'/>"
     "</bsdf></bsdf></shape>",
     ""},
    {"coating", "0.6.0",
     "<shape type='sphere'><bsdf type='coating'><float name='intIOR' value='1.7'/><bsdf "
     "type='roughconductor'><string name='material' value='Cu'/><float name='alpha' "
     "value='0.1'/></bsdf></bsdf></shape>",
     ""},
    {"tinted coating", "0.5.0",
     "<shape type='sphere'><bsdf type='twosided'><bsdf type='coating'><float name='thickness' "
     "value='5'/><spectrum name='sigmaA' value='0.1, 0.2, 0.5'/><bsdf type='phong'/></bsdf></bsdf>"
     "</shape>",
     ""},
    {"rough coating", "0.6.0",
     "<shape type='sphere'>\n<bsdf type='roughcoating'><float name='alpha' value='0.1'/><bsdf "
     "type='diffuse'/></bsdf></shape>\n<shape type='cube'><bsdf type='coating'><bsdf "
     "type='plastic'/></bsdf></shape>",
     "5 roughcoating, 6 coating"},
    {"bump", "0.4.4",
     "<shape type='sphere'>\n<bsdf type='bump'><texture type='scale'><float name='scale' "
     "value='10'/>"
     "<texture type='bitmap'><string name='filename' value='wood.png'/></texture></texture><bsdf "
     "type='roughplastic'/></bsdf></shape>",
     ""},
    {"normal map 3", "3.0.0",
     "<shape type='rectangle'><bsdf type='normalmap'><texture name='normalmap' "
     "type='bitmap'><boolean name='raw' value='true'/><string name='filename' value='wood.png'/>"
     "</texture><bsdf type='roughplastic'/></bsdf></shape>",
     ""},
    {"bump 3", "3.0.0",
     "<shape type='sphere'><bsdf type='bumpmap'><texture name='arbitrary' type='bitmap'><boolean "
     "name='raw' value='true'/><string name='filename' value='wood.png'/></texture><bsdf "
     "type='twosided'><bsdf type='diffuse'/></bsdf><float name='scale' value='0.1'/></bsdf>"
     "</shape>",
     ""},
    {"blended bumps", "0.6.0",
     "<texture type='checkerboard' id='t'/><shape type='sphere'>\n<bsdf type='blendbsdf'><float "
     "name='weight' value='0.5'/><bsdf type='diffuse'/><bsdf type='bumpmap'><ref id='t'/><bsdf "
     "type='diffuse'/></bsdf></bsdf></shape>",
     "5 blendbsdf"},
    // Shapes.
    {"cylinder", "0.6.0",
     "<shape type='cylinder'><point name='p0' x='0' y='-1' z='0'/><point name='p1' x='0' y='1' "
     "z='0'/><float name='radius' value='0.3'/><bsdf type='twosided'><bsdf "
     "type='diffuse'/></bsdf></shape>",
     ""},
    {"instances", "0.6.0",
     "<shape type='shapegroup' id='myShapeGroup'><shape type='ply'><string name='filename' "
     "value='colored.ply'/><bsdf type='twosided'><bsdf type='roughconductor'/></bsdf></shape>"
     "</shape><shape type='instance'><ref id='myShapeGroup'/><transform name='toWorld'><rotate "
     "x='1' angle='45'/><scale value='1.5'/><translate z='1'/></transform></shape><shape "
     "type='instance'><ref id='myShapeGroup'/></shape>",
     ""},
    {"instances 3", "3.0.0",
     "<shape type='shapegroup' id='my_shape_group'><shape type='cube'/><shape type='sphere'/>"
     "</shape><shape type='instance'><ref id='my_shape_group'/><transform name='to_world'><scale "
     "value='0.3'/></transform></shape>",
     ""},
    {"merge 3", "3.0.0",
     "<shape type='merge'><shape type='cube'/><shape type='rectangle'/></shape>", ""},
    {"lamp in a group", "0.6.0",
     "<shape type='shapegroup' id='g'>\n<shape type='cube'><emitter type='area'/></shape>"
     "</shape><shape type='instance'><ref id='g'/></shape>",
     "5 emits"},
    // Spectra.
    {"spectrum list", "0.6.0",
     "<shape type='sphere'><bsdf type='diffuse'><spectrum name='reflectance' value='400:0.56, "
     "500:0.18, 600:0.58, 700:0.24'/></bsdf></shape>",
     ""},
    {"spectrum file", "0.6.0",
     "<shape type='sphere'><bsdf type='diffuse'><spectrum name='reflectance' "
     "filename='paint.spd'/></bsdf></shape>",
     ""},
    {"blackbody 3", "3.0.0",
     "<shape type='sphere'><emitter type='area'><spectrum type='blackbody' name='radiance'><float "
     "name='temperature' value='5000'/></spectrum></emitter></shape>",
     ""},
    {"blackbody", "0.6.0",
     "<shape type='sphere'/><emitter type='spot'><blackbody name='intensity' "
     "temperature='5000K'/></emitter>",
     ""},
    {"principled", "3.0.0",
     "<shape type='sphere'><bsdf type='principled'><rgb name='base_color' "
     "value='1.0,1.0,1.0'/><float name='metallic' value='0.7'/><float name='specular' "
     "value='0.6'/><float name='roughness' value='0.2'/><float name='spec_tint' "
     "value='0.4'/><float name='anisotropic' value='0.5'/><float name='sheen' value='0.3'/><float "
     "name='sheen_tint' value='0.2'/><float name='clearcoat' value='0.6'/><float "
     "name='clearcoat_gloss' value='0.3'/><float name='spec_trans' value='0.4'/></bsdf></shape>",
     ""},
    {"textured principled", "3.0.0",
     "<shape type='rectangle'><bsdf type='twosided'><bsdf type='principled'><texture "
     "type='bitmap' name='base_color'><string name='filename' value='wood.png'/></texture><texture "
     "type='bitmap' name='roughness'><string name='filename' value='wood.png'/><boolean "
     "name='raw' value='true'/></texture></bsdf></bsdf></shape>",
     ""},
    {"collimated", "0.5.0",
     "<shape type='cube'/><emitter type='collimated'><transform name='toWorld'><lookat origin='1, "
     "1, -3' target='0, 0, 0'/></transform><spectrum name='power' value='2'/></emitter>",
     ""},
    {"principledthin", "3.0.0",
     "<shape type='rectangle'>\n<bsdf type='principledthin'><float name='diff_trans' "
     "value='0.6'/></bsdf></shape>\n<shape type='cube'><bsdf type='principled'><texture "
     "type='bitmap' name='clearcoat'><string name='filename' value='wood.png'/></texture></bsdf>"
     "</shape>",
     "5 principledthin, 6 clearcoat"},
    {"ward and hair", "0.6.0",
     "<shape type='sphere'>\n<bsdf type='ward'/></shape>\n<shape type='hair'><string "
     "name='filename' "
     "value='h'/>\n<bsdf type='irawan'/></shape>",
     "5 ward, 6 hair, 7 irawan"},
    // Openings and mixtures.
    {"mask", "0.6.0",
     "<shape type='rectangle'><bsdf type='mask'><texture type='bitmap' name='opacity'><string "
     "name='filename' value='leaf.png'/><string name='channel' value='a'/></texture><bsdf "
     "type='twosided'>"
     "<bsdf type='diffuse'/></bsdf></bsdf></shape>",
     ""},
    {"mask 3", "3.0.0",
     "<shape type='rectangle'><bsdf type='mask'><bsdf type='twosided'><bsdf "
     "type='diffuse'/></bsdf><texture "
     "type='bitmap' name='opacity'><string name='filename' "
     "value='wood.png'/></texture></bsdf></shape>",
     ""},
    {"null", "0.6.0", "<shape type='cube'><bsdf type='null'/></shape><shape type='disk'/>", ""},
    {"blend", "0.6.0",
     "<shape type='rectangle'><bsdf type='blendbsdf'><texture name='weight' type='bitmap'><string "
     "name='filename' value='wood.png'/></texture><bsdf type='conductor'/><bsdf "
     "type='diffuse'/></bsdf>"
     "</shape>",
     ""},
    {"mixture", "0.6.0",
     "<shape type='sphere'><bsdf type='mixturebsdf'><string name='weights' value='0.7, 0.3'/><bsdf "
     "type='dielectric'/><bsdf type='dielectric'><spectrum name='specularReflectance' "
     "value='0.5'/></bsdf>"
     "</bsdf></shape>",
     ""},
    // Light.
    {"constant", "0.6.0",
     "<shape type='cube'/><emitter type='constant'><spectrum name='radiance' "
     "value='0.5'/></emitter>",
     ""},
    {"envmap", "0.6.0",
     "<shape type='sphere'/><emitter type='envmap'><string name='filename' value='sky.exr'/><float "
     "name='scale' value='2'/><transform name='toWorld'><rotate y='1' "
     "angle='90'/></transform></emitter>",
     ""},
    {"envmap 3", "3.0.0",
     "<shape type='sphere'/><emitter type='envmap'><string name='filename' "
     "value='wood.png'/></emitter>",
     ""},
    {"sunsky", "0.6.0",
     "<shape type='sphere'/>\n<emitter type='sunsky'><float name='turbidity' value='3'/></emitter>",
     "5 sunsky"},
    {"textured lamp", "3.0.0",
     "<shape type='rectangle'><emitter type='area'><texture type='bitmap' name='radiance'><string "
     "name='filename' value='wood.png'/></texture></emitter></shape>",
     ""},
    {"luminaire", "0.3.0",
     "<shape type='disk'><bsdf type='diffuse'/></shape><luminaire type='constant'><rgb "
     "name='intensity' "
     "value='1'/></luminaire>",
     ""},
    // Cameras and films.
    {"thinlens", "0.6.0", "<shape type='cube'/>", "", "thinlens",
     "<float name='apertureRadius' value='0.1'/><float name='focusDistance' value='3'/><float "
     "name='fov' value='35'/><float name='shutterOpen' value='0'/>"},
    {"thinlens 3", "3.0.0", "<shape type='cube'/>", "", "thinlens",
     "<float name='aperture_radius' value='0.1'/><float name='focus_distance' value='3'/><float "
     "name='fov' value='35'/><string name='fov_axis' value='smaller'/>"},
    {"orthographic", "0.6.0", "<shape type='cube'/>", "", "orthographic"},
    {"no filter", "0.6.0", "<shape type='cube'/>", "", "perspective", "", ""},
    {"mitchell", "0.6.0", "<shape type='cube'/>", "", "perspective", "",
     "<rfilter type='mitchell'><float name='B' value='0.2'/></rfilter><boolean name='banner' "
     "value='false'/><string name='pixelFormat' value='rgb'/>"},
    {"crop", "0.6.0", "<shape type='cube'/>", "", "perspective", "",
     "<integer name='cropOffsetX' value='1'/><integer name='cropWidth' value='2'/><rfilter "
     "type='lanczos'><integer name='lobes' value='2'/></rfilter>"},
    {"crop 3", "3.0.0", "<shape type='cube'/>", "", "perspective",
     "<float name='principal_point_offset_x' value='0.1'/>",
     "<integer name='crop_offset_y' value='1'/><integer name='crop_height' value='3'/><rfilter "
     "type='gaussian'><float name='stddev' value='0.4'/></rfilter>"},
    {"spherical", "0.6.0", "<shape type='cube'/>", "3 spherical", "spherical"},
    // What stays outside.
    {"fog", "0.6.0",
     "<medium type='homogeneous' id='fog'><spectrum name='sigmaT' value='1'/></medium>\n<shape "
     "type='cube'>"
     "<bsdf type='null'/>\n<ref name='interior' id='fog'/></shape><shape type='disk'/>",
     "4 homogeneous, 6 homogeneous"},
    {"skin", "0.6.0",
     "<shape type='sphere'>\n<subsurface type='dipole'/></shape>\n<shape type='heightfield'/>",
     "5 dipole, 6 heightfield"},
    {"polarised", "3.0.0",
     "<shape type='sphere'><bsdf type='diffuse'/></shape>\n<shape type='rectangle'><bsdf "
     "type='polarizer'/>"
     "</shape>\n<shape type='sdfgrid'/>",
     "5 polarizer, 6 sdfgrid"},
    {"projector", "0.6.0",
     "<shape type='cube'/>\n<emitter type='projector'/>\n<bsdf type='diffuse'><float name='glow' "
     "value='2'/>"
     "</bsdf>",
     "5 projector, 6 glow"},
};

std::string with_double_quotes(std::string text) {
  for (char& c : text)
    if (c == '\'') c = '"';
  return text;
}

void write_pictures(const TestFolder& folder) {
  std::vector<uint8_t> rgb;
  for (int i = 0; i < 4 * 4; ++i)
    for (int c = 0; c < 3; ++c) rgb.push_back(static_cast<uint8_t>(10 * i + 20 * c + 30));
  write_png(rgb, 4, 4, folder / "wood.png");
  // A TGA by its bytes, so that there is one with alpha: 2 x 1, 32 bits.
  folder.write("leaf.png", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\1\0\40\10", 18) +
                               std::string("\20\40\60\377\20\40\60\100", 8));
  folder.write("paint.spd", "400 0.1\n550 0.7\n700 0.3\n");
  Image sky;
  sky.width = 4;
  sky.height = 2;
  for (const char* c : {"R", "G", "B"}) {
    sky.add(c);
    for (float& p : sky.channels.back().pixels) p = 0.5f;
  }
  sky.channels[0].pixels[3] = 20;
  write_exr(sky, folder / "sky.exr");
  folder.write(
      "colored.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n-1 -1 0 255 0 0\n1 -1 0 0 255 0\n"
      "0 1 0 0 0 255\n3 0 1 2\n");
}

}  // namespace

TEST_CASE("small files in the style of public scenes render, or are refused whole") {
  static_assert(std::size(kFiles) == 65);
  const TestFolder folder;
  write_pictures(folder);
  for (const File& f : kFiles) {
    INFO(f.name);
    const bool old = std::string(f.version) < "0.4";
    const std::string sensor = old ? "camera" : "sensor";
    const std::string path = folder.write(
        "scene.xml",
        "<scene version=\"" + std::string(f.version) + "\">\n\n" +
            with_double_quotes(
                "<" + sensor + " type='" + f.sensor + "'>" + f.lens +
                "<transform name='toWorld'><translate z='-4'/></transform><film "
                "type='hdrfilm'><integer name='width' value='4'/><integer name='height' "
                "value='4'/>" +
                f.film + "</film></" + sensor + ">\n" + f.body) +
            "\n<" + (old ? "luminaire" : "emitter") + " type=\"point\"/></scene>");
    if (*f.refused) {
      std::string message;
      try {
        load_scene(path);
      } catch (const SceneError& error) {
        message = error.what();
      }
      size_t count = 0;
      std::istringstream words(f.refused);
      std::string line, word;
      while (words >> line >> word) {
        if (word.back() == ',') word.pop_back();
        ++count;
        bool found = false;
        std::istringstream lines(message);
        for (std::string text; std::getline(lines, text);)
          found = found || (text.find("scene.xml:" + line + ": ") != std::string::npos &&
                            text.find(word) != std::string::npos);
        INFO(line << " " << word << " in\n" << message);
        CHECK(found);
      }
      if (count > 1)
        CHECK_THAT(message,
                   ContainsSubstring(std::to_string(count) + " elements are not supported"));
    }
    // What is refused renders with its substitutes.
    const Scene scene = load_scene(path, {}, Unsupported::kSubstitute);
    CHECK(scene.substitutions.empty() == !*f.refused);
    const World world(scene);
    const auto embree = make_embree(world);
    PathOptions options;
    options.spp = 4;
    double sum = 0;
    for (const Channel& c : render_path(world, *embree, options).channels)
      for (const float p : c.pixels) {
        REQUIRE(std::isfinite(p));
        sum += static_cast<double>(p);
      }
    CHECK(sum > 0);
    const auto bvh = make_double_bvh(world);
    for (const Photon& p : trace_global_photons(world, *bvh, 50, 1).photons)
      REQUIRE(std::isfinite(p.power.x + p.power.y + p.power.z));
  }
}
