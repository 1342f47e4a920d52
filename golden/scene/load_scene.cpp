// SPDX-License-Identifier: Apache-2.0
// What the elements of a scene file mean. docs/scene.md lists every element and property.
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <tuple>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/text.hpp"
#include "golden/scene/findings.hpp"
#include "golden/scene/mesh.hpp"
#include "golden/scene/properties.hpp"
#include "golden/scene/read_bsdf.hpp"
#include "golden/scene/scene.hpp"
#include "golden/scene/serialized.hpp"
#include "golden/scene/xml.hpp"

namespace photonloom {
namespace {

constexpr int64_t kMaxFilm = 16384;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Loader {
 public:
  Loader(const std::string& path, const Parameters& parameters, Unsupported unsupported)
      : path_(path),
        unsupported_(unsupported),
        document_(read_document(path, parameters)),
        materials_(document_, scene_, findings_) {}

  Scene load() {
    try {
      read();
    } catch (const SceneError& error) {
      // What is wrong and what is not supported, in one message.
      if (findings_.none() || unsupported_ == Unsupported::kSubstitute) throw;
      throw SceneError(fmt::format("{}\n{}", error.what(), findings_.message()));
    }
    if (!findings_.none()) {
      if (unsupported_ == Unsupported::kRefuse) throw SceneError(findings_.message());
      scene_.substitutions = findings_.substitutions();
    }
    scene_.hash = scene_hash(scene_);
    scene_.files.push_back(path_);
    scene_.files.insert(scene_.files.end(), document_.found.begin(), document_.found.end());
    return std::move(scene_);
  }

 private:
  void read() {
    scene_.name = path_.substr(folder_of(path_).size());
    if (const size_t dot = scene_.name.rfind('.'); dot != std::string::npos && dot > 0)
      scene_.name.resize(dot);
    // Attributes other than the version name schemas.
    Properties root(document_, *document_.root);
    // Settings of Mitsuba's ray tracing kernel and scheduler.
    root.ignore({"kd_intersection_cost", "kd_traversal_cost", "kd_empty_space_bonus",
                 "kd_max_depth", "kd_max_bad_refines", "kd_stop_prims", "kd_clip",
                 "kd_min_max_bins", "kd_retract_bad_splits", "kd_exact_prim_threshold",
                 "kd_parallel_build", "block_size"});
    root.finish(findings_);
    read_meshes();
    for (const auto& child : root.children()) {
      const Element& e = *child.object;
      if (child.place->tag == "ref") {
        findings_.add(*child.place,
                      fmt::format("<ref> to {} is not supported at the top level", describe(e)),
                      "it is left out");
      } else if (e.tag == "integrator") {
        once(e, integrator_);
        integrator(e);
      } else if (e.tag == "sensor") {
        once(e, sensor_);
        sensor(e);
      } else if (e.tag == "bsdf") {
        materials_.bsdf(e);
      } else if (e.tag == "texture") {
        materials_.texture(e);
      } else if (e.tag == "shape") {
        shape(e);
      } else if (e.tag == "emitter") {
        light(e);
      } else if (e.tag == "sampler" || e.tag == "film" || e.tag == "rfilter") {
        // Takes part only where a sensor refers to it.
        if (!e.find("id")) fail(e, fmt::format("{} has no place at the top level", describe(e)));
      } else {
        findings_.add(e,
                      fmt::format("{} is not supported, expected integrator, sensor, bsdf, "
                                  "texture, shape or emitter",
                                  describe(e)),
                      "it is left out");
      }
    }
    if (!findings_.none() && unsupported_ == Unsupported::kRefuse) return;
    if (!sensor_) whole("the scene has no camera, expected one <sensor type=\"perspective\">");
    if (scene_.shapes.empty()) whole("the scene has no shape");
    if (!has_light_) whole("the scene has no light, expected an <emitter> that is not black");
  }

  [[noreturn]] void whole(const std::string& what) const {
    throw SceneError(fmt::format("{}: {}", path_, what));
  }

  void warn(const Element& e, const std::string& what) {
    scene_.warnings.push_back(fmt::format("{}:{}: {}", *e.file, e.line, what));
  }

  static void once(const Element& e, const Element*& first) {
    if (first)
      fail(e, fmt::format("second <{}>, first in line {}; expected one", e.tag, first->line));
    first = &e;
  }

  void no_children(const Properties& p) { p.no_rest(findings_); }

  void unknown_type(const Element& e, const char* expected, const std::string& instead) {
    findings_.add(e, fmt::format("{} is not supported, expected type {}", describe(e), expected),
                  instead);
  }

  // Any integrator is welcome: it chooses a method. Depths count; what changes the image does not.
  void integrator(const Element& e) {
    Properties p(document_, e);
    bool found = false;
    depth(p, found, 0);
  }

  void depth(Properties& p, bool& found, int level) {
    if (p.boolean("hide_emitters", false))
      findings_.add(p.element("hide_emitters"), "hidden emitters are not supported, expected false",
                    "they are seen");
    if (p.has("max_depth") && !found) {
      const int64_t depth = p.integer("max_depth", -1);
      if (depth != -1 && (depth < 1 || depth > std::numeric_limits<int>::max()))
        fail(p.element("max_depth"),
             fmt::format("{} is {}, expected -1 for no limit or 1 to {}",
                         describe(p.element("max_depth")), depth, std::numeric_limits<int>::max()));
      scene_.max_depth = static_cast<int>(depth);
      if (p.has("rr_depth")) scene_.rr_depth = roulette_depth(p);
      found = true;
    } else if (p.has("rr_depth") && !found) {
      scene_.rr_depth = roulette_depth(p);
    }
    p.ignore_all();
    for (const auto& child : p.children()) {
      if (child.object->tag != "integrator" || level > 8) continue;
      Properties nested(document_, *child.object);
      depth(nested, found, level + 1);
    }
  }

  static int roulette_depth(Properties& p) {
    const int64_t depth = p.integer("rr_depth", 5);
    if (depth < 1 || depth > std::numeric_limits<int>::max())
      fail(p.element("rr_depth"),
           fmt::format("{} is {}, expected 1 to {}", describe(p.element("rr_depth")), depth,
                       std::numeric_limits<int>::max()));
    return static_cast<int>(depth);
  }

  void sensor(const Element& e) {
    Properties p(document_, e);
    Camera& camera = scene_.camera;
    const bool parallel = p.type() == "orthographic", thin = p.type() == "thinlens";
    const bool known = parallel || thin || p.type() == "perspective";
    if (!known)
      unknown_type(e, "perspective, thinlens or orthographic",
                   "a perspective camera stands for it");
    camera.to_world = p.transform("to_world");
    if (parallel) {
      camera.kind = CameraKind::kOrthographic;
    } else {
      // As Mitsuba, which tests with the same tolerance.
      const glm::dmat3 linear(camera.to_world);
      for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
          if (std::fabs(glm::dot(linear[i], linear[j]) - (i == j)) > 1e-3)
            fail(p.element("to_world"),
                 "the camera's transform scales or shears, expected rotations and translations "
                 "only");
      field_of_view(p);
    }
    camera.near_clip = p.number("near_clip", 0);
    camera.far_clip = p.number("far_clip", kInfinity);
    if (!(camera.near_clip >= 0 && camera.near_clip <= kFarthestClip))
      fail(p.element("near_clip"),
           fmt::format("{} is {}, expected 0 to {:g}", p.element("near_clip")["name"],
                       camera.near_clip, kFarthestClip));
    if (!(camera.far_clip > camera.near_clip))
      fail(p.element("far_clip"), "far_clip is not beyond near_clip");
    if (thin) aperture(p);
    if (!parallel) {
      camera.offset_x = offset(p, "principal_point_offset_x");
      camera.offset_y = offset(p, "principal_point_offset_y");
    }
    if (p.has("kc") && p.text("kc", "") != "0, 0" && p.text("kc", "") != "0,0")
      findings_.add(p.element("kc"), "lens distortion (kc) is not supported", "the lens has none");
    // A pinhole is in focus everywhere, and nothing moves while the shutter is open.
    if (!thin) p.ignore({"focus_distance"});
    p.ignore({"shutter_open", "shutter_close"});
    if (known) p.finish(findings_);
    scene_.film.filter = gaussian(0.5);  // Mitsuba's default
    const Element *film_place = nullptr, *sampler_place = nullptr;
    for (const auto& child : p.children()) {
      if (child.object->tag == "film") {
        once(*child.object, film_place);
        film(*child.object);
      } else if (child.object->tag == "sampler") {
        once(*child.object, sampler_place);
        sampler(*child.object);
      } else {
        findings_.add(*child.place,
                      fmt::format("{} is not supported in {}, expected film or sampler",
                                  describe(*child.object), describe(e)),
                      "it is left out");
      }
    }
  }

  static constexpr double kFarthestClip = 1e18;

  // Of the principal point, in widths or heights of the film.
  static double offset(Properties& p, const char* name) {
    constexpr double kFarthest = 1e6;
    const double value = p.number(name, 0);
    if (!(std::fabs(value) <= kFarthest))
      fail(p.element(name), fmt::format("{} is {}, expected {:g} to {:g}", p.element(name)["name"],
                                        value, -kFarthest, kFarthest));
    return value;
  }

  // A lens without an aperture is a pinhole.
  void aperture(Properties& p) {
    Camera& camera = scene_.camera;
    if (!p.has("aperture_radius"))
      fail(p.object(), fmt::format("{} has no apertureRadius", describe(p.object())));
    camera.aperture_radius = p.number("aperture_radius", 0);
    if (camera.aperture_radius < 0)
      fail(p.element("aperture_radius"),
           fmt::format("apertureRadius is {}, expected at least 0", camera.aperture_radius));
    constexpr double kFarClip = 10000;  // Mitsuba's
    camera.focus_distance =
        p.number("focus_distance", std::isinf(camera.far_clip) ? kFarClip : camera.far_clip);
    if (!(camera.focus_distance > 0))
      fail(p.element("focus_distance"),
           fmt::format("focusDistance is {}, expected more than 0", camera.focus_distance));
    // Rays from the lens's rim are directions still.
    constexpr double kWidest = 1e6;
    if (!(camera.aperture_radius <= kWidest * camera.focus_distance &&
          camera.aperture_radius <= kFarthestClip))
      fail(
          p.element("aperture_radius"),
          fmt::format("apertureRadius is {} at a focusDistance of {}, expected at most {:g} and at "
                      "most {:g} times focusDistance",
                      camera.aperture_radius, camera.focus_distance, kFarthestClip, kWidest));
    if (camera.aperture_radius > 0)
      camera.kind = CameraKind::kThinLens;
    else
      camera.focus_distance = 0;
  }

  void field_of_view(Properties& p) {
    Camera& camera = scene_.camera;
    if (p.has("fov") && p.has("focal_length"))
      fail(p.element("focal_length"), "the sensor has both fov and focalLength, expected one");
    if (p.has("fov")) {
      camera.fov = p.number("fov", 0);
      if (!(camera.fov > 0 && camera.fov < 180))
        fail(p.element("fov"),
             fmt::format("fov is {} degrees, expected more than 0 and less than 180", camera.fov));
      const std::string axis = p.text("fov_axis", "x");
      constexpr std::pair<const char*, FovAxis> kAxes[] = {{"x", FovAxis::kX},
                                                           {"y", FovAxis::kY},
                                                           {"diagonal", FovAxis::kDiagonal},
                                                           {"smaller", FovAxis::kSmaller},
                                                           {"larger", FovAxis::kLarger}};
      const auto at = std::find_if(std::begin(kAxes), std::end(kAxes),
                                   [&](const auto& a) { return axis == a.first; });
      if (at == std::end(kAxes))
        fail(p.element("fov_axis"),
             fmt::format("fovAxis '{}' is unknown, expected x, y, diagonal, smaller or larger",
                         axis));
      camera.fov_axis = at->second;
      return;
    }
    // A focal length on 35 mm film, 36 by 24 mm, gives the field of view along the diagonal.
    std::string length = p.text("focal_length", "50mm");
    p.ignore({"fov_axis"});
    if (length.ends_with("mm")) length.resize(length.size() - 2);
    const auto value = parse_double(length);
    if (!value || !(*value > 0) || !std::isfinite(*value))
      fail(p.element("focal_length"), "focalLength is not a length like 50mm");
    camera.fov = 2 * angle_of(2 * *value, std::sqrt(36.0 * 36.0 + 24.0 * 24.0)) * 180 / kPi;
    camera.fov_axis = FovAxis::kDiagonal;
    constexpr double kShortest = 1e-6;
    if (*value < kShortest)
      fail(p.element("focal_length"),
           fmt::format("focalLength is {} mm, expected at least {:g} mm", *value, kShortest));
  }

  void film(const Element& e) {
    Properties p(document_, e);
    if (p.type() != "hdrfilm" && p.type() != "tiledhdrfilm" && p.type() != "ldrfilm" &&
        p.type() != "mfilm")
      unknown_type(e, "hdrfilm, tiledhdrfilm, ldrfilm or mfilm", "an hdrfilm stands for it");
    const bool matrix = p.type() == "mfilm";
    const int64_t width = p.integer("width", matrix ? 1 : 768);
    const int64_t height = p.integer("height", matrix ? 1 : 576);
    for (const auto& [name, value] : {std::pair("width", width), std::pair("height", height)})
      if (value < 1 || value > kMaxFilm)
        fail(p.element(name), fmt::format("{} is {}, expected 1 to {}", name, value, kMaxFilm));
    scene_.film.width = static_cast<int>(width);
    scene_.film.height = static_cast<int>(height);
    crop(p);
    // How pixels are stored, tone-mapped and labelled; they stay the same linear values.
    p.ignore({"file_format", "pixel_format", "component_format", "attach_log", "banner",
              "high_quality_edges", "sample_border", "compensate", "gamma", "exposure",
              "tone_mapping_method", "key", "burn", "variable", "digits"});
    p.ignore_labels();
    p.finish(findings_);
    const Element* filter = nullptr;
    for (const auto& child : p.children()) {
      if (child.object->tag != "rfilter") {
        findings_.add(*child.place,
                      fmt::format("{} is not supported in {}, expected rfilter",
                                  describe(*child.object), describe(e)),
                      "it is left out");
        continue;
      }
      once(*child.object, filter);
      reconstruction_filter(*child.object);
    }
    if (!filter && matrix) scene_.film.filter = Filter();
  }

  // A window of the film: left, top, width, height.
  void crop(Properties& p) {
    Film& film = scene_.film;
    const auto part = [&](const char* offset, const char* size, int whole) {
      const int64_t from = p.integer(offset, 0);
      if (from < 0 || from >= whole)
        fail(p.element(offset),
             fmt::format("{} is {}, expected 0 to {}", p.element(offset)["name"], from, whole - 1));
      const int64_t pixels = p.integer(size, whole - from);
      if (pixels < 1 || pixels > whole - from)
        fail(p.element(size), fmt::format("{} is {}, expected 1 to {}", p.element(size)["name"],
                                          pixels, whole - from));
      return std::pair(static_cast<int>(from), static_cast<int>(pixels));
    };
    const auto [left, width] = part("crop_offset_x", "crop_width", film.width);
    const auto [top, height] = part("crop_offset_y", "crop_height", film.height);
    if (width == film.width && height == film.height) return;
    film.whole_width = film.width;
    film.whole_height = film.height;
    film.left = left;
    film.top = top;
    film.width = width;
    film.height = height;
  }

  static Filter gaussian(double stddev) { return {FilterKind::kGaussian, 4 * stddev, stddev}; }

  void reconstruction_filter(const Element& e) {
    Properties p(document_, e);
    // Wide enough for every sample to count somewhere; narrow enough for a film's memory.
    constexpr double kNarrowest = 0.1, kWidest = 8;
    const auto within = [&](const char* name, double value, double low, double high) {
      if (!(value >= low && value <= high))
        fail(p.element(name),
             fmt::format("{} is {}, expected {} to {}", p.element(name)["name"], value, low, high));
      return value;
    };
    const auto radius = [&](double otherwise) {
      return within("radius", p.number("radius", otherwise), kNarrowest, kWidest);
    };
    Filter& f = scene_.film.filter;
    if (p.type() == "box") {
      f = {FilterKind::kBox, radius(0.5)};
    } else if (p.type() == "tent") {
      f = {FilterKind::kTent, radius(1)};
    } else if (p.type() == "gaussian") {
      f = gaussian(within("stddev", p.number("stddev", 0.5), kNarrowest / 4, kWidest / 4));
    } else if (p.type() == "mitchell") {
      const double b = within("b", p.number("b", 1.0 / 3), 0, 1);
      f = {FilterKind::kMitchell, 2, 0, b, within("c", p.number("c", 1.0 / 3), 0, 1)};
    } else if (p.type() == "catmullrom") {
      f = {FilterKind::kMitchell, 2, 0, 0, 0.5};
    } else if (p.type() == "lanczos") {
      f = {FilterKind::kLanczos,
           within("lobes", static_cast<double>(p.integer("lobes", 3)), 1, kWidest)};
    } else {
      unknown_type(e, "box, tent, gaussian, mitchell, catmullrom or lanczos",
                   "a gaussian filter stands for it");
      return;
    }
    p.finish(findings_);
    no_children(p);
  }

  void sampler(const Element& e) {
    Properties p(document_, e);
    const int64_t count = p.integer("sample_count", 0);
    if (p.has("sample_count") && (count < 1 || count > (1 << 20)))
      fail(p.element("sample_count"),
           fmt::format("sampleCount is {}, expected 1 to {}", count, 1 << 20));
    scene_.sample_count = static_cast<int>(count);
    p.ignore_all();
  }

  // What may stand where shapes do.
  void shape(const Element& e) {
    const std::string type = lower(e["type"]);
    if (type == "shapegroup") {
      // A definition: its instances show it.
      if (!e.find("id"))
        fail(e, fmt::format("{} has no id, and no instance can show it", describe(e)));
    } else if (type == "instance") {
      instance(e);
    } else if (type == "merge") {
      merge(e);
    } else if (auto s = single_shape(e)) {
      scene_.shapes.push_back(std::move(*s));
    }
  }

  // Shapes as if they stood outside.
  void merge(const Element& e) {
    Properties p(document_, e);
    for (const auto& child : p.children()) {
      if (child.object->tag != "shape" || is_one_of(*child.object, {"merge", "shapegroup"}))
        findings_.add(*child.place,
                      fmt::format("{} is not supported in {}, expected shapes",
                                  describe(*child.object), describe(e)),
                      "it is left out");
      else
        shape(*child.object);
    }
    p.finish(findings_);
  }

  static bool is_one_of(const Element& e, std::initializer_list<const char*> types) {
    const std::string type = lower(e["type"]);
    return std::any_of(types.begin(), types.end(), [&](const char* t) { return type == t; });
  }

  // A group's meshes stand in the scene once; what is round is copied to every instance.
  struct Group {
    int number = -1;  // of the meshes, in Shape::group; -1: there are none
    std::vector<Shape> round;
  };

  void instance(const Element& e) {
    Properties p(document_, e);
    const Mat4 to_world = p.transform("to_world");
    const Group* group = nullptr;
    for (const auto& child : p.children()) {
      if (child.object->tag != "shape" || !is_one_of(*child.object, {"shapegroup"}))
        fail(*child.place, fmt::format("{} in {}, expected a reference to a shapegroup",
                                       describe(*child.object), describe(e)));
      if (group) fail(*child.place, fmt::format("{} has two groups, expected one", describe(e)));
      group = &group_of(*child.object);
    }
    if (!group) fail(e, fmt::format("{} has no group, expected a reference to one", describe(e)));
    p.finish(findings_);
    if (group->number >= 0) scene_.instances.push_back({group->number, to_world});
    for (Shape s : group->round) {
      s.to_world = to_world * s.to_world;
      s.uneven = s.kind != ShapeKind::kDisk && !scales_evenly(glm::dmat3(to_world));
      scene_.shapes.push_back(std::move(s));
    }
  }

  const Group& group_of(const Element& e) {
    const auto [at, is_new] = groups_.try_emplace(&e);
    Group& group = at->second;
    if (!is_new) return group;
    Properties p(document_, e);
    for (const auto& child : p.children()) {
      if (child.object->tag != "shape" ||
          is_one_of(*child.object, {"instance", "shapegroup", "merge"})) {
        findings_.add(*child.place,
                      fmt::format("{} is not supported in {}, expected shapes",
                                  describe(*child.object), describe(e)),
                      "it is left out");
        continue;
      }
      auto s = single_shape(*child.object);
      if (!s) continue;
      if (s->radiance) {
        findings_.add(*child.object,
                      fmt::format("{} emits and stands in {}, which is not supported",
                                  describe(*child.object), describe(e)),
                      "it does not emit");
        s->radiance.reset();
      }
      if (s->mesh.triangles.empty()) {
        group.round.push_back(std::move(*s));
        continue;
      }
      if (group.number < 0) group.number = mesh_groups_++;
      s->group = group.number;
      scene_.shapes.push_back(std::move(*s));
    }
    p.finish(findings_);
    if (group.number < 0 && group.round.empty())
      fail(e, fmt::format("{} has no shapes", describe(e)));
    return group;
  }

  // Nothing where the type is not supported.
  std::optional<Shape> single_shape(const Element& e) {
    Properties p(document_, e);
    Shape s;
    s.id = e["id"];
    const Mat4 to_world = p.transform("to_world");
    s.flip_normals = p.boolean("flip_normals", false);
    if (p.type() == "rectangle" || p.type() == "cube") {
      s.kind = p.type() == "cube" ? ShapeKind::kCube : ShapeKind::kRectangle;
      s.mesh = p.type() == "cube" ? cube_mesh() : rectangle_mesh();
      place_mesh(s.mesh, {to_world, s.flip_normals, true, true}, place(e));
    } else if (p.type() == "disk") {
      s.kind = ShapeKind::kDisk;
      s.to_world = to_world;
    } else if (p.type() == "sphere") {
      sphere(p, s, to_world);
    } else if (p.type() == "cylinder") {
      cylinder(p, s, to_world);
    } else if (p.type() == "obj" || p.type() == "ply" || p.type() == "serialized") {
      mesh(p, s, to_world);
    } else {
      unknown_type(e,
                   "rectangle, cube, sphere, disk, cylinder, obj, ply, serialized, shapegroup, "
                   "instance or merge",
                   "it is left out");
      for (const auto& child : p.children())
        if (child.object->tag == "bsdf") materials_.bsdf(*child.object);
      return std::nullopt;
    }
    p.finish(findings_);

    std::optional<Sides> sides;
    for (const auto& child : p.children()) {
      const Element& object = *child.object;
      if (object.tag == "bsdf") {
        if (sides) fail(*child.place, fmt::format("{} has two BSDFs, expected one", describe(e)));
        sides = materials_.bsdf(object);
      } else if (object.tag == "emitter") {
        if (s.radiance)
          fail(*child.place, fmt::format("{} has two emitters, expected one", describe(e)));
        area_light(object, s);
      } else {
        findings_.add(*child.place,
                      fmt::format("{} is not supported in {}, expected bsdf or emitter",
                                  describe(object), describe(e)),
                      "it is left out");
      }
    }
    if (sides && s.radiance &&
        (materials_.is_open(sides->front) || materials_.is_open(sides->back))) {
      findings_.add(e,
                    fmt::format("{} emits and lets light pass straight on (null, mask), which is "
                                "not supported",
                                describe(e)),
                    "it is black and closed");
      sides.reset();
    }
    if (!sides) {
      int& shared = s.radiance ? black_ : grey_;
      if (shared < 0) {
        Bsdf b;
        b.diffuse = Rgb(s.radiance ? 0 : 0.5);
        shared = materials_.add(b);
      }
      sides = Sides{shared, -1};
    }
    s.bsdf = sides->front;
    s.back_bsdf = sides->back;
    needs_coordinates(e, s);
    return s;
  }

  // A texture on a mesh without coordinates, or of colors that a shape does not have, shows
  // nothing.
  void needs_coordinates(const Element& e, const Shape& s) const {
    const bool is_mesh = s.kind == ShapeKind::kMesh;
    const auto check = [&](int index) {
      if (index < 0) return;
      const bool colors =
          scene_.textures[static_cast<size_t>(index)].kind == TextureKind::kVertexColor;
      if (colors && !is_mesh)
        fail(e, fmt::format("{} has a texture of vertex colors, which only meshes have, expected a "
                            "ply or serialized shape",
                            describe(e)));
      if (!is_mesh) return;
      if (colors && s.mesh.colors.empty())
        fail(e,
             fmt::format("{} has a texture of vertex colors, but its file has none", describe(e)));
      if (!colors && s.mesh.uvs.empty())
        fail(e,
             fmt::format("{} has a texture, but its file has no texture coordinates", describe(e)));
    };
    const auto look = [&](const auto& again, int index) -> void {
      if (index < 0) return;
      const Bsdf& b = scene_.bsdfs[static_cast<size_t>(index)];
      for (const int t : b.texture) check(t);
      check(b.normal_map);
      check(b.bump_map);
      for (const int part : b.parts) again(again, part);
    };
    look(look, s.bsdf);
    look(look, s.back_bsdf);
    check(s.radiance_texture);
  }

  static std::string place(const Element& e) { return fmt::format("{}:{}", *e.file, e.line); }

  static void sphere(Properties& p, Shape& s, const Mat4& to_world) {
    s.kind = ShapeKind::kSphere;
    const Vec3 center = p.vector("center", Vec3(0));
    const double radius = p.number("radius", 1);
    if (!(radius > 0))
      fail(p.element("radius"), fmt::format("radius is {}, expected more than 0", radius));
    s.to_world = to_world * Mat4(glm::dvec4(radius, 0, 0, 0), glm::dvec4(0, radius, 0, 0),
                                 glm::dvec4(0, 0, radius, 0), glm::dvec4(center, 1));
    if (!scales_evenly(glm::dmat3(s.to_world)))
      fail(p.element("to_world"),
           "the sphere's transform makes an ellipsoid, expected equal scales and no shear");
  }

  // Rotations, reflections and uniform scales, up to the rounding of a matrix written with six
  // digits.
  static bool scales_evenly(const glm::dmat3& m) {
    const double size = glm::dot(m[0], m[0]);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (std::fabs(glm::dot(m[i], m[j]) - (i == j ? size : 0)) > 1e-5 * size) return false;
    return true;
  }

  static void cylinder(Properties& p, Shape& s, const Mat4& to_world) {
    s.kind = ShapeKind::kCylinder;
    const Vec3 from = p.vector("p0", Vec3(0)), to = p.vector("p1", Vec3(0, 0, 1));
    const double radius = p.number("radius", 1);
    if (!(radius > 0))
      fail(p.element("radius"), fmt::format("radius is {}, expected more than 0", radius));
    const Vec3 axis = to - from;
    if (!(max_component(glm::abs(axis)) > 0))
      fail(p.element("p1"), "p0 and p1 are the same point, expected two");
    if (!scales_evenly(glm::dmat3(to_world)))
      fail(p.element("to_world"),
           "the cylinder's transform is uneven, expected equal scales and no shear");
    const Vec3 z = unit(p.element("p1"), axis);
    // Mitsuba 0.6's axes across.
    const Vec3 y = std::fabs(z.x) > std::fabs(z.y)
                       ? Vec3(z.z, 0, -z.x) / std::sqrt(z.x * z.x + z.z * z.z)
                       : Vec3(0, z.z, -z.y) / std::sqrt(z.y * z.y + z.z * z.z);
    s.to_world =
        to_world * Mat4(glm::dvec4(glm::cross(y, z) * radius, 0), glm::dvec4(y * radius, 0),
                        glm::dvec4(axis, 0), glm::dvec4(from, 1));
  }

  void mesh(Properties& p, Shape& s, const Mat4& to_world) {
    s.kind = ShapeKind::kMesh;
    if (!p.has("filename"))
      fail(p.object(), fmt::format("{} has no filename", describe(p.object())));
    const std::string name = p.text("filename", "");
    const bool faceted = p.boolean("face_normals", false);
    if (p.number("max_smooth_angle", 0) != 0)
      findings_.add(p.element("max_smooth_angle"), "maxSmoothAngle is not supported",
                    "all edges are smooth");
    const bool is_obj = p.type() == "obj", is_serialized = p.type() == "serialized";
    const int64_t index = p.integer("shape_index", is_serialized ? 0 : -1);
    if (!is_serialized && index != -1)
      findings_.add(p.element("shape_index"), "shapeIndex is not supported here",
                    "all shapes of the file are read");
    const bool load_materials = p.boolean("load_materials", true);
    // 0.6 takes vertex colors for sRGB, 3.x for linear.
    const bool srgb = p.boolean("srgb", !document_.new_dialect);
    const bool flip = p.boolean("flip_tex_coords", is_obj);
    p.ignore({"collapse"});
    MeshFile read = taken_mesh(p.type(), document_.find_file(p.element("filename"), name), index);
    if (flip)
      for (Vec2& uv : read.mesh.uvs) uv.y = 1 - uv.y;
    if (srgb && !is_serialized)
      for (Rgb& c : read.mesh.colors)
        for (int i = 0; i < 3; ++i) c[i] = srgb_to_linear(c[i]);
    if (read.names_materials && load_materials && !document_.new_dialect &&
        std::none_of(p.children().begin(), p.children().end(),
                     [](const auto& c) { return c.object->tag == "bsdf"; }))
      findings_.add(p.object(),
                    fmt::format("{} has no BSDF and its file uses materials of its own, which are "
                                "not supported; expected a <bsdf> or loadMaterials false",
                                describe(p.object())),
                    "a diffuse BSDF stands for them");
    s.mesh = std::move(read.mesh);
    place_mesh(s.mesh, {to_world, s.flip_normals, false, faceted || read.faceted},
               place(p.object()));
  }

  // Meshes by type, file and number, read at once, in parallel. An error waits for whoever asks for
  // the mesh, so that messages come in the file's order.
  struct WaitingMesh {
    MeshFile mesh;
    std::exception_ptr error;
    size_t users = 0;
  };
  using MeshKey = std::tuple<std::string, std::string, int64_t>;

  static MeshFile read_mesh(const MeshKey& key) {
    const auto& [type, file, index] = key;
    return type == "obj"          ? read_obj(file)
           : type == "serialized" ? read_serialized(file, index)
                                  : read_ply_mesh(file);
  }

  void read_meshes() {
    find_meshes(*document_.root);
    std::vector<std::pair<const MeshKey, WaitingMesh>*> all;
    for (auto& entry : meshes_) all.push_back(&entry);
    tbb::parallel_for(size_t{0}, all.size(), [&](size_t i) {
      try {
        all[i]->second.mesh = read_mesh(all[i]->first);
      } catch (...) {
        all[i]->second.error = std::current_exception();
      }
    });
  }

  // What looks like a mesh with a file that exists; the rest is said where the shape is read.
  void find_meshes(const Element& e) {
    for (const auto& child : e.children) find_meshes(*child);
    const std::string type = lower(e["type"]);
    if (e.tag != "shape" || !is_one_of(e, {"obj", "ply", "serialized"})) return;
    const Element* file = nullptr;
    int64_t index = type == "serialized" ? 0 : -1;
    for (const auto& child : e.children) {
      const std::string name = canonical_name((*child)["name"]);
      if (name == "filename") file = child.get();
      if (name == "shape_index" && type == "serialized")
        index = parse_integer((*child)["value"]).value_or(0);
    }
    if (!file) return;
    try {
      ++meshes_[{type, document_.find_file(*file, (*file)["value"]), index}].users;
    } catch (const SceneError&) {
    }
  }

  MeshFile taken_mesh(const std::string& type, const std::string& file, int64_t index) {
    const MeshKey key(type, file, type == "serialized" ? index : -1);
    const auto at = meshes_.find(key);
    if (at == meshes_.end()) return read_mesh(key);
    WaitingMesh& waiting = at->second;
    if (waiting.error) std::rethrow_exception(waiting.error);
    if (waiting.users > 1) {
      --waiting.users;
      return waiting.mesh;
    }
    MeshFile mesh = std::move(waiting.mesh);
    meshes_.erase(at);
    return mesh;
  }

  // With a texture in `texture`, its factor.
  Rgb emitted(Properties& p, const std::string& name, int& texture) {
    const Rgb value = materials_.textured(p, name, Rgb(1), texture, SpectrumOf::kLight);
    if (p.number("sampling_weight", 1) < 0)
      fail(p.element("sampling_weight"), "samplingWeight is negative");
    const double shown =
        texture < 0 ? 1 : texture_max(scene_.textures[static_cast<size_t>(texture)]);
    has_light_ = has_light_ || (!is_black(value) && shown > 0);
    return value;
  }

  void area_light(const Element& e, Shape& s) {
    Properties p(document_, e);
    if (p.type() != "area") {
      unknown_type(e, "area in a shape", "it is left out");
      return;
    }
    s.radiance = emitted(p, "radiance", s.radiance_texture);
    p.finish(findings_);
    no_children(p);
  }

  void light(const Element& e) {
    Properties p(document_, e);
    Light l;
    const char* key = "intensity";
    if (p.type() == "area") {
      // A definition for shapes to refer to.
      if (!e.find("id")) fail(e, fmt::format("{} has no place outside a shape", describe(e)));
      return;
    }
    if (p.type() == "point") {
      l.kind = LightKind::kPoint;
      one_of(p, "position", "to_world");
      l.position = p.vector("position", Vec3(0));
    } else if (p.type() == "spot") {
      l.kind = LightKind::kSpot;
      const double cutoff = p.number("cutoff_angle", 20);
      const double beam = p.number("beam_width", cutoff * 0.75);
      // A narrower cone's cosine is 1 but for a rounding.
      constexpr double kNarrowest = 1e-4;
      if (!(cutoff >= kNarrowest && cutoff < 180))
        fail(p.element("cutoff_angle"),
             fmt::format("cutoffAngle is {}, expected at least {} and less than 180", cutoff,
                         kNarrowest));
      if (!(beam >= 0 && beam <= cutoff))
        fail(p.element("beam_width"),
             fmt::format("beamWidth is {}, expected 0 to cutoffAngle ({})", beam, cutoff));
      l.cutoff_angle = cutoff * kPi / 180;
      l.beam_angle = beam * kPi / 180;
      l.cutoff_cos = cos_sin_turns(cutoff / 360).x;
      l.beam_cos = cos_sin_turns(beam / 360).x;
    } else if (p.type() == "directional") {
      l.kind = LightKind::kDirectional;
      key = "irradiance";
      one_of(p, "direction", "to_world");
    } else if (p.type() == "constant" || p.type() == "envmap") {
      environment(p, l);
      return;
    } else if (p.type() == "sky" || p.type() == "sunsky" || p.type() == "sun") {
      findings_.add(
          e,
          fmt::format("{} is not supported, expected an envmap of it (Mitsuba renders one "
                      "with the sensor 'spherical')",
                      describe(e)),
          "a constant environment of radiance 1 stands for it");
      l.kind = LightKind::kEnvironment;
      p.ignore_all();
      add_environment(e, l);
      return;
    } else if (p.type() == "collimated") {
      l.kind = LightKind::kCollimated;
      key = "power";
    } else {
      unknown_type(e, "point, spot, directional, collimated, constant, envmap, or area in a shape",
                   "it is left out");
      return;
    }
    const Mat4 to_world = p.transform("to_world");
    if (l.kind == LightKind::kCollimated && !scales_evenly(glm::dmat3(to_world)))
      fail(p.element("to_world"),
           "the beam's transform is uneven, expected rotations and translations only");
    if (p.has("to_world") || l.kind == LightKind::kSpot) {
      l.position = Vec3(to_world[3]);
      l.direction = unit(p.element("to_world"), Vec3(to_world[2]));
    }
    if (l.kind == LightKind::kDirectional && p.has("direction"))
      l.direction = unit(p.element("direction"), p.vector("direction", Vec3(0)));
    l.intensity = color_emitted(p, key);
    p.finish(findings_);
    no_children(p);
    scene_.lights.push_back(l);
  }

  Rgb color_emitted(Properties& p, const char* key) {
    int texture = -1;
    const Rgb value = emitted(p, key, texture);
    if (texture < 0) return value;
    const Rgb mean = texture_mean(scene_.textures[static_cast<size_t>(texture)]);
    findings_.add(p.object(),
                  fmt::format("{} has a textured {}, which is not supported, expected a color",
                              describe(p.object()), key),
                  "the texture's mean stands for it");
    return value * mean;
  }

  void environment(Properties& p, Light& l) {
    l.kind = LightKind::kEnvironment;
    if (p.type() == "envmap") {
      l.map = materials_.bitmap(p);
      l.intensity = Rgb(p.number("scale", 1));
      p.ignore({"cache", "mis_compensation"});
      if (!(l.intensity.x >= 0))
        fail(p.element("scale"), fmt::format("scale is {}, expected at least 0", l.intensity.x));
      l.to_world = p.transform("to_world");
      if (!scales_evenly(glm::dmat3(l.to_world)))
        fail(p.element("to_world"),
             "the environment's transform shears, expected rotations and reflections only");
      if (p.number("sampling_weight", 1) < 0)
        fail(p.element("sampling_weight"), "samplingWeight is negative");
      const bool black =
          std::all_of(l.map->texels.begin(), l.map->texels.end(), [](float t) { return t == 0; });
      if (black) fail(p.object(), fmt::format("the map of {} is black", describe(p.object())));
      has_light_ = has_light_ || l.intensity.x > 0;
    } else {
      p.ignore({"to_world"});  // looks the same from all sides
      l.intensity = color_emitted(p, "radiance");
    }
    p.finish(findings_);
    no_children(p);
    add_environment(p.object(), l);
  }

  void add_environment(const Element& e, const Light& l) {
    has_light_ = has_light_ || !is_black(l.intensity);
    once(e, environment_);
    scene_.lights.push_back(l);
  }

  static void one_of(const Properties& p, const char* a, const char* b) {
    if (p.has(a) && p.has(b))
      fail(p.element(b), fmt::format("{} has both {} and {}, expected one", describe(p.object()),
                                     p.element(a)["name"], p.element(b)["name"]));
  }

  static Vec3 unit(const Element& e, Vec3 v) {
    const double largest = max_component(glm::abs(v));
    if (!(largest > 0)) fail(e, fmt::format("{} gives no direction", describe(e)));
    v /= largest;
    return v / glm::length(v);
  }

  const std::string path_;
  const Unsupported unsupported_;
  Document document_;
  Scene scene_;
  Findings findings_;
  BsdfReader materials_;
  std::map<const Element*, Group> groups_;
  std::map<MeshKey, WaitingMesh> meshes_;
  int mesh_groups_ = 0;
  const Element *integrator_ = nullptr, *sensor_ = nullptr, *environment_ = nullptr;
  int black_ = -1, grey_ = -1;
  bool has_light_ = false;
};

}  // namespace

Scene load_scene(const std::string& path, const Parameters& parameters, Unsupported unsupported) {
  return Loader(path, parameters, unsupported).load();
}

}  // namespace photonloom
