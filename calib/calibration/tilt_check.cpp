// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/tilt_check.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "calib/base/decompositions.h"
#include "calib/base/shown_text.h"
#include "calib/board/board_pose.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/observation_checks.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/solver/normal_equations.h"
#include "calib/statistics/quantile.h"

namespace vernier::internal {
namespace {

constexpr double parallel_rad = 0.07, undetermined = 0.2, untrusted = 0.05;
constexpr double nearly_parallel_rad = 0.15;  // with too few distinct tilts
constexpr const char* cure = "tilt the board by 20 to 45 degrees about both axes in several views";

double tilt_of(const Eigen::Vector3d& normal) {
  return std::acos(std::clamp(normal.z(), -1.0, 1.0));
}

/// The board normals of one camera, each from its image alone.
struct NormalsAlone {
  std::vector<Eigen::Vector3d> normals;
  double noise_px = 0;  ///< median of their residuals, per coordinate
};

NormalsAlone normals_alone(const BoardObservations& observations,
                           const BoardState& start,
                           int camera) {
  const Rig one{{start.rig.cameras[camera]}, {Pose{}}};
  NormalsAlone result;
  std::vector<double> rms;
  for (BoardView view : observations.views) {
    if (view.camera != camera) continue;
    view.camera = 0;
    const BoardPoseFit fit = fit_board_pose_both_ways(
        observations.target_m, view, one, board_pose(observations.target_m, view, one.cameras[0]));
    const Eigen::Vector3d normal = fit.T_first_board.R.col(2);
    result.normals.emplace_back(normal.z() < 0 ? Eigen::Vector3d(-normal) : normal);
    rms.push_back(fit.rms_px);
  }
  result.noise_px = quantile(std::move(rms), 0.5, QuantileKind::upper);
  return result;
}

/// Standard deviation of each camera's focal length divided by the focal length, for noise of one
/// pixel.
std::vector<double> focal_sd(const BoardObservations& observations, const BoardState& start) {
  const Rig& rig = start.rig;
  std::vector<double> sd(rig.cameras.size(), std::numeric_limits<double>::infinity());
  Eigen::MatrixXd S;
  try {
    S = reduced_normal_equations(observations, start, 1).information;
  } catch (const Error&) {
    return sd;  // not even the boards' poses are determined
  }
  const Eigen::VectorXd scale = S.diagonal().cwiseSqrt().cwiseInverse();
  S = scale.asDiagonal() * S * scale.asDiagonal();
  S.diagonal().array() += 1e-13;
  for (std::size_t c = 0; c < sd.size(); ++c) {
    const int f = intrinsics_index(rig, static_cast<int>(c));
    const double variance =
        solve_symmetric(S, Eigen::VectorXd(Eigen::VectorXd::Unit(S.rows(), f)))[f];
    if (variance > 0) sd[c] = scale[f] * std::sqrt(variance) / rig.cameras[c].f_px();
  }
  return sd;
}

}  // namespace

int distinct_tilts(const std::vector<Eigen::Vector3d>& normals, double apart_rad) {
  std::vector<Eigen::Vector3d> counted;
  for (const Eigen::Vector3d& normal : normals) {
    const bool is_new = std::all_of(counted.begin(), counted.end(), [&](const auto& other) {
      return std::acos(std::clamp(normal.dot(other), -1.0, 1.0)) >= apart_rad;
    });
    if (is_new) counted.push_back(normal);
  }
  return static_cast<int>(counted.size());
}

ObservationDiagnosis check_tilts(const BoardObservations& observations, const BoardState& start) {
  ObservationDiagnosis diagnosis;
  const std::vector<double> sd = focal_sd(observations, start);
  for (int c = 0; c < static_cast<int>(sd.size()); ++c) {
    const std::string place = fmt::format("camera {}", c);
    const Camera& camera = start.rig.cameras[c];
    const NormalsAlone alone = normals_alone(observations, start, c);
    const double known_to = sd[c] * alone.noise_px;
    // a focal length far too long makes noise look like tilts
    const double exaggeration = std::max(1.0, camera.f_px() / (1.5 * camera.size_px.maxCoeff()));
    double largest = 0;
    for (const auto& normal : alone.normals) largest = std::max(largest, tilt_of(normal));
    const int tilts = distinct_tilts(alone.normals);
    largest /= exaggeration;
    if ((tilts < 3 && largest < nearly_parallel_rad) ||
        (known_to > undetermined && largest < parallel_rad)) {
      throw Error(place,
                  "every board is parallel to the image, or nearly so, which leaves the focal "
                  "length undetermined",
                  cure);
    }
    if (tilts < 3) {
      throw Error(place,
                  fmt::format("its {} the board at only {}, and the intrinsics need three",
                              alone.normals.size() == 1
                                  ? "1 view shows"
                                  : fmt::format("{} views show", alone.normals.size()),
                              counted(static_cast<std::int64_t>(tilts), "distinct tilt")),
                  cure);
    }
    if (known_to < untrusted) continue;
    const std::string fault = fmt::format(
        "the boards are tilted too little to determine the focal length (to {:.0f} % at best)",
        100 * std::min(known_to, 10.0));
    if (known_to > undetermined) throw Error(place, fault, cure);
    diagnosis.trust_warnings.push_back(fmt::format("{}: {}; {}", place, fault, cure));
  }
  return diagnosis;
}

}  // namespace vernier::internal
