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

/// Vertical disparity v_left − v_right (px) of a pixel pair rectified by `rig`
/// (stereo/rectification.h) at a rectified focal length; 0 for the true rig. Returns nullopt if a
/// pixel cannot be unprojected or is not in front of the rectified pair.
std::optional<double> vertical_disparity_px(const Rig& rig,
                                            const PixelPair& pair,
                                            double rectified_f_px);

/// Derivative by the rig's parameters (tangent of calib/rig.h), for a pair predicted by the rig
/// itself. With rays x0 and x1, essential matrix E = [T]x R and the normal of the epipolar plane n
/// = E x0 (right frame), the rectified rays y1 and n satisfy n·y = n_y y_y + n_z y_z, so that
///
///     v_left − v_right = −f e / (y1_z n_y),   e = x1ᵀ E x0,
///
/// exactly, and the derivative at e = 0 is −f de / (y1_z n_y). It depends on the common rotation of
/// both cameras about the baseline only through the position in the rectified image. For E: Hartley
/// and Zisserman, "Multiple View Geometry" (2nd ed., 2004), section 9.6.
std::optional<Eigen::RowVectorXd> vertical_disparity_by_rig(const Rig& rig,
                                                            const PixelPair& pair,
                                                            double rectified_f_px);

/// Standard deviation of the vertical disparity over the left image, for points at one distance
/// visible to both cameras. The part that an affine dy(x, y) fitted to matches can remove is
/// reported separately.
struct VerticalDisparityMap {
  int columns = 0, rows = 0;
  std::vector<double> x_px, y_px;  ///< left pixels, one per column, one per row
  std::vector<double> sd_px;       ///< row-major; NaN where a camera does not see the point
  int absent = 0;                  ///< number of NaN entries
  double rectified_f_px = 0;    ///< focal length that the pixels refer to: the mean of both cameras
  double rms_px = 0;            ///< root mean variance over the visible points
  double mean_sd_px = 0;        ///< standard deviation of the map's mean dy
  double rms_less_mean_px = 0;  ///< root mean variance after removing the mean of each draw
  /// Root mean variance after removing the best affine dy(x, y) of each draw.
  double rms_less_affine_px = 0;
};

/// Throws Error unless the rig has two cameras, the grid is at least 2x2 and distance_m > 0 (or
/// infinite).
VerticalDisparityMap vertical_disparity_map(const Rig& rig,
                                            const Eigen::MatrixXd& rig_covariance,
                                            int columns,
                                            int rows,
                                            double distance_m);

/// Monte Carlo: the same pixels rectified by each drawn rig.
struct SampledDisparity {
  double mean_px = 0;
  double sd_px = 0;               ///< about the mean, over the draws that can rectify the pair
  double non_physical_share = 0;  ///< fraction of draws that cannot
};
std::vector<SampledDisparity> sampled_vertical_disparity(const RigSampler& sampler,
                                                         std::span<const PixelPair> pairs,
                                                         double rectified_f_px,
                                                         const SamplingOptions& options = {});

/// The pixel pair of a point on the left pixel's ray, at `distance_m` along it or at infinity.
/// Returns nullopt if the pixel cannot be unprojected or the point is not in the right image.
std::optional<PixelPair> pair_at_distance(const Rig& rig,
                                          const Eigen::Vector2d& left_px,
                                          double distance_m);

}  // namespace vernier::stereo::internal
