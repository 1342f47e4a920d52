// SPDX-License-Identifier: Apache-2.0
// A scene after loading: everything resolved, in world space, in doubles. Meaning: Mitsuba's, see
// docs/scene.md.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "golden/numeric/vec.hpp"
#include "golden/scene/texture.hpp"

namespace photonloom {

using Mat4 = glm::dmat4;

enum class BsdfKind {
  kDiffuse,
  kPhong,
  kConductor,
  kDielectric,
  kThinDielectric,
  kRoughConductor,
  kRoughDielectric,
  kPlastic,
  kRoughPlastic,
  kMixture,
  kPrincipled
};

enum class Microfacets { kBeckmann, kGgx };

// What of a BSDF a texture may vary: each of its own entry in Bsdf::texture.
enum class Slot { kDiffuse, kSpecular, kTransmission, kOpacity, kAlphaU, kAlphaV, kShare, kCount };

// What Mitsuba 3's principled BSDF has beside its base color (Bsdf::diffuse) and its index
// (Bsdf::ior); each from 0 to 1. Textures of Slot::kAlphaU and Slot::kShare multiply roughness and
// metallic.
struct Principled {
  double roughness = 0.5, anisotropic = 0, metallic = 0, spec_trans = 0, spec_tint = 0, sheen = 0,
         sheen_tint = 0, flatness = 0, clearcoat = 0, clearcoat_gloss = 0;
};

// One BSDF; lobes that a kind does not have are black. Which sides of a shape it is on, the shape
// says. A textured value is the member times the texture's.
struct Bsdf {
  std::string id;
  BsdfKind kind = BsdfKind::kDiffuse;
  bool two_sided = false;  // the shapes that use it have it on both sides
  Rgb diffuse{0};          // rho_d: diffuse reflectance, or phong's
  Rgb specular{0};         // rho_s of phong; factor on reflection of conductor and dielectric
  Rgb transmission{1};     // factor on transmission of a dielectric
  double exponent = 0;     // phong's n
  Rgb eta{0}, k{0};        // conductor's complex index; k = eta = 0: ideal mirror
  double ior = 1;          // dielectrics and plastics: interior over exterior index
  Microfacets microfacets = Microfacets::kBeckmann;
  double alpha_u = 0.1, alpha_v = 0.1;  // roughness along the tangent and across it
  bool nonlinear = false;               // plastics: absorption between the coat's inner reflections
  // Over the rest lies a smooth coat (Mitsuba's coating) where coat_ior > 1: its index over that of
  // the outside, its reflection's factor, and what it absorbs across its thickness.
  double coat_ior = 1;
  Rgb coat_specular{1}, coat_absorption{0};
  Principled principled = {};
  double opacity = 1;  // the rest of the light goes straight on
  // Its diffuse lobe is followed as a path, as a glossy one is: in a mixture, photons know one
  // coat.
  bool follow_diffuse = false;
  // Mixture: indices into Scene::bsdfs, each with its share of all light; with a texture in kShare,
  // two: the second's share is the texture, the first's the rest.
  std::vector<int> parts;
  std::vector<double> shares;
  // Textures that turn the shading normal, indices into Scene::textures, -1: none: a normal in the
  // frame of u and v, coded as 2 x - 1; a height in scene units.
  int normal_map = -1, bump_map = -1;
  // Indices into Scene::textures by Slot; -1: none.
  std::array<int, static_cast<size_t>(Slot::kCount)> texture = {-1, -1, -1, -1, -1, -1, -1};

  bool is_coated() const { return coat_ior > 1; }
  // Every ray that it sends on is a mirror's or a glass's.
  bool is_delta() const {
    return kind == BsdfKind::kConductor || kind == BsdfKind::kDielectric ||
           kind == BsdfKind::kThinDielectric;
  }
  // Light passes from one side to the other (other than by opacity), so both sides have this BSDF.
  bool transmits() const {
    return kind == BsdfKind::kDielectric || kind == BsdfKind::kThinDielectric ||
           kind == BsdfKind::kRoughDielectric ||
           (kind == BsdfKind::kPrincipled && principled.spec_trans > 0);
  }
  // A diffuse lobe that holds photons, black or not.
  bool has_diffuse() const {
    if (follow_diffuse) return false;
    if (kind != BsdfKind::kPrincipled) return !is_delta();
    const bool all_metal = principled.metallic == 1 && textured(Slot::kShare) < 0;
    return !all_metal && principled.spec_trans < 1 && principled.flatness < 1;
  }
  int textured(Slot slot) const { return texture[static_cast<size_t>(slot)]; }
};

enum class ShapeKind { kMesh, kSphere, kDisk, kRectangle, kCube, kCylinder };

// Triangles share vertices; normals are per vertex and may be empty (faceted).
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  std::vector<std::array<uint32_t, 3>> triangles;
  // Texture coordinates: per vertex, or per corner of each triangle, or none.
  std::vector<Vec2> uvs;
  std::vector<std::array<Vec2, 3>> corner_uvs;
  std::vector<Rgb> colors;  // linear, per vertex, or none
};

