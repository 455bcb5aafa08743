// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/rig_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/camera/same_lens_models.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/estimate/covariance_check.h"
#include "calib/estimate/held_parameters.h"
#include "calib/estimate/same_rig.h"
#include "calib/estimate/stable_coordinates.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/scaled_root.h"

namespace vernier {

using namespace internal;

namespace {

constexpr double null_direction = 1e-12;  // of the largest scaled variance
constexpr double same_in_sigma = 1e-6;    // along a null direction

/// Parameters that both rigs have, by index into each.
struct CommonParameters {
  std::vector<std::string> names;
  std::vector<Eigen::Index> in_a, in_b;
};

/// Distortion coefficients of a fisheye act on the angle, those of the other models on the tangent:
/// the same names with different meaning.
std::set<std::string> names_of_other_meaning(const Rig& a, const Rig& b) {
  std::set<std::string> names;
  for (std::size_t c = 0; c < a.cameras.size(); ++c) {
    const CameraModel &model_a = a.cameras[c].model, &model_b = b.cameras[c].model;
    if (std::holds_alternative<Fisheye4>(model_a) == std::holds_alternative<Fisheye4>(model_b)) {
      continue;
    }
    for (const CameraModel* model : {&model_a, &model_b}) {
      const std::vector<std::string> all = parameter_names(*model);
      for (std::size_t i = core_parameter_count; i < all.size(); ++i) {
        names.insert(a.cameras[c].name + "." + all[i]);
      }
    }
  }
  return names;
}

CommonParameters common_parameters(const Rig& a, const Rig& b, RigDifference& result) {
  const std::vector<std::string> all_a = parameter_names(a), all_b = parameter_names(b);
  const std::set<std::string> other = names_of_other_meaning(a, b);
  CommonParameters common;
  for (std::size_t i = 0; i < all_a.size(); ++i) {
    const auto found = std::find(all_b.begin(), all_b.end(), all_a[i]);
    if (found == all_b.end() || other.contains(all_a[i])) {
      result.only_in_a.push_back(all_a[i]);
      continue;
    }
    common.names.push_back(all_a[i]);
    common.in_a.push_back(static_cast<Eigen::Index>(i));
    common.in_b.push_back(found - all_b.begin());
  }
  for (const std::string& name : all_b) {
    if (std::find(common.names.begin(), common.names.end(), name) == common.names.end()) {
      result.only_in_b.push_back(name);
    }
  }
  return common;
}

/// Flags, one per parameter of each rig, of those without variance in both covariances.
struct HeldInBoth {
  std::vector<bool> in_a, in_b;
};

HeldInBoth held_in_both(const Rig& a,
                        const Covariance& covariance_a,
                        const Rig& b,
                        const Covariance& covariance_b,
                        const CommonParameters& common) {
  const std::vector<bool> held_a = without_variance(a, covariance_a.matrix),
                          held_b = without_variance(b, covariance_b.matrix);
  HeldInBoth held{std::vector<bool>(held_a.size()), std::vector<bool>(held_b.size())};
  for (std::size_t k = 0; k < common.names.size(); ++k) {
    const auto i = static_cast<std::size_t>(common.in_a[k]);
    const auto j = static_cast<std::size_t>(common.in_b[k]);
    held.in_a[i] = held.in_b[j] = held_a[i] && held_b[j];
  }
  return held;
}

/// b's parameters minus a's, rotations in the left tangent at a; rotations partly held in both as
/// rotation vectors.
Eigen::VectorXd difference_of(const Rig& a,
                              const Rig& b,
                              const CommonParameters& common,
                              const HeldInBoth& held) {
  const Eigen::VectorXd values_a = parameters(a), values_b = parameters(b);
  Eigen::VectorXd in_order_of_b = values_b;  // entries that a lacks are not used
  for (std::size_t k = 0; k < common.names.size(); ++k) {
    in_order_of_b[common.in_b[k]] -= values_a[common.in_a[k]];
  }
  for (std::size_t c = 1; c < b.cameras.size(); ++c) {
    const int i = pose_index(b, static_cast<int>(c));
    if (held.in_b[i] || held.in_b[i + 1] || held.in_b[i + 2]) continue;
    in_order_of_b.segment<3>(i) =
        vector_from_rotation(b.T_camera_first[c].R * a.T_camera_first[c].R.transpose());
  }
  return in_order_of_b(common.in_b);
}

/// Its covariance; zero for parameters held in both.
Eigen::MatrixXd covariance_of_difference(const Rig& a,
                                         const Covariance& covariance_a,
                                         const Rig& b,
                                         const Covariance& covariance_b,
                                         const CommonParameters& common,
                                         const HeldInBoth& held) {
  const Eigen::MatrixXd A = values_by_tangent(a, held.in_a), B = values_by_tangent(b, held.in_b);
  Eigen::MatrixXd sum = (A * covariance_a.matrix * A.transpose())(common.in_a, common.in_a) +
                        (B * covariance_b.matrix * B.transpose())(common.in_b, common.in_b);
  for (Eigen::Index k = 0; k < sum.rows(); ++k) {
    if (!held.in_a[static_cast<std::size_t>(common.in_a[static_cast<std::size_t>(k)])]) continue;
    sum.row(k).setZero();
    sum.col(k).setZero();
  }
  return sum;
}

void check_covariance(const Rig& rig, const Covariance& covariance, const char* place) {
  internal::check_names(covariance, rig, place);
  internal::check_covariance(covariance.matrix, rig, place);
}

/// b's coordinates about a and their covariance, in which errors are closer to normal than in the
/// tangent. std::nullopt where b has none: other models, or poses held in part.
struct StableDifference {
  Eigen::VectorXd delta;
  Eigen::MatrixXd covariance;
};

std::optional<StableDifference> stable_difference(const Rig& a,
                                                  const Covariance& covariance_a,
                                                  const Rig& b,
                                                  const Covariance& covariance_b,
                                                  const HeldInBoth& held) {
  if (!same_lens_models(a, b)) return std::nullopt;
  const auto first_pose = held.in_a.begin() + pose_index(a, 1);
  if (std::any_of(first_pose, held.in_a.end(), [](bool h) { return h; })) return std::nullopt;
  Eigen::MatrixXd both = covariance_a.matrix + covariance_b.matrix;
  for (Eigen::Index i = 0; i < both.rows(); ++i) {
    if (held.in_a[static_cast<std::size_t>(i)]) both(i, i) = 0;
  }
  const StableCoordinates about_a(a, both);
  const auto at = about_a.try_position(b);
  if (!at) return std::nullopt;
  return StableDifference{
      at->delta, covariance_a.matrix + at->by_rig * covariance_b.matrix * at->by_rig.transpose()};
}

/// d² and its components, over the parameters with a variance.
void measure(const Eigen::VectorXd& delta,
             const Eigen::MatrixXd& covariance,
             const std::vector<std::string>& names,
             RigDifference& result) {
  const ScaledEigen eigen(covariance);
  const Eigen::VectorXd z = delta.cwiseQuotient(eigen.deviations);
  const Eigen::VectorXd& s = eigen.values;
  for (Eigen::Index k = 0; k < s.size(); ++k) {
    const Eigen::VectorXd u = eigen.directions.col(k);
    const double along = u.dot(z);
    const std::string words = describe_direction(u, names);
    if (s[k] > null_direction * s[0]) {
      result.directions.push_back({std::abs(along) / std::sqrt(s[k]), words});
      result.mahalanobis2 += along * along / s[k];
      ++result.dof;
    } else if (std::abs(along) > same_in_sigma) {
      result.fixed_at_different_values.push_back("a direction without variance: " + words);
    }
  }
  std::stable_sort(result.directions.begin(), result.directions.end(),
                   [](const auto& x, const auto& y) { return x.in_sigma > y.in_sigma; });
}

}  // namespace

RigDifference rig_difference(const Rig& a,
                             const Covariance& covariance_a,
                             const Rig& b,
                             const Covariance& covariance_b) {
  check_same_cameras(a, b, "second rig");
  check_covariance(a, covariance_a, "first rig");
  check_covariance(b, covariance_b, "second rig");
  RigDifference result;
  const CommonParameters common = common_parameters(a, b, result);
  const HeldInBoth held = held_in_both(a, covariance_a, b, covariance_b, common);
  const Eigen::VectorXd delta = difference_of(a, b, common, held);
  const Eigen::MatrixXd sum =
      covariance_of_difference(a, covariance_a, b, covariance_b, common, held);
  const Eigen::VectorXd values_a = parameters(a), values_b = parameters(b);
  std::vector<Eigen::Index> known;
  std::vector<std::string> known_names;
  for (Eigen::Index k = 0; k < delta.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    ParameterDifference p{
        common.names[at], values_a[common.in_a[at]],           values_b[common.in_b[at]],
        delta[k],         std::sqrt(std::max(0.0, sum(k, k))), false};
    p.held = !(p.sigma > 0);
    if (!p.held) {
      known.push_back(k);
      known_names.push_back(p.name);
    } else if (std::abs(p.delta) > 1e-12 * (1 + std::abs(p.a))) {
      result.fixed_at_different_values.push_back(
          fmt::format("{} is fixed at {} in one and at {} in the other", p.name, p.a, p.b));
    }
    result.parameters.push_back(std::move(p));
  }
  if (!known.empty()) {
    const auto stable = result.fixed_at_different_values.empty()
                            ? stable_difference(a, covariance_a, b, covariance_b, held)
                            : std::nullopt;
    measure((stable ? stable->delta : delta)(known),
            (stable ? stable->covariance : sum)(known, known), known_names, result);
  }
  if (!result.fixed_at_different_values.empty()) {
    result.mahalanobis2 = std::numeric_limits<double>::infinity();
    result.p_value = 0;
  } else if (result.dof > 0) {
    result.p_value = chi_squared_survival(result.mahalanobis2, result.dof);
  }
  return result;
}

}  // namespace vernier
