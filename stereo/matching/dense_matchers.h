// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matching/edge_sampling.h"

/// OpenCV's dense matchers as plug-ins, for comparison.
///
/// Grey levels are rounded to 8 bits. OpenCV searches a multiple of 16 disparities: the range is
/// prolonged beyond its upper end, and what is found there is dropped. OpenCV leaves out pixels
/// whose whole range is not inside the right image, a band as wide as the largest disparity: both
/// images are prolonged by their border's grey levels, so that the band is matched too, and what is
/// found outside of the real right image is dropped.
///
/// Defaults are the settings of the least share of errors above 1 px, at a density above 0.9 (BM)
/// and 0.97 (SGBM), on the eleven Middlebury pairs of docs/matchers.md. There is no measure of how
/// sure a disparity is: a curve of error against density takes one matcher for each of several
/// uniqueness ratios. They run on as many threads as OpenCV is set to (cv::setNumThreads), which
/// nothing here changes; results do not depend on it. They throw Error for images of unequal size,
/// an empty range, one beyond the images' width or 2000 px, and options out of OpenCV's bounds.
namespace vernier::stereo::internal {

/// Block matching by the sum of absolute differences of a horizontal Sobel filter (Konolige, "Small
/// vision systems", 1997).
struct BmOptions {
  int block_px = 9;             ///< side, odd
  int pre_filter_cap = 31;      ///< of the filter's response
  int texture_threshold = 10;   ///< of the sum of a block's responses
  int uniqueness_percent = 10;  ///< by which the next best has to cost more
  int disp12_max_diff_px = 1;   ///< between the two directions; negative: not checked
  int speckle_px = 200;         ///< smaller regions are dropped; 0: none
  int speckle_range_px = 1;     ///< a step above it ends a region
  EdgeSampling sampling = EdgeSampling::foreground;
};

/// Along which paths SGBM sums: 5 or 8 directions of the whole image, 3 or 4.
enum class SgbmMode { five_paths, eight_paths, three_ways, four_paths };

/// Semi-global block matching: the cost of Birchfield and Tomasi (1998) summed along paths with
/// penalties p1 for steps of 1 px and p2 for larger ones (Hirschmüller, PAMI 30, 2008).
struct SgbmOptions {
  SgbmMode mode = SgbmMode::three_ways;
  int block_px = 3;             ///< side, odd
  int p1 = 0, p2 = 0;           ///< 0: 8 and 32 for each pixel of a block
  int pre_filter_cap = 63;      ///< of the horizontal Sobel filter
  int uniqueness_percent = 10;  ///< by which the next best has to cost more
  int disp12_max_diff_px = 1;   ///< between the two directions; OpenCV takes 0 and below for 1
  int speckle_px = 200;         ///< smaller regions are dropped; 0: none
  int speckle_range_px = 1;     ///< a step above it ends a region
  EdgeSampling sampling = EdgeSampling::foreground;
};

/// The whole map.
DisparityMap bm_map(const RectifiedPair& pair,
                    const DisparityRange& range,
                    const BmOptions& options = {});
DisparityMap sgbm_map(const RectifiedPair& pair,
                      const DisparityRange& range,
                      const SgbmOptions& options = {});

/// The map at the left edge points, as "bm" and "sgbm".
Matcher bm(const BmOptions& options = {});
Matcher sgbm(const SgbmOptions& options = {});

/// One matcher for each uniqueness ratio, named "sgbm 10 %", for curves of error against density.
std::vector<Matcher> by_uniqueness(const BmOptions& options,
                                   const std::vector<int>& percents = {0, 2, 5, 10, 15, 20, 30, 40,
                                                                       60});
std::vector<Matcher> by_uniqueness(const SgbmOptions& options,
                                   const std::vector<int>& percents = {0, 2, 5, 10, 15, 20, 30, 40,
                                                                       60});

}  // namespace vernier::stereo::internal
