// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace vernier::stereo::internal {

/// A sampled Gaussian with sum one and its derivative with unit response to a ramp of one grey
/// level per pixel: the two factors of a separable gradient filter. Truncated at 3.5 σ.
struct GradientKernel {
  explicit GradientKernel(double scale_px);
  int reach;  ///< half-width in pixels
  std::vector<double> smooth, slope;
};

/// Gaussian-smoothed gradient of some rows of an image, grey levels per pixel (CV_32F). The border
/// is extended by replication.
struct GradientRows {
  /// Rows [first, end) of `grey`; reuses the memory if the number of rows is the same.
  void compute(const cv::Mat& grey, const GradientKernel& kernel, int first, int end);

  int first_row = 0;
  cv::Mat x, y, strength;
};

}  // namespace vernier::stereo::internal
