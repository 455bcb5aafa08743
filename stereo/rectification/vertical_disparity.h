// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "calib/rig.h"
#include "calib/sampler.h"
#include "calib/triangulation.h"
#include "calib/uncertainty/sampled_propagation.h"

namespace vernier::stereo::internal {

/// Vertical disparity v_left − v_right (px) of a pixel pair in the pair rectified by `rig`
/// (stereo/rectification.h) at a rectified focal length; 0 where the rig is right. Nothing where a
/// pixel has no ray or is not in front of the rectified pair.
std::optional<double> vertical_disparity_px(const Rig& rig,
                                            const PixelPair& pair,
                                            double rectified_f_px);

/// Its derivative by the rig's parameters (tangent of calib/rig.h), for a pair that the rig itself
/// predicts. With rays x0 and x1, essential matrix E = [T]x R and the epipolar plane's normal
/// n = E x0 (right frame), the rectified rays y1 and n satisfy n·y = n_y y_y + n_z y_z, so that
///
///     v_left − v_right = −f e / (y1_z n_y),   e = x1ᵀ E x0,
///
/// exactly, and its derivative where e = 0 is −f de / (y1_z n_y). It does not depend on how both
/// cameras are turned together about the baseline but through the place in the rectified image.
/// Hartley and Zisserman, "Multiple View Geometry" (2nd ed., 2004), section 9.6 has E.
std::optional<Eigen::RowVectorXd> vertical_disparity_by_rig(const Rig& rig,
                                                            const PixelPair& pair,
                                                            double rectified_f_px);

/// Standard deviation of the vertical disparity over the left image, for points at one distance
/// that both cameras see. What an affine dy(x, y) fitted to matches can take away is told apart.
struct VerticalDisparityMap {
  int columns = 0, rows = 0;
  std::vector<double> x_px, y_px;  ///< left pixels, one a column, one a row
  std::vector<double> sd_px;       ///< row by row; NaN where a camera does not see the point
  int absent = 0;                  ///< how many it does not
  double rectified_f_px = 0;       ///< that of the pixels: the mean of both cameras'
  double rms_px = 0;               ///< root mean variance over the points seen
  double mean_sd_px = 0;           ///< standard deviation of the map's mean dy
  double rms_less_mean_px = 0;     ///< root mean variance once each draw's mean is taken away
  double rms_less_affine_px = 0;   ///< once each draw's best affine dy(x, y) is taken away
};

/// Throws Error unless the rig is a pair, the grid at least 2x2 and distance_m > 0 (or infinite).
VerticalDisparityMap vertical_disparity_map(const Rig& rig,
                                            const Eigen::MatrixXd& rig_covariance,
                                            int columns,
                                            int rows,
                                            double distance_m);

/// Sampled: the same pixels rectified by each drawn rig.
struct SampledDisparity {
  double mean_px = 0;
  double sd_px = 0;               ///< about the mean, over the draws that rectify the pair
  double non_physical_share = 0;  ///< draws that do not
};
std::vector<SampledDisparity> sampled_vertical_disparity(const RigSampler& sampler,
                                                         std::span<const PixelPair> pairs,
                                                         double rectified_f_px,
                                                         const SamplingOptions& options = {});

/// The pair of pixels at which a point on the left pixel's ray stands: at `distance_m` along it, or
/// infinity. Nothing where the ray is missing or the point is not in the right image.
std::optional<PixelPair> pair_at_distance(const Rig& rig,
                                          const Eigen::Vector2d& left_px,
                                          double distance_m);

}  // namespace vernier::stereo::internal
