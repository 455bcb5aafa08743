// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification/vertical_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "stereo/corners/harris_corners.h"
#include "stereo/grey_levels.h"
#include "stereo/image/half_size.h"
#include "stereo/image/image_noise.h"
#include "stereo/image/matrix_of.h"
#include "stereo/image/patch_alignment.h"
#include "stereo/image/patch_search.h"
#include "stereo/rectification/vertical_field_fit.h"
#include "stereo/rectified_images.h"

namespace vernier::stereo::internal {
namespace {

constexpr double corners_a_cell = 2;  // per image cell, for an even distribution
constexpr int border_px = 5;          // for corners, at half size
constexpr int half_px = 4;            // of search patches, at half size
constexpr int aligned_half_px = 5;    // of aligned patches, at full size
constexpr double smoothing_px = 0.8;  // against aliasing of sharp images, which pulls alignments
                                      // to integer pixels: 0.05 px, 0.02 with it
constexpr double min_found = 0.7;     // ZNCC at half size
constexpr double min_margin = 0.05;
constexpr double min_repeated = 0.9;        // ZNCC of a match that is one of several, of which …
constexpr double min_share_repeated = 0.6;  // … so many agree: rows that repeat do not
constexpr double max_shift_px = 2;          // of the alignment, from twice the half-size peak
constexpr int min_side_px = 48;             // of an image; smaller images have no matches

void check(const RectifiedPair& pair,
           const DisparityRange& range,
           const VerticalFieldOptions& options) {
  const std::string place = "vertical field";
  const GreyLevels &l = pair.left, &r = pair.right;
  if (l.width_px != r.width_px || l.height_px != r.height_px) {
    throw Error(place,
                fmt::format("the left image is {}x{} px, the right one {}x{} px", l.width_px,
                            l.height_px, r.width_px, r.height_px),
                "use a rectified pair");
  }
  for (const GreyLevels* image : {&l, &r}) {
    const auto pixels = static_cast<std::size_t>(std::max(0, image->width_px)) *
                        static_cast<std::size_t>(std::max(0, image->height_px));
    if (image->values.size() == pixels) continue;
    throw Error(place,
                fmt::format("an image of {}x{} px has {} values", image->width_px, image->height_px,
                            image->values.size()),
                "give one value per pixel");
  }
  if (range.min_px > range.max_px) {
    throw Error(place,
                fmt::format("the disparity range {} to {} px is empty", range.min_px, range.max_px),
                "give the smaller value first");
  }
  if (options.band_px < 1 || options.band_px > 10 || options.corners < 1) {
    throw Error(
        place,
        fmt::format("the band has {} rows, with {} corners", options.band_px, options.corners),
        "use 1 to 10 rows and at least one corner");
  }
}

cv::Mat smoothed(const cv::Mat& image) {
  cv::Mat smooth;
  cv::GaussianBlur(image, smooth, {0, 0}, smoothing_px);
  return smooth;
}

cv::Point pixel_of(const ImageCorner& corner) {
  return {static_cast<int>(std::lround(corner.pixel_px.x())),
          static_cast<int>(std::lround(corner.pixel_px.y()))};
}

/// Corners' partners: the only similar place, or also one of several that are very similar.
enum class Partners { only, all };

/// Both images at full size, smoothed, and a search structure for each at half size.
struct FieldSearch {
  cv::Mat half_left, half_right, left, right;
  PatchSearch in_left, in_right;
  int min_x, max_x, rows;  ///< half-size pixels: disparities, and rows of the band

  FieldSearch(const RectifiedPair& pair, const DisparityRange& range, int band_px)
      : half_left(half_size(matrix_of(pair.left))),
        half_right(half_size(matrix_of(pair.right))),
        left(smoothed(matrix_of(pair.left))),
        right(smoothed(matrix_of(pair.right))),
        in_left(half_left, half_px),
        in_right(half_right, half_px),
        min_x(static_cast<int>(std::floor(0.5 * range.min_px)) - 1),
        max_x(static_cast<int>(std::ceil(0.5 * range.max_px)) + 1),
        rows((band_px + 1) / 2) {}

