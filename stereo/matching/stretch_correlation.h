// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"

namespace vernier::stereo::internal {

/// Image filter applied before correlation.
enum class StretchFilter {
  grey,        ///< grey levels
  derivative,  ///< differences along the row, smoothed along it by a Gaussian
  rank,        ///< number of darker minus brighter pixels around a pixel
  census,      ///< comparison with eight pixels around a pixel, as eight sign images
};

struct StretchOptions {
  int width_px = 17, height_px = 9;  ///< block size (N and height), odd
  int step_x_px = 8, step_y_px = 4;  ///< block spacing
  int min_edges = 6;                 ///< minimum number of non-horizontal edge points in a block
  double min_angle_rad = 0.0873;     ///< edges closer to horizontal (5°) are excluded
  StretchFilter filter = StretchFilter::rank;
  double scale_px = 1;         ///< σ of the derivative's Gaussian
  int rank_reach_px = 4;       ///< half-width of the rank filter
  double rank_least_grey = 4;  ///< minimum difference to count as darker or brighter, grey levels
  int stretches = 7;           ///< number of widths M searched, odd, from N / r to r N …
  double max_gradient = 1;  ///< … with r = (2 + this) / (2 − this); also the limit between blocks
  int shears = 1;           ///< number of shears du_right / dv searched, odd, evenly …
  double max_shear = 0.5;   ///< … from minus this to this
  double min_score = 0.65;  ///< minimum ZNCC
  /// Minimum number of the eight adjacent blocks within the disparity gradient limit.
  int min_support = 5;
  double edge_reach_px = 2;         ///< maximum distance to a right edge of the same sign …
  double max_turn_rad = 0.785;      ///< … maximum angle between the normals …
  double max_contrast_ratio = 2.5;  ///< … and maximum ratio of edge strengths
  CannyOptions right_edges{.low = 1, .high = 2, .min_points = 3, .with_sigma = false};
  /// Number of times the images are halved for coarse-to-fine search; 0: full search.
  int halvings = 1;
  /// Added to the range of disparities from the coarser level or the last frame.
  int margin_px = 3;
  double full_search_share =
      0.1;                 ///< fraction of the blocks that search the full range nevertheless
  std::uint64_t seed = 1;  ///< selects these blocks
  int threads = 1;         ///< 0: all cores; no influence on results
};

/// Status of a block.
enum class BlockStatus {
  kept,
  few_edges,  ///< not searched
  weak,       ///< ZNCC below min_score
  lonely,     ///< too few adjacent blocks agree
};

struct StretchBlock {
  int x = 0, y = 0;        ///< centre in the left image, pixels
  int edges = 0;           ///< number of edge points in it
  int searched = 0;        ///< number of disparities
  float disparity_px = 0;  ///< at the centre
  float stretch = 1;       ///< M / N
  float shear = 0;         ///< du_right / dv
  float score = 0;         ///< ZNCC, best over the search
  int support = 0;         ///< number of adjacent blocks that agree
  BlockStatus fate = BlockStatus::few_edges;
};

/// Blocks of a pair, row-major.
struct StretchBlocks {
  int columns = 0, rows = 0;
  std::vector<StretchBlock> blocks;
};

/// Result for one pair of a sequence.
struct StretchFrame {
  std::uint32_t number = 0;
  StretchBlocks blocks;
  std::vector<EdgeDisparity> at_edges;  ///< one per left edge
};

/// Block search of stretch correlation (Lane, Thacker and Seed, "Stretch-correlation as a real-time
/// alternative to feature-based stereo matching algorithms", Image and Vision Computing 12, 1994).
/// A block with centre (x_c, y_c) compares its pixel (x_c + i, y_c + j) with the right image at
///
///     u = x_c − d + (M / N) i + s j,   v = y_c + j
///
/// by linear interpolation along the row, u − (x_c − d) in integer sixteenths of a pixel, for all
/// integer disparities d, widths M and shears s; the right image's border is replicated. The score
/// is the zero-mean normalised cross-correlation of the filtered images. The best (d, M) is refined
/// by parabolas through its neighbours. A block is kept if its score is high enough and enough of
/// the eight adjacent blocks are within the disparity gradient limit,
///
///     |d − d'| ≤ gradient · |cyclopean separation|,   (x − x' − (d − d') / 2, y − y')
///
/// Coarse to fine, images of half the size are searched first, `halvings` times. A block then
/// searches the disparities that kept blocks around it had there, with `margin_px` on either side,
/// and their stretches with one more on either side; the full range if there are none. With `last`,
/// the blocks of the previous pair, it uses those in the same way, but a block searches the full
/// range with probability `full_search_share`, drawn for `frame`. Throws Error for invalid matcher
/// input and for options out of range.
StretchBlocks stretch_blocks(const RectifiedPair& pair,
                             const std::vector<EdgePoint>& left_edges,
                             const DisparityRange& range,
                             const StretchOptions& options = {},
                             const StretchBlocks* last = nullptr,
                             std::uint32_t frame = 0);

/// Stretch correlation of a pair, following `last` if given. Each left edge point gets from the
/// best kept block that contains it
///
///     d(x, y) = d_c + (1 − M / N) (x − x_c) − s (y − y_c)
///
/// and then the disparity of the nearest compatible right edge, between the positions where both
/// edges cross its row. Its confidence is the block's score; there is no standard deviation.
StretchFrame match_by_stretch(const RectifiedPair& pair,
                              const std::vector<EdgePoint>& left_edges,
                              const DisparityRange& range,
                              const StretchOptions& options = {},
                              const StretchFrame* last = nullptr);

/// The same for single pairs as a plug-in named `stretch`.
Matcher stretch_matcher(const StretchOptions& options = {});

}  // namespace vernier::stereo::internal
