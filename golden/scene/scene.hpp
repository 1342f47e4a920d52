// SPDX-License-Identifier: Apache-2.0
// A scene after loading: everything resolved, in world space, in doubles. Meaning: Mitsuba's, see
// docs/scene.md.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "golden/numeric/vec.hpp"

namespace photonloom {

using Mat4 = glm::dmat4;

enum class BsdfKind { kDiffuse, kPhong, kConductor, kDielectric };

// One BSDF; lobes that a kind does not have are black. Which sides of a shape it is on, the shape
// says.
struct Bsdf {
  std::string id;
  BsdfKind kind = BsdfKind::kDiffuse;
  bool two_sided = false;  // the shapes that use it have it on both sides
  Rgb diffuse{0};          // rho_d: diffuse reflectance, or phong's
  Rgb specular{0};         // rho_s of phong; factor on reflection of conductor and dielectric
  Rgb transmission{1};     // factor on transmission of a dielectric
  double exponent = 0;     // phong's n
  Rgb eta{0}, k{0};        // conductor's complex index; k = eta = 0: ideal mirror
  double ior = 1;          // dielectric: interior over exterior index
  bool is_delta() const { return kind == BsdfKind::kConductor || kind == BsdfKind::kDielectric; }
};

enum class ShapeKind { kMesh, kSphere, kDisk, kRectangle, kCube };

// Triangles share vertices; normals are per vertex and may be empty (faceted).
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  std::vector<std::array<uint32_t, 3>> triangles;
};

// A shape is a mesh (rectangles and cubes are loaded as meshes too), a sphere or a disk.
struct Shape {
  std::string id;
  ShapeKind kind = ShapeKind::kMesh;  // what the file said
  Mesh mesh;                          // world space, for all but spheres and disks
  Mat4 to_world{1};                   // sphere, disk: unit sphere / unit disk in z = 0, normal +z
  bool flip_normals = false;          // already applied to mesh triangles' winding and normals
  int bsdf = -1;                      // index into Scene::bsdfs; what the front sees
  int back_bsdf = -1;                 // what the back sees, a dielectric's is its own; -1: black
  std::optional<Rgb> radiance;        // area emitter, W/(m^2 sr), from the normal side
};

enum class LightKind { kPoint, kSpot, kDirectional };

// Emitters without a surface.
struct Light {
  LightKind kind = LightKind::kPoint;
  Vec3 position{0};
  Vec3 direction{0, 0, 1};                  // spot: axis; directional: of the beam; unit
  Rgb intensity{1};                         // W/sr; directional: irradiance W/m^2 across the beam
  double cutoff_cos = 0, beam_cos = 0;      // spot
  double cutoff_angle = 0, beam_angle = 0;  // radians; linear in angle between
};

enum class FovAxis { kX, kY, kDiagonal, kSmaller, kLarger };

// Looks along +z of to_world, +y up, +x to the image's left.
struct Camera {
  Mat4 to_world{1};
  double fov = 50;  // degrees, along fov_axis
  FovAxis fov_axis = FovAxis::kX;
  double near_clip = 0;  // along +z; 0 and infinity when not given
  double far_clip = std::numeric_limits<double>::infinity();
};

struct Film {
  int width = 768, height = 576;
  // Not 0: the film holds one pixel, drawn by lot, of each of width x height equal parts of a frame
  // of this size, as wide as the frame's are. What is measured on it has the frame's expectation.
  int frame_width = 0, frame_height = 0;
};

struct Scene {
  std::string name;   // file name without folder and ending
  uint64_t hash = 0;  // of everything below that touches the image
  Camera camera;
  Film film;
  int sample_count = 0;  // 0: not given
  int max_depth = -1;    // segments of a path, -1 for no limit
  int rr_depth = 5;      // Russian roulette from this segment on
  std::vector<Bsdf> bsdfs;
  std::vector<Shape> shapes;
  std::vector<Light> lights;
  std::vector<std::string> warnings;  // with file and line
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

// Reads a Mitsuba 0.5/0.6 or 3.x XML file. Throws SceneError.
Scene load_scene(const std::string& path, const Parameters& parameters = {});

}  // namespace photonloom