// A shape is a mesh (rectangles and cubes are loaded as meshes too), a sphere, a disk or a
// cylinder.
struct Shape {
  std::string id;
  ShapeKind kind = ShapeKind::kMesh;  // what the file said
  int group = -1;                     // a mesh that only the instances of this group show
  Mesh mesh;                          // world space (group: its own), for all but the round ones
  Mat4 to_world{1};                   // sphere, disk: unit sphere / unit disk in z = 0, normal +z;
                                      // cylinder: radius 1 around z, from z = 0 to 1, no caps
  bool uneven = false;                // sphere, cylinder: to_world scales unevenly or shears
  bool flip_normals = false;          // already applied to mesh triangles' winding and normals
  int bsdf = -1;                      // index into Scene::bsdfs; what the front sees
  int back_bsdf = -1;                 // what the back sees, a dielectric's is its own; -1: black
  std::optional<Rgb> radiance;        // area emitter, W/(m^2 sr), from the normal side
  int radiance_texture = -1;          // its factor, index into Scene::textures
};

// The shapes of a group once more: its front sides are the images of the group's.
struct Instance {
  int group = 0;
  Mat4 to_world{1};
};

enum class LightKind { kPoint, kSpot, kDirectional, kEnvironment, kCollimated };

// Emitters without a surface.
struct Light {
  LightKind kind = LightKind::kPoint;
  Vec3 position{0};
  Vec3 direction{0, 0, 1};              // spot: axis; directional, collimated: of the beam; unit
  Rgb intensity{1};                     // W/sr; directional: irradiance W/m^2 across the beam;
                                        // collimated: power, W
  double cutoff_cos = 0, beam_cos = 0;  // spot
  double cutoff_angle = 0, beam_angle = 0;  // radians; linear in angle between
  // Environment: radiance `intensity`, W/(m^2 sr), from all directions, times the map where there
  // is one. Its frame's y axis points to the map's upper edge, -z to the middle of u = 0.
  std::shared_ptr<const Bitmap> map;
  Mat4 to_world{1};
};

enum class FovAxis { kX, kY, kDiagonal, kSmaller, kLarger };

enum class CameraKind { kPerspective, kThinLens, kOrthographic };

// Looks along +z of to_world, +y up, +x to the image's left.
struct Camera {
  CameraKind kind = CameraKind::kPerspective;
  Mat4 to_world{1};
  double aperture_radius = 0, focus_distance = 0;  // thin lens, along +z
  // The image moves right and down by these parts of its width and height.
  double offset_x = 0, offset_y = 0;
  double fov = 50;  // degrees, along fov_axis
  FovAxis fov_axis = FovAxis::kX;
  double near_clip = 0;  // along +z; 0 and infinity when not given
  double far_clip = std::numeric_limits<double>::infinity();
};

enum class FilterKind { kBox, kTent, kGaussian, kMitchell, kLanczos };

// A reconstruction filter f(x) f(y); docs/frame.md has the formulas.
struct Filter {
  FilterKind kind = FilterKind::kBox;
  double radius = 0.5;  // pixels; beyond it f is 0
  double stddev = 0;    // gaussian
  double b = 0, c = 0;  // mitchell
  bool is_plain_box() const { return kind == FilterKind::kBox && radius == 0.5; }
};

struct Film {
  int width = 768, height = 576;
  // Not 0: the film holds one pixel, drawn by lot, of each of width x height equal parts of a frame
  // of this size, as wide as the frame's are. What is measured on it has the frame's expectation.
  int frame_width = 0, frame_height = 0;
  // Not 0: the film is a window of a film of this size, with so many pixels left and above of it.
  // Parts of pixels where the window was resized.
  double whole_width = 0, whole_height = 0, left = 0, top = 0;
  Filter filter = {};

  bool is_window() const { return whole_width > 0; }
  // The same view in other pixels.
  void resize(int new_width, int new_height) {
    const double x = static_cast<double>(new_width) / width;
    const double y = static_cast<double>(new_height) / height;
    whole_width *= x;
    left *= x;
    whole_height *= y;
    top *= y;
    width = new_width;
    height = new_height;
  }
};

struct Scene {
  std::string name;   // file name without folder and ending
  uint64_t hash = 0;  // of everything below that touches the image
  Camera camera;
  Film film;
  int sample_count = 0;  // 0: not given
  int max_depth = -1;    // segments of a path, -1 for no limit
  int rr_depth = 5;      // Russian roulette from this segment on
  std::vector<Texture> textures;
  std::vector<Bsdf> bsdfs;
  std::vector<Shape> shapes;
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::vector<std::string> files;     // read for it, its own first
  std::vector<std::string> warnings;  // with file and line
  // What is not supported and what stands for it, with file and line; only where asked for.
  std::vector<std::string> substitutions;
};

// Hash of everything in the scene that touches the image; what Scene::hash holds after loading.
uint64_t scene_hash(const Scene& scene);

// An error in a user's file: what() is one sentence that names file, line where known, element or
// field, and what was expected.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

using Parameters = std::vector<std::pair<std::string, std::string>>;  // -D name=value

// What happens to elements that are not supported: all are named in one error, or the nearest that
// is supported stands for each.
enum class Unsupported { kRefuse, kSubstitute };

// Reads a Mitsuba 0.4 to 0.6, 2.x or 3.x XML file. Throws SceneError.
Scene load_scene(const std::string& path, const Parameters& parameters = {},
                 Unsupported unsupported = Unsupported::kRefuse);

// Lobes of a BSDF, null for black, or of one of its parts; a followed diffuse one is glossy.
bool has_diffuse_part(const Scene& scene, const Bsdf* bsdf);
bool has_delta_part(const Scene& scene, const Bsdf* bsdf);
bool has_glossy_part(const Scene& scene, const Bsdf* bsdf);
// Some part of it, or all of it, lets light pass straight on.
bool has_open_part(const Scene& scene, const Bsdf* bsdf);

// Which of Scene::bsdfs some shape has on a side, itself or as a part.
std::vector<bool> used_bsdfs(const Scene& scene);

}  // namespace photonloom
