// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "fuzz/same_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

constexpr double rounding = 1e-12;

void require_same_models(const Rig& a, const Rig& b) {
  require(a.cameras.size() == b.cameras.size(), "the number of cameras is kept");
  for (std::size_t i = 0; i < a.cameras.size(); ++i) {
    require(a.cameras[i].size_px == b.cameras[i].size_px, "image sizes are kept");
    require(a.cameras[i].model.index() == b.cameras[i].model.index(), "lens models are kept");
  }
}

void require_close_rotations(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  require((a - b).cwiseAbs().maxCoeff() <= rounding, "rotations are kept");
}

bool is_covariance(const std::optional<Covariance>& covariance) {
  if (!covariance) return false;
  return accepted([&] { return ScaledDecomposition(*covariance).raw_condition(); }).has_value();
}

void require_close_matrices(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  require(a.rows() == b.rows() && a.cols() == b.cols(), "the size of the covariance is kept");
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    for (Eigen::Index j = 0; j < a.cols(); ++j) {
      const double unit = std::sqrt(a(i, i)) * std::sqrt(a(j, j));
      require(same(a(i, j), b(i, j)) || std::abs(a(i, j) - b(i, j)) <= 1e-9 * unit,
              "the covariance is kept");
    }
  }
}

}  // namespace

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

void require_same(const Rig& a, const Rig& b) {
  require_same_models(a, b);
  for (std::size_t i = 0; i < a.cameras.size(); ++i) {
    require(a.cameras[i].name == b.cameras[i].name, "camera names are kept");
    require(a.cameras[i].parameters == b.cameras[i].parameters, "camera parameters are kept");
    require(a.T_camera_first[i].t == b.T_camera_first[i].t, "translations are kept");
    require_close_rotations(a.T_camera_first[i].R, b.T_camera_first[i].R);
  }
}

void require_close(const Rig& a, const Rig& b) {
  require_same_models(a, b);
  double length_m = 0;
  for (const Pose& T : a.T_camera_first) length_m = std::max(length_m, T.t.cwiseAbs().maxCoeff());
  for (std::size_t i = 0; i < a.cameras.size(); ++i) {
    const Eigen::VectorXd &p = a.cameras[i].parameters, &q = b.cameras[i].parameters;
    require(p.size() == q.size(), "the number of camera parameters is kept");
    for (Eigen::Index k = 0; k < p.size(); ++k) {
      require(std::abs(p[k] - q[k]) <= rounding * std::max(1.0, std::abs(p[k])),
              "camera parameters are kept");
    }
    const Pose &S = a.T_camera_first[i], &T = b.T_camera_first[i];
    require((S.t - T.t).cwiseAbs().maxCoeff() <= rounding * std::max(1.0, length_m),
            "translations are kept");
    require_close_rotations(S.R, T.R);
  }
}

namespace {

/// Position on the target and pixel of each corner of a view: which number a point of the target
/// has depends on the order of the file.
std::vector<std::array<double, 5>> corners_by_place(const BoardObservations& observations,
                                                    const BoardView& view) {
  std::vector<std::array<double, 5>> corners;
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    const Eigen::Vector3d& x = observations.target_m[static_cast<std::size_t>(view.ids[i])];
    const Eigen::Vector2d& p = view.pixels_px[i];
    corners.push_back({x.x(), x.y(), x.z(), p.x(), p.y()});
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

}  // namespace

void require_same(const BoardObservations& a, const BoardObservations& b) {
  require(a.size_px == b.size_px, "image sizes are kept");
  require(a.views.size() == b.views.size(), "the number of views is kept");
  for (std::size_t i = 0; i < a.views.size(); ++i) {
    const BoardView &v = a.views[i], &w = b.views[i];
    require(v.frame == w.frame && v.camera == w.camera, "frames and cameras are kept");
    require(corners_by_place(a, v) == corners_by_place(b, w), "corners are kept");
  }
}

void require_same(const PairObservations& a, const PairObservations& b) {
  require(a.pixels_px == b.pixels_px, "matches are kept");
  require(a.image_pairs.size() == b.image_pairs.size(), "the number of image pairs is kept");
  for (std::size_t i = 0; i < a.image_pairs.size(); ++i) {
    const ImagePair &p = a.image_pairs[i], &q = b.image_pairs[i];
    require(p.number == q.number && p.first == q.first && p.count == q.count,
            "image pairs are kept");
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    require(a.sigma_of(i) == b.sigma_of(i), "the noise of matches is kept");
  }
}

void require_same(const RigEstimate& a, const RigEstimate& b) {
  require_same(a.rig, b.rig);
  require(a.covariance.has_value() == b.covariance.has_value(), "the covariance is kept");
  if (is_covariance(a.covariance)) {
    require(a.covariance->kind == b.covariance->kind, "the kind of covariance is kept");
    require(a.covariance->names == b.covariance->names, "parameter names are kept");
    require_close_matrices(a.covariance->matrix, b.covariance->matrix);
  }
  require(a.calibration.has_value() == b.calibration.has_value(), "the calibration is kept");
  if (a.calibration) {
    const CalibrationSummary &s = *a.calibration, &t = *b.calibration;
    require(s.source == t.source && s.held == t.held && s.warnings == t.warnings &&
                s.trust_warnings == t.trust_warnings,
            "the words of the calibration are kept");
    require(s.dof == t.dof && s.views == t.views && same(s.chi2, t.chi2) &&
                same(s.rms_px, t.rms_px) && same(s.pixel_sigma_px, t.pixel_sigma_px),
            "the figures of the calibration are kept");
    require(s.effects.has_value() == t.effects.has_value() &&
                (!s.effects || (same(s.effects->white_px, t.effects->white_px) &&
                                same(s.effects->motion_m, t.effects->motion_m) &&
                                same(s.effects->motion_baseline_m, t.effects->motion_baseline_m) &&
                                same(s.effects->shape_height_m, t.effects->shape_height_m) &&
                                s.effects->shape_m.size() == t.effects->shape_m.size())),
            "random effects are kept");
    require(s.board_aspect.has_value() == t.board_aspect.has_value() &&
                (!s.board_aspect || (same(s.board_aspect->value, t.board_aspect->value) &&
                                     same(s.board_aspect->sigma, t.board_aspect->sigma))),
            "the board's aspect is kept");
    require(
        s.outliers.size() == t.outliers.size() && s.pair_outliers.size() == t.pair_outliers.size(),
        "outliers are kept");
  }
  require(a.evidence.has_value() == b.evidence.has_value(), "the evidence is kept");
  if (!a.evidence) return;
  require_same(a.evidence->pairs, b.evidence->pairs);
  require(a.evidence->warp_m == b.evidence->warp_m, "the board's warp is kept");
  require(a.evidence->frames == b.evidence->frames, "frames are kept");
  require(a.evidence->priors.size() == b.evidence->priors.size(), "priors are kept");
  if (!a.evidence->observations.views.empty()) {
    require_same(a.evidence->observations, b.evidence->observations);
  }
}

}  // namespace vernier::fuzz