  /// Half-size position in the right image of a half-size left pixel, if confirmed by the reverse
  /// search and the only one that is similar or, if `kind` is all, very similar.
  std::optional<Eigen::Vector2d> partner(cv::Point p, Partners kind) {
    const auto there =
        in_right.find(half_left, p, {p.x - max_x, p.x - min_x, p.y - rows, p.y + rows});
    if (!there || there->score < min_found) return std::nullopt;
    const bool is_only = there->second <= there->score - min_margin;
    if (!is_only && (kind == Partners::only || there->score < min_repeated)) return std::nullopt;
    const cv::Point q = there->pixel;
    const auto back =
        in_left.find(half_right, q, {q.x + min_x, q.x + max_x, q.y - rows, q.y + rows});
    if (!back || std::abs(back->pixel.x - p.x) > 1 || std::abs(back->pixel.y - p.y) > 1) {
      return std::nullopt;
    }
    return there->peak_px;
  }
};

std::vector<VerticalOffset> row_offsets(FieldSearch& search,
                                        const std::vector<ImageCorner>& corners,
                                        Partners kind,
                                        const VerticalFieldOptions& options) {
  std::vector<VerticalOffset> offsets;
  for (const ImageCorner& corner : corners) {
    const cv::Point p = pixel_of(corner);
    const auto place = search.partner(p, kind);
    if (!place) continue;
    // The integer left pixel half a pixel from the patch centre needs no interpolation.
    const Eigen::Vector2d left_px(2 * p.x + 1, 2 * p.y + 1);
    const Eigen::Vector2d right_px = 2 * *place + Eigen::Vector2d(1, 1);
    const auto aligned = align_patch(search.left, search.right, left_px, right_px, {1, 0},
                                     {.half_px = aligned_half_px, .max_shift_px = max_shift_px});
    if (!aligned || aligned->score < options.min_score) continue;
    const double dy = aligned->right_px.y() - left_px.y();
    if (std::abs(dy) > options.band_px + 0.5) continue;
    offsets.push_back(
        {{aligned->right_px.x(), left_px.y()}, dy, std::sqrt(aligned->covariance_px2(1, 1))});
  }
  return offsets;
}

/// Part of a row that uses the same four rows of the right image.
struct Run {
  int first = 0, last = 0;  ///< columns, the last one not included
  std::array<const float*, 4> rows{};
  float beyond = 0,
        slope = 0;  ///< position beyond the second row: at the first column, and per column
};

/// Cubic convolution along the column.
void resample(const Run& run, float* repaired) {
  const auto [r0, r1, r2, r3] = run.rows;
  for (int x = run.first; x < run.last; ++x) {
    const float t = run.beyond + run.slope * static_cast<float>(x - run.first);
    const float t2 = t * t, t3 = t2 * t;
    const float sum = 0.5F * ((-t3 + 2 * t2 - t) * r0[x] + (3 * t3 - 5 * t2 + 2) * r1[x] +
                              (-3 * t3 + 4 * t2 + t) * r2[x] + (t3 - t2) * r3[x]);
    repaired[x] = std::clamp(sum, 0.0F, 255.0F);
  }
}

std::string tilt(double px, double sd, const char* far, const char* near) {
  return fmt::format("{:.2f} px {} (± {:.2f}) at its {} edge than at its {}", std::abs(px),
                     px >= 0 ? "lower" : "higher", sd, far, near);
}

/// Whether the pixels of a half-size patch have a source, tested at nine of them.
bool is_valid(const ValidPixels& valid, cv::Point half_size) {
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      const int x = 2 * (half_size.x + i * (half_px + 1)),
                y = 2 * (half_size.y + j * (half_px + 1));
      if (x < 0 || y < 0 || x >= valid.width_px || y >= valid.height_px || !valid(x, y))
        return false;
    }
  }
  return true;
}

/// `left_valid` may be null.
VerticalField found_field(const RectifiedPair& pair,
                          const ValidPixels* left_valid,
                          const DisparityRange& range,
                          const VerticalFieldOptions& options) {
  check(pair, range, options);
  const Eigen::Vector2i size(pair.left.width_px, pair.left.height_px);
  if (size.minCoeff() < min_side_px) return fit_vertical_field({}, 0, size, options);
  FieldSearch search(pair, range, options.band_px);
  const int cells = std::max(1, static_cast<int>(std::sqrt(options.corners / corners_a_cell)));
  auto corners = harris_corners(search.half_left, 0,
                                {.count = options.corners, .cells = cells, .border_px = border_px});
  std::erase_if(corners, [&](const ImageCorner& corner) {
    const cv::Point p = pixel_of(corner);
    return !has_texture(search.half_left, p, half_px) || (left_valid && !is_valid(*left_valid, p));
  });
  const auto field = [&](Partners kind) {
    return fit_vertical_field(row_offsets(search, corners, kind, options),
                              static_cast<int>(corners.size()), size, options);
  };
  VerticalField of_only = field(Partners::only);
  if (of_only.known) return of_only;
  VerticalField of_all = field(Partners::all);
  const bool agree = of_all.known && of_all.used >= min_share_repeated * of_all.matched;
  return agree ? of_all : of_only;
}

}  // namespace

