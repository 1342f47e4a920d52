// SPDX-License-Identifier: Apache-2.0
// FLIP as published; the symbols are the papers'. Gaussians are separable, so every filter is a
// sum of products of two one-dimensional ones. Where the numbers come from: docs/data.md.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "golden/image/metrics.hpp"
#include "golden/numeric/elementary.hpp"
#include "golden/numeric/vec.hpp"

namespace photonloom {
namespace {

using Plane = std::vector<double>;
using Kernel = std::vector<double>;  // odd length, centre in the middle
using Mat3 = glm::dmat3;

// An observer at 0.7 m from a display 0.7 m wide with 3840 pixels.
constexpr double kPixelsPerDegree = 0.7 / 0.7 * 3840 * kPi / 180;

// Linear Rec.709 to CIE XYZ, D65.
const Mat3& xyz_from_rgb() {
  static const Mat3 m =
      glm::transpose(Mat3(10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794,  //
                          2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897,    //
                          1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382));
  return m;
}
const Mat3& rgb_from_xyz() {
  static const Mat3 m = glm::inverse(xyz_from_rgb());
  return m;
}
const Vec3& white() {
  static const Vec3 w = xyz_from_rgb() * Vec3(1);
  return w;
}

Vec3 ycxcz_from_rgb(const Vec3& rgb) {
  const Vec3 n = xyz_from_rgb() * rgb / white();
  return {116 * n.y - 16, 500 * (n.x - n.y), 200 * (n.y - n.z)};
}

Vec3 rgb_from_ycxcz(const Vec3& v) {
  const double y = (v.x + 16) / 116;
  return rgb_from_xyz() * (Vec3(y + v.y / 500, y, y - v.z / 200) * white());
}

// CIE L*a*b* with the chroma scaled by luminance (Hunt).
Vec3 hunt_lab_from_rgb(const Vec3& rgb) {
  constexpr double kDelta = 6.0 / 29;
  Vec3 n = xyz_from_rgb() * rgb / white();
  for (int i = 0; i < 3; ++i)
    n[i] =
        n[i] > kDelta * kDelta * kDelta ? std::cbrt(n[i]) : n[i] / (3 * kDelta * kDelta) + 4.0 / 29;
  const double l = 116 * n.y - 16;
  return {l, 0.01 * l * 500 * (n.x - n.y), 0.01 * l * 200 * (n.y - n.z)};
}

double hyab(const Vec3& a, const Vec3& b) {
  const Vec3 d = a - b;
  return std::fabs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

// Rows by `horizontal`, then columns by `vertical`; the border is continued.
Plane filtered(const Plane& in, int width, int height, const Kernel& horizontal,
               const Kernel& vertical) {
  Plane rows(in.size()), out(in.size());
  const auto at = [width](int x, int y) {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  };
  const int rh = static_cast<int>(horizontal.size() / 2),
            rv = static_cast<int>(vertical.size() / 2);
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (int i = -rh; i <= rh; ++i)
        sum += horizontal[static_cast<size_t>(i + rh)] * in[at(std::clamp(x + i, 0, width - 1), y)];
      rows[at(x, y)] = sum;
    }
  });
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (int i = -rv; i <= rv; ++i)
        sum +=
            vertical[static_cast<size_t>(i + rv)] * rows[at(x, std::clamp(y + i, 0, height - 1))];
      out[at(x, y)] = sum;
    }
  });
  return out;
}

// Contrast sensitivity of a channel: a sum of Gaussians a sqrt(pi/b) exp(-pi^2 d^2 / b), d in
// degrees.
struct Gaussian {
  double a, b;
};
constexpr double kWidestB = 0.04;
const std::vector<Gaussian> kSensitivity[3] = {
    {{1, 0.0047}}, {{1, 0.0053}}, {{34.1, 0.04}, {13.5, 0.025}}};

Plane sensed(const Plane& in, int width, int height, const std::vector<Gaussian>& gaussians) {
  const int radius =
      static_cast<int>(std::ceil(3 * std::sqrt(kWidestB / (2 * kPi * kPi)) * kPixelsPerDegree));
  Plane out(in.size(), 0.0);
  double total = 0;
  for (const auto& [a, b] : gaussians) {
    Kernel g;
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) {
      const double d = i / kPixelsPerDegree;
      g.push_back(std::exp(-kPi * kPi * d * d / b));
      sum += g.back();
    }
    const double weight = a * std::sqrt(kPi / b);
    total += weight * sum * sum;
    const Plane part = filtered(in, width, height, g, g);
    for (size_t p = 0; p < out.size(); ++p) out[p] += weight * part[p];
  }
  for (double& v : out) v /= total;
  return out;
}

// Colour as it is seen: filtered, clipped to the display, in Hunt-adjusted L*a*b*.
std::vector<Vec3> seen_colour(const std::array<Plane, 3>& ycxcz, int width, int height) {
  std::array<Plane, 3> f;
  for (size_t c = 0; c < 3; ++c) f[c] = sensed(ycxcz[c], width, height, kSensitivity[c]);
  std::vector<Vec3> out(f[0].size());
  tbb::parallel_for(size_t{0}, out.size(), [&](size_t p) {
    out[p] =
        hunt_lab_from_rgb(glm::clamp(rgb_from_ycxcz(Vec3(f[0][p], f[1][p], f[2][p])), 0.0, 1.0));
  });
  return out;
}

