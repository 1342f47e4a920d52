// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/generate_mesh.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "golden/numeric/elementary.hpp"
#include "golden/scene/ply.hpp"

namespace photonloom {
namespace {

struct Vertex {
  Vec3 position, normal;
};

// A patch of columns x rows quads of a surface (u, v) in [0, 1]^2. Counter-clockwise where the
// derivatives along u and v, in this order, give the normal.
void add_patch(Mesh& mesh, int columns, int rows,
               const std::function<Vertex(double, double)>& surface) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const Vertex v = surface(static_cast<double>(i) / columns, static_cast<double>(j) / rows);
      mesh.positions.push_back(v.position);
      mesh.normals.push_back(v.normal);
    }
  }
  const auto at = [&](int i, int j) {
    return first + static_cast<uint32_t>(j * (columns + 1) + i);
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
}

// A flat parallelogram; its normal is u x v.
void add_flat(Mesh& mesh, const Vec3& corner, const Vec3& u, const Vec3& v) {
  const Vec3 normal = glm::normalize(glm::cross(u, v));
  add_patch(mesh, 1, 1, [&](double s, double t) { return Vertex{corner + u * s + v * t, normal}; });
}

// Dimensions of the atrium; y is up.
constexpr int kBays = 6;
constexpr double kBay = 2.5;        // between column axes
constexpr double kHalfWidth = 3.0;  // of the court, z
constexpr double kGallery = 2.5;    // depth of the galleries behind the colonnades
constexpr double kStorey = 4.4;     // height of a storey
constexpr double kSpring = 2.9;     // where arches begin, above a storey's floor
constexpr double kThickness = 0.5;  // of the arcade wall
constexpr double kArchRadius = 0.95;
constexpr double kSlab = 0.15;  // between a gallery's ceiling and the floor above

// Cells around and along of each part.
struct Tessellation {
  int column_around = 6, column_along = 2, arch_around = 4, arch_across = 1;

  // From one continuous level.
  static Tessellation at(double level) {
    const auto cells = [&](double per_level) {
      return static_cast<int>(std::floor(per_level * level));
    };
    Tessellation t;
    t.column_around = std::max(t.column_around, cells(4));
    t.column_along = std::max(t.column_along, cells(3));
    t.arch_around = std::max(t.arch_around, 2 * cells(2));
    t.arch_across = std::max(t.arch_across, cells(1));
    return t;
  }

  int64_t triangles() const {
    const int64_t arcades = 2 * 2;  // sides, storeys
    const int64_t arch = 3 * 2 * static_cast<int64_t>(arch_around) * arch_across + 4;
    const int64_t column = 2 * static_cast<int64_t>(column_around) * column_along;
    return arcades * (kBays * arch + (kBays + 1) * column + 4);
  }
};

// Radius of a column at height h in [0, 1]: base, tapered shaft, capital; never beyond the wall
// that it carries.
double column_radius(double h) {
  const double shaft = 0.19 - 0.03 * h * h;
  const double base = 0.06 * std::max(0.0, 1 - h / 0.08) * std::max(0.0, 1 - h / 0.08);
  const double top = std::max(0.0, (h - 0.86) / 0.14);
  return shaft + base + 0.09 * top * top;
}

void add_column(Mesh& mesh, const Vec3& foot, const Tessellation& t) {
  add_patch(mesh, t.column_around, t.column_along, [&](double u, double v) {
    const Vec2 c = cos_sin_turns(-u);  // so that the outside is counter-clockwise
    const double step = 1e-4;
    const double lower = std::max(0.0, v - step), upper = std::min(1.0, v + step);
    const double slope =
        (column_radius(upper) - column_radius(lower)) / ((upper - lower) * kSpring);
    const double r = column_radius(v);
    return Vertex{foot + Vec3(r * c.x, v * kSpring, r * c.y),
                  glm::normalize(Vec3(c.x, -slope, c.y))};
  });
}

// The arcade wall over one bay: two faces with the arch cut out, the arch's underside, and the flat
// undersides over the columns. `center` is the bay's middle on the storey's floor, in the wall's
// mid-plane.
void add_arch(Mesh& mesh, const Vec3& center, const Tessellation& t) {
  const double half = kBay / 2, rise = kStorey - kSpring;
  // Angles along the arch from right to left, those of the two upper corners among them.
  const double corner = angle_of(half, rise) / (2 * kPi);  // in turns
  std::vector<double> angles;
  const int side = std::max(1, t.arch_around / 4), middle = t.arch_around - 2 * side;
  for (int i = 0; i < side; ++i) angles.push_back(corner * i / side);
  for (int i = 0; i < middle; ++i) angles.push_back(corner + (0.5 - 2 * corner) * i / middle);
  for (int i = 0; i <= side; ++i) angles.push_back(0.5 - corner + corner * i / side);
  const int around = static_cast<int>(angles.size()) - 1;
  const auto angle = [&](double u) {
    return cos_sin_turns(angles[static_cast<size_t>(std::lround(u * around))]);
  };
  const auto spread = [&](double u, double v) {
    const Vec2 c = angle(u);
    const double wide = std::fabs(c.x) > 0 ? half / std::fabs(c.x) : 1e300;
    const double high = c.y > 0 ? rise / c.y : 1e300;
    const double r = kArchRadius + (std::min(wide, high) - kArchRadius) * v;
    return Vec2(r * c.x, r * c.y);
  };
  for (const double face : {1.0, -1.0}) {
    add_patch(mesh, around, t.arch_across, [&](double u, double v) {
      const Vec2 p = spread(face > 0 ? 1 - u : u, v);
      return Vertex{center + Vec3(p.x, kSpring + p.y, face * kThickness / 2), Vec3(0, 0, face)};
    });
  }
  add_patch(mesh, around, t.arch_across, [&](double u, double v) {
    const Vec2 c = angle(1 - u);
    return Vertex{
        center + Vec3(kArchRadius * c.x, kSpring + kArchRadius * c.y, (v - 0.5) * kThickness),
        Vec3(-c.x, -c.y, 0)};
  });
  for (const double x : {-half, kArchRadius})
    add_flat(mesh, center + Vec3(x, kSpring, -kThickness / 2), {half - kArchRadius, 0, 0},
             {0, 0, kThickness});
}

