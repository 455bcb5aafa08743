// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "stereo/grey_levels.h"
#include "stereo/rectified_images.h"

namespace vernier::stereo::internal {

struct VerticalFieldOptions {
  int band_px = 5;                 ///< rows above and below that are searched, 1 to 10
  int corners = 98;                ///< of the left image, spread evenly over it
  double min_score = 0.8;          ///< ZNCC of aligned patches
  double min_correction_px = 0.1;  ///< a field that is nowhere larger is not worth a repair
};

/// How much lower the right image of a pair lies than the left one, px:
///
///     dy(x, y) = a + b (x − cx) / w + c (y − cy) / h
///
/// at row y and the right image's column x; (cx, cy) is the image's middle, w x h its size. What
/// the right image has at (x, y + dy(x, y)) belongs at (x, y). That is the small error of a
/// rectification to first order: a its centres' and pitch, b a roll, c focal lengths.
struct VerticalField {
  Eigen::Vector3d coefficients_px{0, 0, 0};                  ///< a, b, c
  Eigen::Matrix3d covariance_px2 = Eigen::Matrix3d::Zero();  ///< of the coefficients
  int width_px = 0, height_px = 0;
  double residual_px = 0;    ///< robust standard deviation of a match about the field
  int corners = 0;           ///< of the left image, where it has texture
  int matched = 0;           ///< of them
  int used = 0;              ///< matches that the field explains
  bool known = false;        ///< enough matches agree; else the coefficients are not to be used
  bool significant = false;  ///< known, beyond its own uncertainty and worth a repair
  /// The pair is no rectified one, or not of one scene: hardly any corner has a partner within the
  /// band, or the matches agree on no affine field, or on one that leaves the band.
  bool unrectified = false;
  int band_px = 0;  ///< that was searched

  double dy_px(double x, double y) const {
    return coefficients_px[0] + coefficients_px[1] * (x - 0.5 * (width_px - 1)) / width_px +
           coefficients_px[2] * (y - 0.5 * (height_px - 1)) / height_px;
  }
  double largest_px() const;  ///< |dy| over the image
};

/// The field of a pair, from its matched corners:
///
///  1. Harris corners of the left image at half its size (stereo/corners/harris_corners.h), each
///  sought in
///     the right one by ZNCC over the disparities and the rows of the band, and back;
///  2. those that stand out are aligned at full size to sub-pixel (stereo/image/patch_alignment.h);
///  3. RANSAC over triples (Fischler and Bolles 1981), then least squares reweighted by Tukey's
///     biweight. The covariance is that of an M-estimator, A⁻¹ B A⁻¹ (Huber, "Robust Statistics",
///     1981, section 6.3): it holds whatever the matches' errors are, if they are independent.
///
/// The same for any number of threads. Throws Error on images of unequal size or with too few
/// values, an empty range or options out of bounds.
VerticalField vertical_field(const RectifiedPair& pair,
                             const DisparityRange& range,
                             const VerticalFieldOptions& options = {});

/// The same of rectified images (stereo/rectified_images.h); corners beside pixels that have no
/// source are left out.
VerticalField vertical_field(const RectifiedImages& images,
                             const DisparityRange& range,
                             const VerticalFieldOptions& options = {});

/// In plain words: "the right image lies 2.02 px lower (± 0.01) in the middle, 0.40 px lower still
/// at its right edge than at its left …", or why it cannot be told.
std::string describe(const VerticalField& field);

/// The right image with the field taken away: its value at (x, y + dy(x, y)), by cubic convolution
/// (Keys 1981, a = −1/2) along the column. As it is where the field is not significant; beyond the
/// border, its outermost rows'. Throws Error on an image of another size than the field's.
GreyLevels corrected_right(const GreyLevels& right, const VerticalField& field);

}  // namespace vernier::stereo::internal