// Strength of edges or points in the achromatic channel: norm of the filter across and along.
Plane features(const Plane& y, int width, int height, bool points) {
  const double sd = 0.5 * 0.082 * kPixelsPerDegree;
  const int radius = static_cast<int>(std::ceil(3 * sd));
  Kernel g, d;
  double sum = 0, positive = 0, negative = 0;
  for (int i = -radius; i <= radius; ++i) {
    const double x = i, e = std::exp(-x * x / (2 * sd * sd));
    g.push_back(e);
    sum += e;
    d.push_back((points ? x * x / (sd * sd) - 1 : -x) * e);
    (d.back() > 0 ? positive : negative) += std::fabs(d.back());
  }
  for (double& v : g) v /= sum;
  for (double& v : d) v /= v > 0 ? positive : negative;
  const Plane across = filtered(y, width, height, d, g), along = filtered(y, width, height, g, d);
  Plane out(y.size());
  for (size_t p = 0; p < out.size(); ++p) out[p] = std::hypot(across[p], along[p]);
  return out;
}

constexpr double kAces[6] = {0.6 * 0.6 * 2.51, 0.6 * 0.03, 0,  //
                             0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};

// Where the ACES curve takes the value t < 1.
double aces_inverse(double t) {
  const double q = kAces[0] - kAces[3] * t;
  const double c0 = (kAces[1] - kAces[4] * t) / q, c1 = (kAces[2] - kAces[5] * t) / q;
  return -0.5 * c0 + std::sqrt(0.25 * c0 * c0 - c1);
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const size_t n = v.size();
  return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

}  // namespace

double aces_curve(double x) {
  // Beyond 1e6 the curve is above 1 and its squares may overflow.
  if (x > 1e6) return 1;
  x = std::max(x, 0.0);
  return std::clamp(
      (kAces[0] * x * x + kAces[1] * x + kAces[2]) / (kAces[3] * x * x + kAces[4] * x + kAces[5]),
      0.0, 1.0);
}

std::vector<double> ldr_flip(const Planes& a, const Planes& b) {
  const int width = a.width, height = a.height;
  const size_t pixels = a.c[0].size();
  const Planes* images[2] = {&a, &b};
  std::vector<Vec3> colour[2];
  Plane edges[2], points[2];
  for (int i = 0; i < 2; ++i) {
    std::array<Plane, 3> ycxcz{Plane(pixels), Plane(pixels), Plane(pixels)};
    Plane y(pixels);
    for (size_t p = 0; p < pixels; ++p) {
      const Vec3 v =
          ycxcz_from_rgb(Vec3(images[i]->c[0][p], images[i]->c[1][p], images[i]->c[2][p]));
      for (size_t c = 0; c < 3; ++c) ycxcz[c][p] = v[static_cast<int>(c)];
      y[p] = (v.x + 16) / 116;
    }
    colour[i] = seen_colour(ycxcz, width, height);
    edges[i] = features(y, width, height, false);
    points[i] = features(y, width, height, true);
  }
  constexpr double kQc = 0.7, kQf = 0.5, kPc = 0.4, kPt = 0.95;
  const double largest =
      std::pow(hyab(hunt_lab_from_rgb({0, 1, 0}), hunt_lab_from_rgb({0, 0, 1})), kQc);
  std::vector<double> out(pixels);
  for (size_t p = 0; p < pixels; ++p) {
    const double e = std::pow(hyab(colour[0][p], colour[1][p]), kQc), knee = kPc * largest;
    const double dc = e < knee ? kPt / knee * e : kPt + (e - knee) / (largest - knee) * (1 - kPt);
    const double df = std::pow(
        std::max(std::fabs(edges[0][p] - edges[1][p]), std::fabs(points[0][p] - points[1][p])) /
            std::sqrt(2.0),
        kQf);
    out[p] = std::pow(dc, 1 - df);
  }
  return out;
}

std::vector<double> hdr_flip(const Planes& a, const Planes& b) {
  require_same_size(a, b);
  std::vector<double> y;
  for (size_t p = 0; p < b.c[0].size(); ++p)
    y.push_back(luminance(Vec3(b.c[0][p], b.c[1][p], b.c[2][p])));
  double brightest = *std::max_element(y.begin(), y.end());
  double middle = median(y);
  if (brightest > 0 && middle <= 0) {
    y.erase(std::remove_if(y.begin(), y.end(), [](double v) { return v <= 0; }), y.end());
    middle = median(y);
  }
  double start = 0, stop = 0;  // a black reference: as it is
  if (brightest > 0) {
    const double target = aces_inverse(0.85);
    start = std::log2(target / brightest);
    stop = std::log2(target / middle);
  }
  const int exposures = std::max(2, static_cast<int>(std::ceil(stop - start)));
  std::vector<double> worst(b.c[0].size(), 0.0);
  for (int i = 0; i < exposures; ++i) {
    const double scale = std::exp2(start + (stop - start) * i / (exposures - 1));
    Planes mapped[2] = {a, b};
    for (Planes& image : mapped)
      for (Plane& plane : image.c)
        for (double& v : plane) v = aces_curve(v * scale);
    const std::vector<double> flip = ldr_flip(mapped[0], mapped[1]);
    for (size_t p = 0; p < flip.size(); ++p) worst[p] = std::max(worst[p], flip[p]);
    if (stop == start) break;
  }
  return worst;
}

}  // namespace photonloom
