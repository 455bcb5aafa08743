// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/localise/sampled_pgh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "calib/statistics/random.h"

namespace vernier::test {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::stereo;
using Eigen::Vector3d;

namespace {

constexpr int points = 240, draws = 400;

/// A line in space; those of a plane lie at z = 0, so that "from above" is the plane itself.
struct Sampled {
  Vector3d a, b;
  bool point = false;    // of the floor
  bool upright = false;  // errs as a whole
  double sigma = 0, weight = 0;
  int band = 0;

  Vector3d direction() const { return (b - a).normalized(); }
};

const std::vector<double>& quantiles() {
  static const std::vector<double> values = [] {
    std::vector<double> z;
    z.reserve(draws);
    for (int i = 0; i < draws; ++i) z.push_back(normal_quantile((i + 0.5) / draws));
    return z;
  }();
  return values;
}

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

struct Sampler {
  const PghOptions& o;
  bool in_plane;  // sides and senses are certain there
  int bands;

  int angle_bins() const {
    return o.angle_bins * (o.type == PghType::mirror ? 1 : o.type == PghType::rotation ? 2 : 4);
  }
  int distance_bins() const { return o.distance_bins * (o.type == PghType::directed ? 2 : 1); }

  void put_angle(double angle, double mass, std::vector<double>& bins) const {
    const double period = o.type == PghType::directed ? 2 * M_PI : M_PI;
    double x = angle - period * std::floor(angle / period);
    if (o.type == PghType::mirror) x = std::min(x, M_PI - x);
    const int bin = static_cast<int>(x / (M_PI / 2 / o.angle_bins));
    bins[std::min(bin, angle_bins() - 1)] += mass;
  }

  void put_distance(double d, double mass, std::vector<double>& bins) const {
    const double x = o.type == PghType::directed ? d + o.max_distance : std::abs(d);
    const double bin = std::floor(x / (o.max_distance / o.distance_bins));
    if (bin >= 0 && bin < distance_bins()) bins[static_cast<int>(bin)] += mass;
  }

  std::vector<double> angles(const Sampled& r, const Sampled& other) const {
    std::vector<double> bins(angle_bins(), other.point ? 1.0 / angle_bins() : 0.0);
    if (other.point) return bins;
    double variance = o.angle_sigma_rad * o.angle_sigma_rad;
    if (o.blur == PghBlur::per_entry) {
      variance = 0;
      for (const Sampled* line : {&r, &other}) {
        if (!line->upright) variance += 2 * std::pow(line->sigma / (line->b - line->a).norm(), 2);
      }
    }
    // Angles of uprights are exact; those at the end of the axis belong to both sides of it.
    const double sigma = std::max(std::sqrt(variance), 1e-7);
    const Vector3d u = r.direction();
    Vector3d v = other.direction();
    if (o.type != PghType::directed && u.dot(v) < 0) v = -v;
    const double angle = std::acos(std::clamp(u.dot(v), -1.0, 1.0));
    const double rise = u.cross(v).z();
    const double positive = in_plane ? (rise > 0 ? 1 : 0) : normal_cdf(rise / sigma);
    for (const double z : quantiles()) {
      put_angle(angle + sigma * z, positive / draws, bins);
      put_angle(-angle + sigma * z, (1 - positive) / draws, bins);
    }
    return bins;
  }

