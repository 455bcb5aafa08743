// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/pair_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/calibration/bent_plane.h"
#include "calib/calibration/observation_checks.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pair_observations.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/quantile.h"

namespace vernier::internal {
namespace {

/// Number of pairs of an image pair that are used at most.
constexpr std::size_t enough_pairs = 200;
constexpr std::size_t fewest_pairs = 12;  // of an image pair that is checked

/// The image of a point at infinity on the left pixel's ray in the right image, and the unit
/// direction in which it moves as the point comes nearer.
struct FarPoint {
  Eigen::Vector2d pixel_px, nearer;
};
std::optional<FarPoint> far_point(const Rig& rig, const Eigen::Vector2d& left_px) {
  const auto ray = try_unproject(rig.cameras[0], left_px);
  if (!ray) return std::nullopt;
  const Pose& T = rig.T_camera_first[1];
  const Eigen::Vector3d X = T.R * *ray;
  if (!(X.z() > 0)) return std::nullopt;
  ProjectionJacobian J;
  FarPoint far{project(rig.cameras[1], X, J), {}};
  far.nearer = (J.point * T.t).normalized();
  if (!far.nearer.allFinite()) return std::nullopt;
  return far;
}

/// Distance of a pair before infinity along its epipolar line, in pixels of the right image.
std::optional<double> before_infinity_px(const Rig& rig, const Eigen::Vector4d& y) {
  const std::optional<FarPoint> far = far_point(rig, y.head<2>());
  if (!far) return std::nullopt;
  return (y.tail<2>() - far->pixel_px).dot(far->nearer);
}

std::vector<Eigen::Vector4d> some_of(const PairObservations& pairs, const ImagePair& image) {
  const std::size_t step = std::max<std::size_t>(1, image.count / enough_pairs);
  std::vector<Eigen::Vector4d> some;
  for (std::size_t i = 0; i < image.count; i += step) {
    some.push_back(pairs.pixels_px[image.first + i]);
  }
  return some;
}

/// Lower quartile of the distances before infinity; std::nullopt if most pairs have none. An
/// approximate rig adds a common offset to all corners, so near corners show a wrong side best.
std::optional<double> quartile_before_px(const Rig& rig, const std::vector<Eigen::Vector4d>& some) {
  std::vector<double> before;
  for (const Eigen::Vector4d& y : some) {
    if (const auto b = before_infinity_px(rig, y)) before.push_back(*b);
  }
  if (2 * before.size() <= some.size()) return std::nullopt;
  return quantile(std::move(before), 0.25, QuantileKind::lower);
}

/// Standard deviation of that quartile due to the rig, by central differences.
double sigma_before_px(const Rig& rig,
                       const Eigen::MatrixXd& covariance,
                       const std::vector<Eigen::Vector4d>& some) {
  const auto p = covariance.rows();
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(p);
  for (Eigen::Index i = 0; i < p; ++i) {
    const double h = 1e-3 * std::sqrt(covariance(i, i));
    if (!(h > 0)) continue;
    const auto up = quartile_before_px(retract(rig, h * Eigen::VectorXd::Unit(p, i)), some);
    const auto down = quartile_before_px(retract(rig, -h * Eigen::VectorXd::Unit(p, i)), some);
    if (up && down) gradient[i] = (*up - *down) / (2 * h);
  }
  return std::sqrt(gradient.dot(covariance * gradient));
}

enum class Sides { right, swapped, unknown };

Sides sides_of(const Rig& rig,
               const Eigen::MatrixXd& covariance,
               const std::vector<Eigen::Vector4d>& some) {
  const auto before = quartile_before_px(rig, some);
  if (!before) return Sides::unknown;
  const double limit = 3 + 3 * sigma_before_px(rig, covariance, some);  // px: noise of the corners
  if (*before > limit) return Sides::right;
  if (*before > -limit) return Sides::unknown;
  std::vector<Eigen::Vector4d> other;
  for (const Eigen::Vector4d& y : some) {
    other.emplace_back();
    other.back() << y.tail<2>(), y.head<2>();
  }
  const auto exchanged_before = quartile_before_px(rig, other);
  return exchanged_before && *exchanged_before > -limit ? Sides::swapped : Sides::unknown;
}

/// Whether a plane explains almost all pairs within their noise. The lenses of an approximate rig
/// bend it, in directions that pairs on a plane cannot show, so both images get an r² term.
bool on_a_plane(const PairObservations& pairs,
                const ImagePair& image,
                const Rig& rig,
                double sigma_scale) {
  std::vector<PointPair> points;
  const double f = rig.cameras[1].f_px();
  std::vector<double> sigmas;
  const std::size_t step = std::max<std::size_t>(1, image.count / enough_pairs);
  for (std::size_t i = image.first; i < image.first + image.count; i += step) {
    const auto l = try_unproject(rig.cameras[0], pairs.pixels_px[i].head<2>());
    const auto r = try_unproject(rig.cameras[1], pairs.pixels_px[i].tail<2>());
    if (!l || !r) continue;
    points.push_back({l->head<2>(), r->head<2>()});
    sigmas.push_back(sigma_scale * pairs.sigma_of(i));
  }
  if (points.size() < fewest_pairs) return false;
  // Noise of both images in two coordinates: beyond four standard deviations once in 3000.
  return fraction_on_distorted_plane(
             points, 4 * std::sqrt(2.0) * quantile(sigmas, 0.5, QuantileKind::lower) / f) >= 0.95;
}

void check_rays(const PairObservations& pairs, const Rig& rig, const std::string& place) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (int c = 0; c < 2; ++c) {
      if (try_unproject(rig.cameras[static_cast<std::size_t>(c)],
                        pairs.pixels_px[i].segment<2>(2 * c))) {
        continue;
      }
      throw Error(
          place.empty() ? fmt::format("pair {}", i + 1) : fmt::format("{}:{}", place, i + 2),
          "the prior's " + rig.cameras[static_cast<std::size_t>(c)].name +
              " lens model cannot be inverted there (its distortion folds the image)",
          "use a prior whose distortion is valid up to the image's edge");
    }
  }
}

}  // namespace

