// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/dense_matchers.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "calib/error.h"
#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/image/matrix_of.h"
#include "stereo/matcher.h"
#include "stereo/matching/edge_sampling.h"
#include "stereo/matching/matcher_input.h"

namespace vernier::stereo::internal {
namespace {

// OpenCV's subdivisions of a pixel, and the divisor of its number of disparities.
constexpr int steps_a_px = 16;
constexpr int max_px = 2000;  // limit of 16-bit disparities

/// Padding of the images, so that none of their pixels is in OpenCV's unsearched band.
struct Border {
  int sides_px = 0, left_px = 0, right_px = 0;
};

/// The disparity range passed to OpenCV.
struct DenseSearch {
  int min_px = 0, count = 0;
  Border border;
};

DenseSearch search_of(const DisparityRange& range, int block_px) {
  DenseSearch search;
  search.min_px = range.min_px;
  search.count = (range.max_px - range.min_px + steps_a_px) / steps_a_px * steps_a_px;
  const int half = block_px / 2 + 1;
  search.border = {half, half + std::max(search.min_px + search.count, 0),
                   half + std::max(-search.min_px, 0)};
  return search;
}

cv::Mat eight_bits(const GreyLevels& grey, const Border& border) {
  cv::Mat wide;
  cv::copyMakeBorder(bytes_of(grey), wide, border.sides_px, border.sides_px, border.left_px,
                     border.right_px, cv::BORDER_REPLICATE);
  return wide;
}

void check(bool good, const char* place, const char* fault, const char* remedy) {
  if (!good) throw Error(place, fault, remedy);
}

/// OpenCV's result, without disparities outside the range or matches outside the right image.
DisparityMap cut_out(const cv::Mat& found,
                     const DenseSearch& search,
                     const RectifiedPair& pair,
                     const DisparityRange& range) {
  DisparityMap map{pair.left.width_px, pair.left.height_px, {}};
  map.values.reserve(pair.left.values.size());
  for (int y = 0; y < map.height_px; ++y) {
    const auto* row = found.ptr<short>(y + search.border.sides_px) + search.border.left_px;
    for (int x = 0; x < map.width_px; ++x) {
      const float d = static_cast<float>(row[x]) / steps_a_px, right = static_cast<float>(x) - d;
      const bool known = row[x] >= search.min_px * steps_a_px &&
                         d < static_cast<float>(range.max_px) + 0.5f && right > -0.5f &&
                         right < static_cast<float>(map.width_px) - 0.5f;
      map.values.push_back(known ? d : std::numeric_limits<float>::quiet_NaN());
    }
  }
  return map;
}

DisparityMap run(cv::StereoMatcher& matcher,
                 const RectifiedPair& pair,
                 const DisparityRange& range,
                 const DenseSearch& search,
                 const char* place) {
  cv::Mat found;
  try {
    matcher.compute(eight_bits(pair.left, search.border), eight_bits(pair.right, search.border),
                    found);
  } catch (const cv::Exception& error) {
    throw Error(place, "OpenCV error: " + error.err, "change the options");
  }
  return cut_out(found, search, pair, range);
}

DenseSearch checked_search(const RectifiedPair& pair,
                           const DisparityRange& range,
                           int block_px,
                           const char* place) {
  check_matcher_input(pair, range, place);
  check(std::max(std::abs(range.min_px), std::abs(range.max_px)) < max_px, place,
        "the search range reaches 2000 px, OpenCV's limit", "reduce the range or the images");
  return search_of(range, block_px);
}

template <typename Options>
std::vector<Matcher> for_each_uniqueness(Options options,
                                         const std::vector<int>& percents,
                                         Matcher (*make)(const Options&)) {
  std::vector<Matcher> matchers;
  for (const int percent : percents) {
    options.uniqueness_percent = percent;
    matchers.push_back(make(options));
    matchers.back().name += fmt::format(" {} %", percent);
  }
  return matchers;
}

}  // namespace

DisparityMap bm_map(const RectifiedPair& pair, const DisparityRange& range, const BmOptions& o) {
  const DenseSearch search = checked_search(pair, range, o.block_px, "bm");
  check(o.block_px % 2 == 1 && o.block_px >= 5 && o.block_px <= 255, "bm",
        "its block size is not 5, 7, … 255 px", "use an odd number");
  check(o.pre_filter_cap >= 1 && o.pre_filter_cap <= 63, "bm",
        "its pre-filter cap is not between 1 and 63", "use e.g. 31");
  check(o.uniqueness_percent >= 0 && o.texture_threshold >= 0, "bm",
        "its uniqueness or texture threshold is negative", "use 0 to disable it");
  const cv::Ptr<cv::StereoBM> matcher = cv::StereoBM::create(search.count, o.block_px);
  matcher->setMinDisparity(search.min_px);
  matcher->setPreFilterType(cv::StereoBM::PREFILTER_XSOBEL);
  matcher->setPreFilterCap(o.pre_filter_cap);
  matcher->setTextureThreshold(o.texture_threshold);
  matcher->setUniquenessRatio(o.uniqueness_percent);
  matcher->setDisp12MaxDiff(o.disp12_max_diff_px);
  matcher->setSpeckleWindowSize(o.speckle_px);
  matcher->setSpeckleRange(o.speckle_range_px * steps_a_px);  // in 1/16 px here, in pixels for SGBM
  return run(*matcher, pair, range, search, "bm");
}

DisparityMap sgbm_map(const RectifiedPair& pair,
                      const DisparityRange& range,
                      const SgbmOptions& o) {
  constexpr int modes[] = {cv::StereoSGBM::MODE_SGBM, cv::StereoSGBM::MODE_HH,
                           cv::StereoSGBM::MODE_SGBM_3WAY, cv::StereoSGBM::MODE_HH4};
  const DenseSearch search = checked_search(pair, range, o.block_px, "sgbm");
  check(o.block_px % 2 == 1 && o.block_px >= 1 && o.block_px <= 25, "sgbm",
        "its block size is not 1, 3, … 25 px", "use an odd number");
  const int p1 = o.p1 > 0 ? o.p1 : 8 * o.block_px * o.block_px;
  const int p2 = o.p2 > 0 ? o.p2 : 32 * o.block_px * o.block_px;
  check(p1 < p2, "sgbm", "its penalty p2 is not above p1", "use e.g. four times p1");
  check(o.uniqueness_percent >= 0 && o.uniqueness_percent <= 100, "sgbm",
        "its uniqueness is not between 0 and 100 %", "use e.g. 10");
  const cv::Ptr<cv::StereoSGBM> matcher =
      cv::StereoSGBM::create(search.min_px, search.count, o.block_px, p1, p2, o.disp12_max_diff_px,
                             o.pre_filter_cap, o.uniqueness_percent, o.speckle_px,
                             o.speckle_range_px, modes[static_cast<std::size_t>(o.mode)]);
  return run(*matcher, pair, range, search, "sgbm");
}

Matcher bm(const BmOptions& options) {
  return {"bm", [options](const auto& pair, const auto& edges, const auto& range) {
            return sample_at_edges(bm_map(pair, range, options), edges, options.sampling);
          }};
}

Matcher sgbm(const SgbmOptions& options) {
  return {"sgbm", [options](const auto& pair, const auto& edges, const auto& range) {
            return sample_at_edges(sgbm_map(pair, range, options), edges, options.sampling);
          }};
}

std::vector<Matcher> by_uniqueness(const BmOptions& options, const std::vector<int>& percents) {
  return for_each_uniqueness(options, percents, &bm);
}

std::vector<Matcher> by_uniqueness(const SgbmOptions& options, const std::vector<int>& percents) {
  return for_each_uniqueness(options, percents, &sgbm);
}

}  // namespace vernier::stereo::internal
