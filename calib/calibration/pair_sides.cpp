// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/pair_sides.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/calibration/pair_checks.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/solver/packed_pairs.h"
#include "calib/statistics/quantile.h"

namespace vernier::internal {
namespace {

/// Number of pairs of an image pair that are used at most.
constexpr std::size_t enough_corners = 200;
constexpr double clear_difference = 25;  // of two costs

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
  const std::size_t step = std::max<std::size_t>(1, image.count / enough_corners);
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

Eigen::Vector4d exchanged(const Eigen::Vector4d& y) { return {y[2], y[3], y[0], y[1]}; }

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
  for (const Eigen::Vector4d& y : some) other.push_back(exchanged(y));
  const auto exchanged_before = quartile_before_px(rig, other);
  return exchanged_before && *exchanged_before > -limit ? Sides::swapped : Sides::unknown;
}

/// The prior's part of the cost, and the residuals' cut off at 5 standard deviations.
double cost_of_solution(const PairObservations& pairs,
                        const JointCalibration& solved,
                        double sigma_scale) {
  constexpr double limit = 5;
  double cost = solved.estimate.calibration->prior_chi2;
  for (const double r : PackedPairs(pairs).residuals(solved.estimate.rig)) {
    const double z = std::min(limit, std::abs(r) / sigma_scale);
    cost += z * z;
  }
  return cost;
}

SideCounts sides_at(const PairObservations& pairs, const JointCalibration& solved) {
  std::vector<bool> inlier(pairs.size(), true);
  for (const PairOutlier& out : solved.estimate.calibration->pair_outliers) inlier[out.row] = false;
  return count_sides(selected(pairs, inlier), solved.estimate.rig,
                     solved.estimate.covariance->matrix);
}

}  // namespace

SideCounts count_sides(const PairObservations& pairs,
                       const Rig& rig,
                       const Eigen::MatrixXd& covariance) {
  SideCounts counts;
  for (const ImagePair& image : pairs.image_pairs) {
    if (image.count < fewest_judged_matches) continue;
    ++counts.judged;
    const Sides sides = sides_of(rig, covariance, some_of(pairs, image));
    counts.right += sides == Sides::right;
    if (sides == Sides::swapped) counts.swapped.push_back(image.number);
  }
  return counts;
}

SideVerdict judge_sides(const PairObservations& pairs,
                        const GaussianRigPrior& prior,
                        const JointOptions& how,
                        const JointCalibration& given,
                        bool conflict) {
  if (prior.rig.cameras[0].size_px != prior.rig.cameras[1].size_px) return SideVerdict::as_given;
  const SideCounts sides = sides_at(pairs, given);
  const bool before = sides.right > 0 && sides.swapped.empty();
  if (sides.judged == 0 || (before && !conflict)) return SideVerdict::as_given;
  const bool behind = !sides.swapped.empty() && sides.right == 0;
  const SideVerdict otherwise = behind ? SideVerdict::behind : SideVerdict::as_given;
  PairObservations other = pairs;
  for (Eigen::Vector4d& y : other.pixels_px) y = exchanged(y);
  JointEvidence evidence;
  evidence.priors.push_back(prior);
  evidence.pairs = other;
  try {
    const JointCalibration swapped = calibrate_jointly(evidence, prior.rig, how);
    const SideCounts other_sides = sides_at(other, swapped);
    const double scale = std::min(given.pair_sigma_scale, swapped.pair_sigma_scale);
    const double gain =
        cost_of_solution(pairs, given, scale) - cost_of_solution(other, swapped, scale);
    const bool other_behind = !other_sides.swapped.empty();
    if (!other_behind && (gain > clear_difference || (behind && gain > -clear_difference))) {
      return SideVerdict::exchanged;
    }
    if (!before && !other_behind && std::abs(gain) <= clear_difference) {
      return SideVerdict::interchangeable;
    }
  } catch (const Error&) {  // the exchanged pairs fit nothing
  }
  return otherwise;
}

void doubt_sides(SideVerdict verdict, const std::string& place, CalibrationSummary& summary) {
  if (verdict == SideVerdict::as_given) return;
  if (verdict == SideVerdict::exchanged) {
    throw Error(place.empty() ? "pairs" : place,
                "left and right are swapped: exchanged, the corners fit the prior far better, or "
                "lie before the rig and not behind it",
                "exchange the images, or the cameras of the prior");
  }
  summary.trust_warnings.emplace_back(
      verdict == SideVerdict::behind
          ? "the corners lie behind the solved rig: left and right are swapped, or the prior's "
            "baseline has the wrong sign or direction"
          : "nothing tells left from right: the corners fit the prior as well with the images "
            "exchanged; "
            "if they are exchanged, the rotation has the wrong sign; make sure that the left "
            "images are "
            "the left camera's, or use a prior that knows the rotation better, or images of near "
            "things");
}

}  // namespace vernier::internal
