// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/histograms/line_pairs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calib/base/plane_vectors.h"
#include "localise/histograms/pair_entry.h"
#include "localise/histograms/smeared_ramp.h"
#include "localise/pgh.h"

namespace vernier::localise::internal {

using vernier::internal::cross;

namespace {

/// Below any bin in width, above what would be divided by as zero.
double least_angle_sigma_rad() { return 1e-7; }
double least_distance_sigma(const PghOptions& options) { return 1e-9 * options.max_distance; }

double square(double x) { return x * x; }

/// Mean of x² where x goes evenly from one value to the other.
double mean_square(double from, double to) { return (from * from + from * to + to * to) / 3; }

double angle_variance(double length, const LineError& error) {
  return error.as_a_whole ? 0 : 2 * square(error.sigma / length);
}

/// Variance of the position of a line's points across it, averaged over offsets from its middle.
double position_variance(double from, double to, double length, const LineError& error) {
  const double spread = error.as_a_whole ? 1 : 0.5 + 2 * mean_square(from, to) / square(length);
  return square(error.sigma) * spread;
}

/// Blur of entries of one pair of lines.
template <int dimensions>
class PairBlur {
 public:
  using Line = PointingLine<dimensions>;

  PairBlur(const Line& reference, const Line& other, const PghOptions& options)
      : reference_(reference), other_(other), options_(options) {
    const typename Line::Point middle = 0.5 * (reference.a + reference.b);
    offset_a_ = reference.direction.dot(other.a - middle);
    offset_b_ = reference.direction.dot(other.b - middle);
  }

  double angle_sigma_rad() const {
    const double sigma = options_.blur == PghBlur::fixed
                             ? options_.angle_sigma_rad
                             : std::sqrt(angle_variance(reference_.length, reference_.error) +
                                         angle_variance(other_.length, other_.error));
    return std::max(sigma, least_angle_sigma_rad());
  }

  /// Of the part of the other line from t = from to t = to; 0 and 1 are its ends.
  double distance_sigma(double from, double to) const {
    const auto along_reference = [&](double t) { return offset_a_ + t * (offset_b_ - offset_a_); };
    const auto along_other = [&](double t) { return (t - 0.5) * other_.length; };
    const double sigma =
        options_.blur == PghBlur::fixed
            ? options_.distance_sigma
            : std::sqrt(position_variance(along_reference(from), along_reference(to),
                                          reference_.length, reference_.error) +
                        position_variance(along_other(from), along_other(to), other_.length,
                                          other_.error));
    return std::max(sigma, least_distance_sigma(options_));
  }

 private:
  const Line &reference_, &other_;
  const PghOptions& options_;
  double offset_a_ = 0, offset_b_ = 0;  // of the other's ends along the reference, from its middle
};

SmearedRamp ramp_between(double a, double b, double sigma) {
  return {std::min(a, b), std::max(a, b), sigma};
}

/// Part of an error-prone quantity that is positive, where it goes evenly from one value to the
/// other.
double positive_part(double from, double to, double sigma) {
  return 1 - mass_below(0, ramp_between(from, to, sigma));
}

/// Where a quantity that is a at t = 0 and b at t = 1 is zero; 0 if it is not between.
double zero_between(double a, double b) { return a * b < 0 ? a / (a - b) : 0; }

/// Angle between the lines and the part of it that counts as positive.
void set_angle(const SpaceLine& reference, const SpaceLine& other, PghType type, PairEntry& entry) {
  const Eigen::Vector3d normal = reference.direction.cross(other.direction);
  const double cosine = reference.direction.dot(other.direction);
  if (type == PghType::directed) {
    entry.angle_rad = std::atan2(normal.norm(), cosine);
    entry.positive = positive_part(normal.z(), normal.z(), entry.angle_sigma_rad);
    return;
  }
  entry.angle_rad = std::atan2(normal.norm(), std::abs(cosine));
  const double rise = cosine < 0 ? -normal.z() : normal.z();
  entry.positive = positive_part(rise, rise, entry.angle_sigma_rad);
}

void add_stretches_in_space(const SpaceLine& reference,
                            const SpaceLine& other,
                            const PghOptions& options,
                            PairEntry& entry) {
  const PairBlur<3> blur(reference, other, options);
  const Eigen::Vector3d& u = reference.direction;
  const auto across = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const Eigen::Vector3d y = x - reference.a;
    return y - u * u.dot(y);
  };
  const Eigen::Vector3d a = across(other.a), d = across(other.b) - a;
  // (z × u)·(x - p): positive to the left of the reference as seen from above.
  const auto side = [&](double t) {
    const Eigen::Vector3d x = a + t * d;
    return u.x() * x.y() - u.y() * x.x();
  };
  const bool directed = options.type == PghType::directed;
  const auto add = [&](double from, double to) {
    const double sigma = blur.distance_sigma(from, to);
    const double left = directed ? positive_part(side(from), side(to), sigma) : 1;
    entry.add({ramp_between((a + from * d).norm(), (a + to * d).norm(), sigma), to - from, left});
  };
  const double dd = d.squaredNorm();
  const bool parallel = dd < 1e-12;
  const bool constant_blur = options.blur == PghBlur::fixed;
  if (parallel && constant_blur) return add(0, 1);

