// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "localise/place.h"
#include "stereo/segment.h"

namespace vernier::localise {

using HistogramRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Pairwise geometric histograms of a set of lines, one per line: a row is the histogram's square
/// root scaled to unit length, so that the dot product of two rows is their Bhattacharyya
/// coefficient (Thacker, Aherne and Rockett, Kybernetika 34, 1998).
struct Pgh {
  HistogramRows rows;       ///< lines x bins
  Eigen::VectorXf weights;  ///< per line: its length; in space at most max_weight_m
};

/// Resolution and blur. Every other line is entered into the histogram of a reference line at the
/// angle between them and over the range of distances of its points from the (infinite) reference
/// line, weighted by its length and blurred by the measurement error (Ashbrook et al. 1995; Aherne,
/// Thacker and Rockett, BMVC 1997).
struct PghOptions {
  int angle_bins = 6;  ///< over [0, 90] degrees, the mirror-symmetric representation
  int distance_bins = 24;
  double max_distance = 6;  ///< metres in space, pixels in the image; larger distances are dropped
  int height_bands = 5;     ///< of the other line's midpoint, spatial histograms only
  double band_height_m = 0.5;
  double angle_sigma_rad = 0.26;  ///< blur of each entry in angle
  double distance_sigma = 0.25;   ///< blur in distance, in the unit of max_distance
  double max_weight_m = 2;        ///< maximum weight of a line
  int max_lines = 100;            ///< the longest in the image are used
};

/// Histograms of lines in space: angle and distance in three dimensions, in bands of the other
/// line's height. A line with no other within reach gets no row. A line without a direction (its
/// ends less than 1e-9 apart, or not finite) is ignored. Throws Error for options out of range.
Pgh spatial_histograms(std::span<const PlaceLine> lines, const PghOptions& options = {});

/// Default options for image lines: pixels, no bands.
PghOptions image_pgh_options();

/// The same for lines in the image plane.
Pgh image_histograms(std::span<const stereo::ImageSegment> lines, const PghOptions& options);

}  // namespace vernier::localise
