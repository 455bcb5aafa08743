// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"

namespace vernier::stereo::internal {

/// What blocks are compared by.
enum class StretchFilter {
  grey,        ///< grey levels
  derivative,  ///< differences along the row, smoothed along it by a Gaussian
  rank,        ///< how many more of the pixels about a pixel are darker than brighter
  census,      ///< which of eight pixels about a pixel are brighter, as eight images of signs
};

struct StretchOptions {
  int width_px = 17, height_px = 9;  ///< of a block (N and height), odd
  int step_x_px = 8, step_y_px = 4;  ///< between blocks
  int min_edges = 6;                 ///< non-horizontal edge points that a block must hold
  double min_angle_rad = 0.0873;     ///< edges nearer to the row (5°) are left out
  StretchFilter filter = StretchFilter::rank;
  double scale_px = 1;          ///< σ of the derivative's Gaussian
  int rank_reach_px = 4;        ///< of ranks, to either side
  double rank_least_grey = 4;   ///< grey levels: what is darker or brighter by no more is neither
  int stretches = 7;            ///< widths M that are tried, an odd number, from N / r to r N …
  double max_gradient = 1;      ///< … with r = (2 + this) / (2 − this); also between blocks
  int shears = 1;               ///< du_right / dv that are tried, an odd number, evenly …
  double max_shear = 0.5;       ///< … from minus this to this
  double min_score = 0.65;      ///< ZNCC
  int min_support = 5;          ///< of the eight blocks around within the disparity gradient
  double edge_reach_px = 2;     ///< from where the block says to a right edge of the same sign …
  double max_turn_rad = 0.785;  ///< … whose normal differs by no more than this …
  double max_contrast_ratio = 2.5;  ///< … and whose strength by no more than this factor
  CannyOptions right_edges{.low = 1, .high = 2, .min_points = 3, .with_sigma = false};
  int halvings = 1;   ///< of the images, to find where to search (coarse to fine); 0: everywhere
  int margin_px = 3;  ///< about disparities of smaller images or the last frame
  double full_search_share = 0.1;  ///< of the blocks that search everywhere all the same
  std::uint64_t seed = 1;          ///< of which blocks these are
  int threads = 1;                 ///< 0: as many as the machine has; no influence on results
};

/// What became of a block.
enum class BlockStatus {
  kept,
  few_edges,  ///< not searched
  weak,       ///< its score is too low
  lonely,     ///< too few of the blocks around agree
};

struct StretchBlock {
  int x = 0, y = 0;        ///< centre in the left image, pixels
  int edges = 0;           ///< points it holds
  int searched = 0;        ///< disparities
  float disparity_px = 0;  ///< at the centre
  float stretch = 1;       ///< M / N
  float shear = 0;         ///< du_right / dv
  float score = 0;         ///< ZNCC, of the best of all that were tried
  int support = 0;         ///< blocks around that agree
  BlockStatus fate = BlockStatus::few_edges;
};

/// Blocks of a pair, row by row.
struct StretchBlocks {
  int columns = 0, rows = 0;
  std::vector<StretchBlock> blocks;
};

/// A pair of a sequence.
struct StretchFrame {
  std::uint32_t number = 0;
  StretchBlocks blocks;
  std::vector<EdgeDisparity> at_edges;  ///< one for each left edge
};

/// The blocks' part of stretch correlation (Lane, Thacker and Seed, "Stretch-correlation as a
/// real-time alternative to feature-based stereo matching algorithms", Image and Vision Computing
/// 12, 1994). Where (x_c, y_c) is a block's centre, its pixel (x_c + i, y_c + j) is compared with
/// the right image at
///
///     u = x_c − d + (M / N) i + s j,   v = y_c + j
///
/// by first-order interpolation along the row, u − (x_c − d) in whole sixteenths of a pixel, for
/// all whole disparities d, widths M and shears s; the right image goes on with its outermost
/// pixels. The score is the zero-mean normalised cross-correlation of the filtered images. Of the
/// best (d, M) the vertices of parabolas through its neighbours are returned. A block is kept if
/// its score is high enough and enough of the eight around it are within the disparity gradient,
///
///     |d − d'| ≤ gradient · |cyclopean separation|,   (x − x' − (d − d') / 2, y − y')
///
/// Coarse to fine, the images at half their size are searched first, `halvings` times over. A block
/// then searches the disparities that kept blocks about it had there and `margin_px` more on either
/// side, and the stretches that they had and one more; everything where there are none. With
/// `last`, blocks of the pair before, it does the same by those, but for searching everything with
/// a chance of `full_search_share`, drawn for `frame`. Throws Error on what other matchers refuse
/// and on options that leave nothing to compare.
StretchBlocks stretch_blocks(const RectifiedPair& pair,
                             const std::vector<EdgePoint>& left_edges,
                             const DisparityRange& range,
                             const StretchOptions& options = {},
                             const StretchBlocks* last = nullptr,
                             std::uint32_t frame = 0);

/// Stretch correlation of a pair, the one after `last` if given. Each left edge point gets from the
/// best kept block that holds it
///
///     d(x, y) = d_c + (1 − M / N) (x − x_c) − s (y − y_c)
///
/// and then the disparity of the nearest right edge like it, between the places where both edges
/// cross its row. Its confidence is the block's score; no standard deviation is stated.
StretchFrame match_by_stretch(const RectifiedPair& pair,
                              const std::vector<EdgePoint>& left_edges,
                              const DisparityRange& range,
                              const StretchOptions& options = {},
                              const StretchFrame* last = nullptr);

/// The same for single pairs as a plug-in of the name `stretch`.
Matcher stretch_matcher(const StretchOptions& options = {});

}  // namespace vernier::stereo::internal