VerticalField vertical_field(const RectifiedPair& pair,
                             const DisparityRange& range,
                             const VerticalFieldOptions& options) {
  return found_field(pair, nullptr, range, options);
}

VerticalField vertical_field(const RectifiedImages& images,
                             const DisparityRange& range,
                             const VerticalFieldOptions& options) {
  return found_field(images.pair, &images.left_valid, range, options);
}

std::string describe(const VerticalField& field) {
  const Eigen::Vector3d& p = field.coefficients_px;
  const Eigen::Vector3d sd = field.covariance_px2.diagonal().cwiseSqrt();
  if (!field.known && !field.unrectified) {
    return fmt::format(
        "too few corners match, or they are too close together, to estimate a vertical offset ({} "
        "of "
        "{})",
        field.matched, field.corners);
  }
  if (!field.known) {
    return fmt::format(
        "the images are not rectified, not of one scene, swapped, or their disparities exceed the "
        "range: {} of {} corners have a partner within {} rows, and {} of these agree on a "
        "vertical "
        "field",
        field.matched, field.corners, field.band_px, field.used);
  }
  const std::string of = fmt::format("from {} of {} matched corners", field.used, field.matched);
  if (!field.significant) {
    return fmt::format(
        "no significant vertical offset of the right image: {:+.2f} px (± {:.2f}) at the centre, "
        "at "
        "most {:.2f} px, {}",
        p[0], sd[0], field.largest_px(), of);
  }
  return fmt::format("the right image is {:.2f} px {} (± {:.2f}) at the centre, {}, {}, {}{}",
                     std::abs(p[0]), p[0] >= 0 ? "lower" : "higher", sd[0],
                     tilt(p[1], sd[1], "right", "left"), tilt(p[2], sd[2], "lower", "upper"), of,
                     field.unrectified
                         ? fmt::format("; this exceeds the search band of {} rows, so the images "
                                       "are probably not rectified",
                                       field.band_px)
                         : "");
}

GreyLevels corrected_right(const GreyLevels& right, const VerticalField& field) {
  if (right.width_px != field.width_px || right.height_px != field.height_px) {
    throw Error("vertical field",
                fmt::format("the field is for {}x{} px, the image is {}x{} px", field.width_px,
                            field.height_px, right.width_px, right.height_px),
                "use an image of the pair it was estimated from");
  }
  if (!field.significant) return right;
  GreyLevels repaired = right;
  const int width = right.width_px, last = right.height_px - 1;
  for (int y = 0; y <= last; ++y) {
    for (int x = 0; x < width;) {
      const auto top_at = [&](int at) {
        return static_cast<int>(std::floor(y + field.dy_px(at, y)));
      };
      const int top = top_at(x);
      Run run{.first = x, .slope = static_cast<float>(field.dy_px(1, y) - field.dy_px(0, y))};
      run.beyond = static_cast<float>(y + field.dy_px(x, y) - top);
      while (x < width && top_at(x) == top) ++x;
      run.last = x;
      for (int j = 0; j < 4; ++j) {
        run.rows[j] = &right.values[static_cast<std::size_t>(std::clamp(top + j - 1, 0, last)) *
                                    static_cast<std::size_t>(width)];
      }
      resample(run,
               &repaired.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)]);
    }
  }
  return repaired;
}

void correct_right(const VerticalField& field, RectifiedPair& pair) {
  if (!field.significant) return;
  GreyLevels corrected = corrected_right(pair.right, field);
  if (pair.right_noise.levels == 0) pair.right_noise.levels = image_noise(matrix_of(pair.right));
  pair.right = std::move(corrected);
}

}  // namespace vernier::stereo::internal
