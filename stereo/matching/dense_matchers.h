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
/// extended at its upper end, and disparities found there are dropped. OpenCV skips pixels whose
/// full range is not inside the right image, a band as wide as the largest disparity: both images
/// are padded by replication so that the band is matched as well, and matches outside the real
/// right image are dropped.
///
/// The defaults minimise the fraction of errors above 1 px, at a density above 0.9 (BM) and 0.97
/// (SGBM), on the eleven Middlebury pairs of docs/matchers.md. OpenCV gives no confidence: an
/// error–density curve uses one matcher per uniqueness ratio. They use OpenCV's number of threads
/// (cv::setNumThreads), which is not changed here; results do not depend on it. They throw Error
/// for images of different sizes, an empty range, a range beyond the image width or 2000 px, and
/// options outside OpenCV's bounds.
namespace vernier::stereo::internal {

/// Block matching by the sum of absolute differences of a horizontal Sobel filter (Konolige, "Small
/// vision systems", 1997).
struct BmOptions {
  int block_px = 9;             ///< side length, odd
  int pre_filter_cap = 31;      ///< clipping of the filter response
  int texture_threshold = 10;   ///< minimum sum of a block's filter responses
  int uniqueness_percent = 10;  ///< by which the cost of the second best must exceed the best
  int disp12_max_diff_px = 1;   ///< left-right check; negative: off
  int speckle_px = 200;         ///< smaller regions are dropped; 0: off
  int speckle_range_px = 1;     ///< maximum disparity step within a region
  EdgeSampling sampling = EdgeSampling::foreground;
};

/// SGBM's aggregation paths: 5 or 8 directions over the full image, 3 or 4.
enum class SgbmMode { five_paths, eight_paths, three_ways, four_paths };

/// Semi-global block matching: the cost of Birchfield and Tomasi (1998) summed along paths with
/// penalties p1 for steps of 1 px and p2 for larger ones (Hirschmüller, PAMI 30, 2008).
struct SgbmOptions {
  SgbmMode mode = SgbmMode::three_ways;
  int block_px = 3;             ///< side length, odd
  int p1 = 0, p2 = 0;           ///< 0: 8 and 32 per pixel of a block
  int pre_filter_cap = 63;      ///< clipping of the horizontal Sobel filter
  int uniqueness_percent = 10;  ///< by which the cost of the second best must exceed the best
  int disp12_max_diff_px = 1;   ///< left-right check; OpenCV treats values <= 0 as 1
  int speckle_px = 200;         ///< smaller regions are dropped; 0: off
  int speckle_range_px = 1;     ///< maximum disparity step within a region
  EdgeSampling sampling = EdgeSampling::foreground;
};

/// The dense disparity map.
DisparityMap bm_map(const RectifiedPair& pair,
                    const DisparityRange& range,
                    const BmOptions& options = {});
DisparityMap sgbm_map(const RectifiedPair& pair,
                      const DisparityRange& range,
                      const SgbmOptions& options = {});

/// The map sampled at the left edge points, as matchers "bm" and "sgbm".
Matcher bm(const BmOptions& options = {});
Matcher sgbm(const SgbmOptions& options = {});

/// One matcher per uniqueness ratio, named "sgbm 10 %", for error–density curves.
std::vector<Matcher> by_uniqueness(const BmOptions& options,
                                   const std::vector<int>& percents = {0, 2, 5, 10, 15, 20, 30, 40,
                                                                       60});
std::vector<Matcher> by_uniqueness(const SgbmOptions& options,
                                   const std::vector<int>& percents = {0, 2, 5, 10, 15, 20, 30, 40,
                                                                       60});

}  // namespace vernier::stereo::internal