  const double nearest = parallel ? 0 : std::clamp(-a.dot(d) / dd, 0.0, 1.0);
  const double change = directed ? zero_between(side(0), side(1)) : 0;
  const int pieces = directed || !constant_blur ? 4 : 2;
  double from = 0;
  for (const double to : {std::min(nearest, change), std::max(nearest, change), 1.0}) {
    if (!(to > from)) continue;
    for (int i = 0; i < pieces; ++i) {
      add(from + (to - from) * i / pieces, from + (to - from) * (i + 1) / pieces);
    }
    from = to;
  }
}

}  // namespace

PairEntry pair_in_plane(const PlaneLine& reference,
                        const PlaneLine& other,
                        const PghOptions& options) {
  const PairBlur<2> blur(reference, other, options);
  const Eigen::Vector2d& u = reference.direction;
  PairEntry entry;
  entry.angle_rad = std::atan2(cross(u, other.direction), u.dot(other.direction));
  entry.angle_sigma_rad = blur.angle_sigma_rad();
  const double a = cross(u, other.a - reference.a), b = cross(u, other.b - reference.a);
  const int pieces = options.blur == PghBlur::fixed ? 1 : 4;
  for (int i = 0; i < pieces; ++i) {
    const double from = static_cast<double>(i) / pieces, to = (i + 1.0) / pieces;
    entry.add({ramp_between(a + from * (b - a), a + to * (b - a), blur.distance_sigma(from, to)),
               to - from});
  }
  return entry;
}

PairEntry point_in_plane(const PlaneLine& reference,
                         const Eigen::Vector2d& point,
                         double sigma,
                         const PghOptions& options) {
  PairEntry entry;
  entry.angle_sigma_rad = std::numeric_limits<double>::infinity();
  double blur = options.distance_sigma;
  if (options.blur == PghBlur::per_entry) {
    const double offset = reference.direction.dot(point - 0.5 * (reference.a + reference.b));
    blur = std::sqrt(position_variance(offset, offset, reference.length, reference.error) +
                     square(sigma));
  }
  const double d = cross(reference.direction, point - reference.a);
  entry.add({{d, d, std::max(blur, least_distance_sigma(options))}, 1});
  return entry;
}

PairEntry pair_in_space(const SpaceLine& reference,
                        const SpaceLine& other,
                        const PghOptions& options) {
  PairEntry entry;
  entry.angle_sigma_rad = PairBlur<3>(reference, other, options).angle_sigma_rad();
  set_angle(reference, other, options.type, entry);
  add_stretches_in_space(reference, other, options, entry);
  return entry;
}

}  // namespace vernier::localise::internal
