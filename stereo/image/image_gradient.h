// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace vernier::stereo::internal {

/// A sampled Gaussian of sum one and its derivative, of response one to a ramp of one grey level a
/// pixel: the two factors of a gradient's filter. Cut off at 3.5 σ.
struct GradientKernel {
  explicit GradientKernel(double scale_px);
  int reach;  ///< pixels on either side
  std::vector<double> smooth, slope;
};

/// The gradient behind a Gaussian in some rows of an image, grey levels a pixel (CV_32F). Beyond
/// its border the image goes on with its outermost pixels.
struct GradientRows {
  /// Rows [first, end) of `grey`, into the same memory where they are as many as before.
  void compute(const cv::Mat& grey, const GradientKernel& kernel, int first, int end);

  int first_row = 0;
  cv::Mat x, y, strength;
};

}  // namespace vernier::stereo::internal
