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

/// A rectified pair as it looks where its rows are wrong, with its ground truth carried along.
struct WarpedPair {
  RectifiedPair pair;
  StereoTruth truth;         ///< what its points' disparities are now
  DisparityMap vertical_px;  ///< v_left − v_right of the point that a left pixel shows
  DisparityMap bias_px;      ///< its disparity less what it was in the pair as given
};

/// The pair that its own raw images give when they are rectified by a rig that is believed and not
/// true. A left pixel of the new pair is led back through the raw image to the pair as given, its
/// true disparity is taken there, and both are led forward again:
///
///     p = G_l(B_l⁻¹(p')),   (u_r, v_r) = B_r(G_r⁻¹(p − (d, 0))),   d' = u' − u_r,   dy' = v' − v_r
///
/// with G the rectification of raw pixels by the true rig and B that by the believed one, to the
/// same focal length, centre and size. Disparities are interpolated where there is no step. What
/// was occluded stays so; what the new right image does not reach becomes so. `geometry` is what
/// the pair as given was rectified to. Bits do not depend on the number of threads (0: as many as
/// the machine has). Throws Error where pair, truth and geometry are not of one size.
WarpedPair rectified_by(const Rig& believed,
                        const Rig& true_rig,
                        const RectifiedGeometry& geometry,
                        const RectifiedPair& pair,
                        const StereoTruth& truth,
                        int threads = 1);

/// The pair whose right image lies `lower_px` lower than it should.
WarpedPair with_shifted_rows(const RectifiedPair& pair, const StereoTruth& truth, double lower_px);

/// Takes a vertical field away from the right image, and from what remains of `vertical_px`.
void repair(WarpedPair& warped, const VerticalField& field);

/// The truth at edges of the new left image, with the crossing of each: where the right image's
/// rows are off by dy', an edge with unit normal n crosses the row dy' n_y / n_x further on
/// (stereo/rectification/rectification_covariance.h). A long straight edge is found there, a corner
/// at its own disparity, most things between the two. Throws Error for edges outside of the pair.
std::vector<TruthAtEdge> truth_at(const WarpedPair& warped, const std::vector<EdgePoint>& edges);

}  // namespace vernier::stereo::internal
