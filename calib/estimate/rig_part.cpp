// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/rig_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {
namespace {

void check_kept(const Rig& rig, const std::vector<int>& kept) {
  if (kept.empty()) throw Error("rig", "none of its cameras is kept", "keep some");
  std::set<int> seen;
  for (const int camera : kept) {
    if (camera < 0 || camera >= static_cast<int>(rig.cameras.size())) {
      throw Error("rig", fmt::format("no camera {}: it has {}", camera, rig.cameras.size()),
                  "count cameras from 0");
    }
    if (!seen.insert(camera).second) {
      throw Error("rig", fmt::format("camera {} is kept twice", camera), "name it once");
    }
  }
}

/// The names that both rigs give the same parameter: all intrinsics, and the poses if the first
/// camera stays the first.
std::set<std::string> unchanged_names(const Rig& part, bool same_frame) {
  std::vector<std::string> names = parameter_names(part);
  if (!same_frame) names.resize(static_cast<std::size_t>(pose_index(part, 1)));
  return {names.begin(), names.end()};
}

CalibrationSummary summary_of(CalibrationSummary summary,
                              const Rig& part,
                              const std::vector<int>& kept) {
  const std::set<std::string> names = unchanged_names(part, kept[0] == 0);
  std::erase_if(summary.held, [&](const std::string& name) { return !names.contains(name); });
  std::vector<CornerOutlier> outliers;
  for (CornerOutlier& outlier : summary.outliers) {
    const auto place = std::find(kept.begin(), kept.end(), outlier.camera);
    if (place == kept.end()) continue;
    outlier.camera = static_cast<int>(place - kept.begin());
    outliers.push_back(std::move(outlier));
  }
  summary.outliers = std::move(outliers);
  return summary;
}

/// J C Jᵀ, exactly symmetric.
Eigen::MatrixXd carried(const Eigen::MatrixXd& C, const Eigen::MatrixXd& J) {
  const Eigen::MatrixXd D = J * C * J.transpose();
  return 0.5 * (D + D.transpose());
}

}  // namespace

Rig part_of(const Rig& rig, const std::vector<int>& kept) {
  check_kept(rig, kept);
  std::vector<PlacedCamera> cameras;
  for (const int camera : kept) {
    const auto i = static_cast<std::size_t>(camera);
    cameras.push_back({rig.cameras[i], rig.T_camera_first[i]});
  }
  return rig_of(std::move(cameras));
}

Eigen::MatrixXd part_by_rig(const Rig& rig, const std::vector<int>& kept) {
  const Rig part = part_of(rig, kept);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(parameter_count(part), parameter_count(rig));
  const int a = kept[0];
  for (int i = 0; i < static_cast<int>(kept.size()); ++i) {
    const int b = kept[static_cast<std::size_t>(i)];
    const int count = parameter_count(rig.cameras[static_cast<std::size_t>(b)].model);
    J.block(intrinsics_index(part, i), intrinsics_index(rig, b), count, count).setIdentity();
    if (i == 0) continue;
    const int row = pose_index(part, i);
    // The reference camera's pose is the identity and has no parameters.
    if (a == 0) {
      J.block<6, 6>(row, pose_index(rig, b)).setIdentity();
      continue;
    }
    const Eigen::Matrix3d& R = part.T_camera_first[static_cast<std::size_t>(i)].R;
    const Eigen::Matrix3d lever = hat(R * rig.T_camera_first[static_cast<std::size_t>(a)].t);
    Eigen::Matrix<double, 6, 6> by_b = Eigen::Matrix<double, 6, 6>::Identity(), turn = by_b;
    by_b.bottomLeftCorner<3, 3>() = lever;
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R;
    if (b != 0) J.block<6, 6>(row, pose_index(rig, b)) = by_b;
    J.block<6, 6>(row, pose_index(rig, a)) = -by_b * turn;
  }
  return J;
}

RigEstimate part_of(const RigEstimate& estimate, const std::vector<int>& kept) {
  check_kept(estimate.rig, kept);
  std::vector<int> all(estimate.rig.cameras.size());
  std::iota(all.begin(), all.end(), 0);
  if (kept == all) return estimate;
  RigEstimate part;
  part.rig = part_of(estimate.rig, kept);
  part.other_keys = estimate.other_keys;
  const Eigen::MatrixXd J = part_by_rig(estimate.rig, kept);
  if (estimate.covariance) {
    part.covariance = Covariance{estimate.covariance->kind, parameter_names(part.rig),
                                 carried(estimate.covariance->matrix, J)};
  }
  if (estimate.covariance_mvb) part.covariance_mvb = carried(*estimate.covariance_mvb, J);
  if (estimate.calibration) {
    part.calibration = summary_of(*estimate.calibration, part.rig, kept);
  }
  return part;
}

RigEstimate pair_of(const RigEstimate& estimate, int other) {
  if (other < 1 || other >= static_cast<int>(estimate.rig.cameras.size())) {
    throw Error("rig",
                fmt::format("no camera {} to pair with the first: it has {}", other,
                            estimate.rig.cameras.size()),
                "count cameras from 0");
  }
  RigEstimate pair = part_of(estimate, {0, other});
  pair.evidence.reset();
  return pair;
}

void require_pair(const Rig& rig,
                  const std::string& place,
                  const std::string& file,
                  const std::string& or_else) {
  const std::size_t count = rig.cameras.size();
  if (count == 2) return;
  const std::string fault =
      "it needs a pair and the rig has " + counted(static_cast<std::int64_t>(count), "camera");
  if (count < 2) throw Error(place, fault, or_else.empty() ? "give a rig of two cameras" : or_else);
  throw Error(place, fault,
              fmt::format("take two of them: vernier convert {} --cameras {},{} -o pair.json{}",
                          file, shortened(rig.cameras[0].name), shortened(rig.cameras[1].name),
                          or_else.empty() ? "" : ", or " + or_else));
}

}  // namespace vernier::internal
