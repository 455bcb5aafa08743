// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/rig.h"
#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/rectification.h"
#include "stereo/rectification/vertical_field.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

/// A rectified pair with row errors, and its ground truth warped with it.
struct WarpedPair {
  RectifiedPair pair;
  StereoTruth truth;         ///< disparities after the warp
  DisparityMap vertical_px;  ///< v_left − v_right of the point seen at a left pixel
  DisparityMap bias_px;      ///< its disparity minus that in the original pair
};

/// The pair obtained by rectifying the raw images with an erroneous rig (`believed`). A left pixel
/// of the new pair is mapped back through the raw image to the original pair, its true disparity is
/// looked up there, and both points are mapped forward again:
///
///     p = G_l(B_l⁻¹(p')),   (u_r, v_r) = B_r(G_r⁻¹(p − (d, 0))),   d' = u' − u_r,   dy' = v' − v_r
///
/// with G the rectification of raw pixels by the true rig and B that by the believed one, to the
/// same focal length, centre and size. Disparities are interpolated away from discontinuities.
/// Occluded points stay occluded; points outside the new right image become occluded. `geometry` is
/// the rectification of the original pair. Results do not depend on the number of threads (0: all
/// cores). Throws Error if pair, truth and geometry differ in size.
WarpedPair rectified_by(const Rig& believed,
                        const Rig& true_rig,
                        const RectifiedGeometry& geometry,
                        const RectifiedPair& pair,
                        const StereoTruth& truth,
                        int threads = 1);

/// The pair with the right image moved down by `lower_px`.
WarpedPair with_shifted_rows(const RectifiedPair& pair, const StereoTruth& truth, double lower_px);

/// Removes a vertical field from the right image and from `vertical_px`.
void repair(WarpedPair& warped, const VerticalField& field);

/// Ground truth at edges of the new left image, with the crossing of each: where the right image's
/// rows are off by dy', an edge with unit normal n crosses the row dy' n_y / n_x further on
/// (stereo/rectification/rectification_covariance.h). A long straight edge is matched there, a
/// corner at its own disparity, most features in between. Throws Error for edges outside the image.
std::vector<TruthAtEdge> truth_at(const WarpedPair& warped, const std::vector<EdgePoint>& edges);

}  // namespace vernier::stereo::internal