  std::vector<double> distances(const Sampled& r, const Sampled& other) const {
    std::vector<double> bins(distance_bins(), 0.0);
    const Vector3d u = r.direction();
    const double length = (r.b - r.a).norm();
    for (int i = 0; i < points; ++i) {
      const double t = (i + 0.5) / points;
      const Vector3d x = other.a + t * (other.b - other.a) - 0.5 * (r.a + r.b);
      const double along = u.dot(x), side = Vector3d(-u.y(), u.x(), 0).dot(x);
      double variance = o.distance_sigma * o.distance_sigma;
      if (o.blur == PghBlur::per_entry) {
        const double of_r = r.upright ? 1 : 0.5 + 2 * std::pow(along / length, 2);
        const double of_other = other.upright ? 1 : t * t + (1 - t) * (1 - t);
        variance = r.sigma * r.sigma * of_r + other.sigma * other.sigma * of_other;
      }
      const double sigma = std::sqrt(variance);
      const double distance = u.cross(x).norm();
      const double left = in_plane ? (side > 0 ? 1 : 0) : normal_cdf(side / sigma);
      for (const double z : quantiles()) {
        put_distance(distance + sigma * z, left / points / draws, bins);
        put_distance(-distance + sigma * z, (1 - left) / points / draws, bins);
      }
    }
    return bins;
  }

  HistogramRows rows(const std::vector<Sampled>& lines) const {
    std::vector<Eigen::RowVectorXd> found;
    for (const Sampled& r : lines) {
      if (r.point) continue;
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(bands * angle_bins() * distance_bins());
      for (const Sampled& other : lines) {
        if (&other == &r) continue;
        const std::vector<double> a = angles(r, other), d = distances(r, other);
        Eigen::Index at = other.band * angle_bins() * distance_bins();
        for (const double share : a) {
          for (const double mass : d) row[at++] += other.weight * share * mass;
        }
      }
      found.push_back(row / row.sum());
    }
    HistogramRows all(found.size(), found.empty() ? 0 : found[0].size());
    for (std::size_t i = 0; i < found.size(); ++i) all.row(i) = found[i].cast<float>();
    return all;
  }
};

/// So that the origin is on the left as seen from above.
void point_around_origin(Sampled& line) {
  if ((line.b - line.a).cross(-line.a).z() < 0) std::swap(line.a, line.b);
}

}  // namespace

HistogramRows sampled_image(std::span<const ImageSegment> lines, const PghOptions& options) {
  std::vector<Sampled> sampled;
  for (const ImageSegment& line : lines) {
    Sampled s{{line.a_px.x(), line.a_px.y(), 0}, {line.b_px.x(), line.b_px.y(), 0}};
    s.sigma = options.endpoint_sigma_px;
    s.weight = line.length_px();
    sampled.push_back(s);
  }
  return Sampler{options, true, 1}.rows(sampled);
}

HistogramRows sampled_ground(std::span<const PlaceLine> lines, const PghOptions& options) {
  std::vector<Sampled> sampled;
  for (const PlaceLine& line : lines) {
    Sampled s{line.a_m, line.b_m};
    s.a.z() = s.b.z() = 0;
    s.upright = s.point = line.kind == LineKind::vertical;
    s.band = s.point ? 1 : 0;
    s.sigma = line.sigma_m;
    s.weight = std::min(options.max_weight_m, s.point ? line.length_m() : (s.b - s.a).norm());
    point_around_origin(s);
    sampled.push_back(s);
  }
  return Sampler{options, true, 2}.rows(sampled);
}

HistogramRows sampled_spatial(std::span<const PlaceLine> lines, const PghOptions& options) {
  std::vector<Sampled> sampled;
  for (const PlaceLine& line : lines) {
    Sampled s{line.a_m, line.b_m};
    s.upright = line.kind == LineKind::vertical;
    s.sigma = line.sigma_m;
    s.weight = std::min(options.max_weight_m, line.length_m());
    const double height = 0.5 * (line.a_m.z() + line.b_m.z());
    s.band = std::clamp(static_cast<int>(std::floor(height / options.band_height_m)), 0,
                        options.height_bands - 1);
    const Vector3d d = s.b - s.a;
    if (std::abs(d.z()) > std::hypot(d.x(), d.y())) {
      if (d.z() < 0) std::swap(s.a, s.b);
    } else {
      point_around_origin(s);
    }
    sampled.push_back(s);
  }
  return Sampler{options, false, options.height_bands}.rows(sampled);
}

}  // namespace vernier::test
