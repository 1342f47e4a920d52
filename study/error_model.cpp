// SPDX-License-Identifier: Apache-2.0
#include "study/error_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace photonloom {
namespace {

// A term, its coefficient in most scenes and how far scenes are from that, as parts of the base's
// error.
struct Term {
  const char* name;
  double usual, spread;
};
constexpr std::array<Term, 15> kTerms = {{
    {"samples of pixel and hemisphere", 0.85, 0.3},
    {"few photons in a table of directions", 0.08, 0.1},
    {"few global photons", 0.01, 0.03},
    {"few photons in an estimate of the global map", 0.005, 0.02},
    {"blur of the global map", 0.01, 0.05},
    {"blur of the global map, squared", 0.005, 0.02},
    {"few caustic photons", 0.005, 0.03},
    {"few photons in an estimate of the caustic map", 0.01, 0.03},
    {"blur of the caustic map", 0.005, 0.03},
    {"blur of the caustic map, squared", 0.002, 0.02},
    {"bits of positions", 0.01, 0.05},
    {"bits of mantissas", 0.01, 0.03},
    {"bits of directions", 0.03, 0.1},
    {"approximate search", 0.25, 0.2},
    {"leaves left out", 0.5, 1},
}};
// Errors are known to this part of them.
constexpr double kKnown = 0.02;
// Of what is left over: how much a plan at the same place counts for beside nothing being left.
constexpr double kPull = 0.3;

// A map's part of the terms: noise of few photons, of few in an estimate, and blur.
void add_map(std::vector<double>& terms, const Plan& plan, const Plan& base, bool is_caustic) {
  const MapPlan &m = plan.map(is_caustic), &b = base.map(is_caustic);
  if (!m.present || !b.present) {
    terms.insert(terms.end(), 4, 0.0);
    return;
  }
  const double photons = static_cast<double>(m.photons) / static_cast<double>(b.photons);
  // Areas from which an estimate takes photons: that which holds k where they lie evenly, and that
  // within the radius. The smaller decides.
  const double nearest = static_cast<double>(plan.k) / base.k / photons;
  double area = nearest;
  if (m.radius > 0 && b.radius > 0) {
    const double within = m.radius * m.radius / (b.radius * b.radius);
    area = 2 / (1 / nearest + 1 / within);
  }
  terms.push_back(1 / photons);
  terms.push_back(1 / (photons * area));
  terms.push_back(area);
  terms.push_back(area * area);
}

double epsilon(const Plan& plan) {
  return std::ldexp(static_cast<double>(plan.epsilon_factor), -plan.epsilon_shift);
}

// Coefficients of at least 0 that minimise the sum over samples of ((sum of terms - error) / (known
// part of the error))^2 and over terms of ((coefficient - usual) / spread)^2, one at a time in
// turn.
std::vector<double> fit(const std::vector<ErrorSample>& samples) {
  std::vector<double> c;
  for (const Term& t : kTerms) c.push_back(t.usual);
  for (int round = 0; round < 2000; ++round) {
    double moved = 0;
    for (size_t j = 0; j < c.size(); ++j) {
      const double trust = 1 / (kTerms[j].spread * kTerms[j].spread);
      double slope = trust * kTerms[j].usual, curve = trust;
      for (const ErrorSample& s : samples) {
        const double w = 1 / (kKnown * kKnown * s.error * s.error);
        double rest = s.error;
        for (size_t i = 0; i < c.size(); ++i)
          if (i != j) rest -= c[i] * s.terms[i];
        slope += w * s.terms[j] * rest;
        curve += w * s.terms[j] * s.terms[j];
      }
      const double next = std::max(0.0, slope / curve);
      moved = std::max(moved, std::fabs(next - c[j]));
      c[j] = next;
    }
    if (moved < 1e-9) break;
  }
  return c;
}

double sum_of(const std::vector<double>& coefficients, const std::vector<double>& terms) {
  double sum = 0;
  for (size_t j = 0; j < terms.size(); ++j) sum += coefficients[j] * terms[j];
  return std::max(sum, std::numeric_limits<double>::min());
}

}  // namespace

std::vector<double> error_terms(const Plan& plan, const Plan& base) {
  std::vector<double> terms = {1, std::sqrt(static_cast<double>(base.k) / plan.k)};
  add_map(terms, plan, base, false);
  add_map(terms, plan, base, true);
  // A unit beside the radius that holds k.
  const double area = terms[4] > 0 ? terms[4] : std::max(terms[8], 1e-3);
  terms.push_back(std::ldexp(1.0, 2 * (10 - plan.position_bits)) / area);
  terms.push_back(std::ldexp(1.0, 2 * (4 - plan.mantissa_bits)));
  terms.push_back(std::ldexp(1.0, 2 * (4 - plan.direction_bits)));
  // The more leaves a query would visit, the more it misses.
  const double skips = (epsilon(plan) - 1) / 3;
  terms.push_back(skips * skips * plan.k / 16);
  // Lines that the nearest k fill, beside those that may be looked at.
  const double wanted = 3 + static_cast<double>(plan.k) / plan.bucket;
  const double part = plan.leaf_limit > 0 ? wanted / plan.leaf_limit : 0;
  terms.push_back(part * part);
  return terms;
}

const std::vector<const char*>& error_term_names() {
  static const std::vector<const char*> names = [] {
    std::vector<const char*> all;
    for (const Term& t : kTerms) all.push_back(t.name);
    return all;
  }();
  return names;
}

ErrorModel::ErrorModel(std::vector<ErrorSample> samples) : ErrorModel(std::move(samples), true) {}

ErrorModel::ErrorModel(std::vector<ErrorSample> samples, bool validate)
    : samples_(std::move(samples)), coefficients_(fit(samples_)) {
  for (const ErrorSample& s : samples_)
    left_over_.push_back(std::log(s.error / sum_of(coefficients_, s.terms)));
  if (!validate || samples_.size() < 2) return;
  double sum = 0;
  for (size_t i = 0; i < samples_.size(); ++i) {
    std::vector<ErrorSample> others = samples_;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const ErrorSample& s = samples_[i];
    const double off = ErrorModel(std::move(others), false).predict(s.terms, s.place) / s.error - 1;
    sum += off * off;
  }
  cross_validated_ = std::sqrt(sum / static_cast<double>(samples_.size()));
}

double ErrorModel::predict(const std::vector<double>& terms,
                           const std::vector<double>& place) const {
  double weights = kPull, sum = 0;
  for (size_t i = 0; i < samples_.size(); ++i) {
    double distance2 = 0;
    for (size_t j = 0; j < place.size(); ++j) {
      const double d = place[j] - samples_[i].place[j];
      distance2 += d * d;
    }
    const double weight = std::exp(-distance2 / 4);
    weights += weight;
    sum += weight * left_over_[i];
  }
  return sum_of(coefficients_, terms) * std::exp(sum / weights);
}

std::vector<double> ErrorModel::parts(const std::vector<double>& terms) const {
  std::vector<double> parts(terms.size());
  for (size_t j = 0; j < terms.size(); ++j) parts[j] = coefficients_[j] * terms[j];
  return parts;
}

}  // namespace photonloom
