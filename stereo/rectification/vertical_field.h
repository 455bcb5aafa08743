// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "stereo/grey_levels.h"
#include "stereo/rectified_images.h"

namespace vernier::stereo::internal {

struct VerticalFieldOptions {
  int band_px = 5;                 ///< rows searched above and below, 1 to 10
  int corners = 98;                ///< number of corners of the left image, evenly distributed
  double min_score = 0.8;          ///< minimum ZNCC of aligned patches
  double min_correction_px = 0.1;  ///< fields that are smaller everywhere are not corrected
  /// Root mean square over the image above which matches along rows are not to be trusted: up to
  /// here they are as good as stated, or nearly (docs/rectification.md).
  double max_rms_px = 0.5;
};

/// Vertical offset of the right image of a pair relative to the left one, px, positive downwards:
///
///     dy(x, y) = a + b (x − cx) / w + c (y − cy) / h
///
/// at row y and the right image's column x; (cx, cy) is the image centre, w x h the size. The right
/// image at (x, y + dy(x, y)) corresponds to (x, y). This is the first-order error of a
/// rectification: a from the principal points and pitch, b from roll, c from the focal lengths.
struct VerticalField {
  Eigen::Vector3d coefficients_px{0, 0, 0};                  ///< a, b, c
  Eigen::Matrix3d covariance_px2 = Eigen::Matrix3d::Zero();  ///< of the coefficients
  int width_px = 0, height_px = 0;
  double residual_px = 0;    ///< robust standard deviation of a match about the field
  int corners = 0;           ///< in the left image, where it has texture
  int matched = 0;           ///< number of them with a match
  int used = 0;              ///< matches consistent with the field
  bool known = false;        ///< enough matches agree; if false, the coefficients are not valid
  bool significant = false;  ///< known, larger than its uncertainty and worth correcting
  bool misaligned = false;   ///< significant, and above max_rms_px by two standard deviations
  /// The pair is not rectified, or not of one scene: hardly any corner has a partner within the
  /// band, the matches agree on no affine field, or the field exceeds the band.
  bool unrectified = false;
  int band_px = 0;  ///< search range

  double dy_px(double x, double y) const {
    return coefficients_px[0] + coefficients_px[1] * (x - 0.5 * (width_px - 1)) / width_px +
           coefficients_px[2] * (y - 0.5 * (height_px - 1)) / height_px;
  }
  double largest_px() const;  ///< maximum |dy| over the image
  double rms_px() const;      ///< root mean square of dy over the image
};

/// Estimates the field of a pair from matched corners:
///
///  1. Harris corners of the left image at half its size (stereo/corners/harris_corners.h), each
///     searched in the right one by ZNCC over the disparities and the rows of the band, and back;
///  2. unambiguous matches are aligned at full size to sub-pixel accuracy
///     (stereo/image/patch_alignment.h);
///  3. RANSAC over triples (Fischler and Bolles 1981), then iteratively reweighted least squares
///     with Tukey's biweight. The covariance is the M-estimator's sandwich, A⁻¹ B A⁻¹ (Huber,
///     "Robust Statistics", 1981, section 6.3), valid for any distribution of the match errors if
///     they are independent;
///  4. if they tell no field: the same with corners that have several very similar places in the
///     right image, as on a chessboard. The disparity of such a match may be wrong by a period and
///     its row, on a board that is rolled, by a part of it: three in five must agree.
///
/// Independent of the number of threads. Throws Error for images of different sizes or with too few
/// values, an empty range, and options out of range.
VerticalField vertical_field(const RectifiedPair& pair,
                             const DisparityRange& range,
                             const VerticalFieldOptions& options = {});

/// The same for rectified images (stereo/rectified_images.h); corners near pixels without a source
/// are skipped.
VerticalField vertical_field(const RectifiedImages& images,
                             const DisparityRange& range,
                             const VerticalFieldOptions& options = {});

/// A summary in words: "the right image is 2.02 px lower (± 0.01) than the left one in the centre,
/// …", or the reason why no field could be estimated.
std::string describe(const VerticalField& field);

/// The right image with the field removed: its value at (x, y + dy(x, y)), by cubic convolution
/// (Keys 1981, a = −1/2) along the column, with replicated border. Returned unchanged if the field
/// is not significant. Throws Error for an image of another size than the field's.
GreyLevels corrected_right(const GreyLevels& right, const VerticalField& field);

/// The same in a pair, which keeps the noise that the right image had before.
void correct_right(const VerticalField& field, RectifiedPair& pair);

}  // namespace vernier::stereo::internal