Mesh atrium_of(const Tessellation& t) {
  const double length = kBays * kBay;
  Mesh mesh;
  for (const double side : {-1.0, 1.0}) {
    const double wall = side * (kHalfWidth + kThickness / 2);
    for (int storey = 0; storey < 2; ++storey) {
      const double floor = storey * kStorey;
      for (int i = 0; i <= kBays; ++i) add_column(mesh, {-length / 2 + i * kBay, floor, wall}, t);
      for (int i = 0; i < kBays; ++i)
        add_arch(mesh, {-length / 2 + (i + 0.5) * kBay, floor, wall}, t);
      // Ceiling of the gallery, and a slab's thickness above it the next floor or the roof.
      const double back = side * (kHalfWidth + kGallery + kThickness);
      const double front = side * (kHalfWidth + kThickness);
      const double low = std::min(back, front), depth = std::fabs(back - front);
      add_flat(mesh, {-length / 2, floor + kStorey - kSlab, low}, {length, 0, 0}, {0, 0, depth});
      add_flat(mesh, {-length / 2, floor + kStorey, std::min(back, side * kHalfWidth)},
               {0, 0, std::fabs(back - side * kHalfWidth)}, {length, 0, 0});
    }
  }
  return mesh;
}

}  // namespace

Mesh atrium_mesh(int triangles) {
  if (triangles < 2000 || triangles > 10000000)
    throw SceneError(fmt::format(
        "an atrium of {} triangles cannot be made, expected 2000 to 10000000", triangles));
  // The count grows with the level, in steps; what is left goes into finer columns.
  double low = 1, high = 1024;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (Tessellation::at(middle).triangles() <= triangles ? low : high) = middle;
  }
  Tessellation t = Tessellation::at(low);
  for (int Tessellation::*cells : {&Tessellation::column_along, &Tessellation::column_around}) {
    Tessellation finer = t;
    while (++(finer.*cells), finer.triangles() <= triangles) t = finer;
  }
  return atrium_of(t);
}

Mesh ring_mesh(double inner, double outer, double height, int segments) {
  Mesh mesh;
  const auto cylinder = [&](double radius, double sign) {
    add_patch(mesh, segments, 1, [&](double u, double v) {
      const Vec2 c = cos_sin_turns(-sign * u);
      return Vertex{{radius * c.x, v * height, radius * c.y}, Vec3(c.x, 0, c.y) * sign};
    });
  };
  cylinder(outer, 1);
  cylinder(inner, -1);
  for (const double y : {height, 0.0}) {
    const double up = y > 0 ? 1 : -1;
    add_patch(mesh, segments, 1, [&](double u, double v) {
      const Vec2 c = cos_sin_turns(-up * u);
      const double r = outer + (inner - outer) * v;
      return Vertex{{r * c.x, y, r * c.y}, {0, up, 0}};
    });
  }
  return mesh;
}

Mesh water_mesh(int cells) {
  // Waves of a few lengths and directions: amplitude, periods over the unit length in x and z,
  // phase.
  constexpr double kWaves[][4] = {{0.016, 1.1, 0.5, 0.10},
                                  {0.014, -0.6, 1.3, 0.37},
                                  {0.008, 1.9, -1.1, 0.71},
                                  {0.006, 0.7, 2.3, 0.23},
                                  {0.003, -2.9, 1.7, 0.55}};
  Mesh mesh;
  add_patch(mesh, cells, cells, [&](double u, double v) {
    // v runs along x, u along z: z x x = y.
    const double x = 2 * v - 1, z = 2 * u - 1;
    double y = 0, dx = 0, dz = 0;
    for (const auto& w : kWaves) {
      const Vec2 c = cos_sin_turns(w[1] * x + w[2] * z + w[3]);
      y += w[0] * c.y;
      dx += w[0] * 2 * kPi * w[1] * c.x;
      dz += w[0] * 2 * kPi * w[2] * c.x;
    }
    return Vertex{{x, y, z}, glm::normalize(Vec3(-dx, 1, -dz))};
  });
  return mesh;
}

void write_mesh(const Mesh& mesh, const std::string& path) {
  PlyTable table;
  table.comments = {"made by photonloom mesh; CC0-1.0"};
  PlyElement vertex, face;
  vertex.name = "vertex";
  vertex.rows = mesh.positions.size();
  const char* const names[] = {"x", "y", "z", "nx", "ny", "nz"};
  for (int i = 0; i < 6; ++i) {
    std::vector<double>& column = vertex.add(names[i], PlyType::kFloat).values;
    for (const Vec3& v : i < 3 ? mesh.positions : mesh.normals) column.push_back(v[i % 3]);
  }
  face.name = "face";
  face.rows = mesh.triangles.size();
  PlyColumn& corners = face.add("vertex_indices", PlyType::kInt32);
  corners.is_list = true;
  corners.starts.push_back(0);
  for (const auto& t : mesh.triangles) {
    for (const uint32_t v : t) corners.values.push_back(v);
    corners.starts.push_back(corners.values.size());
  }
  table.elements = {vertex, face};
  write_ply(table, path);
}

}  // namespace photonloom