void check_sides(const PairObservations& pairs,
                 const Rig& rig,
                 const Eigen::MatrixXd& covariance,
                 const std::string& place) {
  check_rays(pairs, rig, place);
  std::vector<int> exchanged_pairs;
  std::size_t judged = 0, right = 0;
  for (const ImagePair& image : pairs.image_pairs) {
    if (image.count < fewest_pairs) continue;
    ++judged;
    const Sides sides = sides_of(rig, covariance, some_of(pairs, image));
    right += sides == Sides::right;
    if (sides == Sides::swapped) exchanged_pairs.push_back(image.number);
  }
  if (exchanged_pairs.empty()) return;
  throw Error(place.empty() ? "pairs" : place,
              exchanged_pairs.size() == judged
                  ? "left and right are swapped: the corners lie behind the rig"
              : 2 * exchanged_pairs.size() > judged && right == 0
                  ? fmt::format("left and right are swapped: the corners of {} of {} image pairs "
                                "lie behind the rig, the others are ambiguous",
                                exchanged_pairs.size(), judged)
                  : fmt::format("left and right are swapped in image pairs {}: their corners lie "
                                "behind the rig",
                                fmt::join(exchanged_pairs, ", ")),
              "exchange the images, or the cameras of the prior");
}

ObservationDiagnosis check_scene(const PairObservations& pairs,
                                 const Rig& rig,
                                 double sigma_scale) {
  std::size_t judged = 0, flat = 0;
  for (const ImagePair& image : pairs.image_pairs) {
    if (image.count < fewest_pairs) continue;
    ++judged;
    flat += on_a_plane(pairs, image, rig, sigma_scale);
  }
  ObservationDiagnosis diagnosis;
  if (judged > 0 && flat == judged) {
    diagnosis.trust_warnings.emplace_back(
        "the corners of every image pair lie on one plane, or too far away for parallax: more of "
        "the rig is determined by the prior alone; use images of a scene with depth");
  } else if (2 * flat > judged) {
    diagnosis.warnings.push_back(fmt::format(
        "in {} of {} image pairs all corners lie on one plane, or too far away for parallax", flat,
        judged));
  }
  return diagnosis;
}

}  // namespace vernier::internal
