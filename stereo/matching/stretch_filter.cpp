// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/stretch_filter.h"

#include <algorithm>
#include <cmath>

#include "stereo/grey_levels.h"
#include "stereo/image/padded_image.h"
#include "stereo/matching/stretch_correlation.h"

// As in calib/solver/view_kernel.cpp.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stereo/matching/stretch_filter.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vernier::stereo::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Rank filter of n pixels: number of darker minus brighter pixels in the square around each, by
/// more than `least`; writes up to a vector more. `rows` are those from `reach` above to `reach`
/// below, each from `reach` pixels before the first.
void ranks(
    const std::int16_t* const* rows, int reach, std::int16_t least, int n, std::int16_t* out) {
  const hn::ScalableTag<std::int16_t> lanes;
  const int side = 2 * reach + 1;
  const auto apart = hn::Set(lanes, least);
  for (int x = 0; x < n; x += static_cast<int>(hn::Lanes(lanes))) {
    const auto centre = hn::LoadU(lanes, rows[reach] + reach + x);
    const auto low = hn::SaturatedSub(centre, apart), high = hn::SaturatedAdd(centre, apart);
    auto count = hn::Zero(lanes);
    for (int j = 0; j < side; ++j) {
      const std::int16_t* const row = rows[j] + x;
      for (int i = 0; i < side; ++i) {
        const auto there = hn::LoadU(lanes, row + i);
        count = hn::Sub(count, hn::VecFromMask(lanes, hn::Lt(there, low)));
        count = hn::Add(count, hn::VecFromMask(lanes, hn::Lt(high, there)));
      }
    }
    hn::StoreU(count, lanes, out + x);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::stereo::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::stereo::internal {

HWY_EXPORT(ranks);

namespace {

constexpr int vector_pixels = 64;  // row padding for vector reads and writes

std::int16_t whole(float value) {
  constexpr float most = max_filtered;
  return static_cast<std::int16_t>(std::lround(std::clamp(value, -most, most)));
}

void repeat_borders(FilteredImage& image) {
  for (int plane = 0; plane < image.planes; ++plane) {
    for (int y = 0; y < image.height; ++y) {
      std::int16_t* const row = image.row(plane, y);
      std::fill_n(row - image.margin_x, image.margin_x, row[0]);
      std::fill_n(row + image.width, image.margin_x, row[image.width - 1]);
    }
    for (int y = 1; y <= image.margin_y; ++y) {
      const auto copy = [&](int from, int to) {
        std::copy_n(image.row(plane, from) - image.margin_x, image.stride(),
                    image.row(plane, to) - image.margin_x);
      };
      copy(0, -y);
      copy(image.height - 1, image.height - 1 + y);
    }
  }
}

void grey(const GreyLevels& image, FilteredImage& to) {
  constexpr float middle = 127.5f;
  for (int y = 0; y < to.height; ++y) {
    for (int x = 0; x < to.width; ++x) to.row(0, y)[x] = whole(2 * (image(x, y) - middle));
  }
}

void derivative(const GreyLevels& image, double scale_px, FilteredImage& to) {
  const int reach = static_cast<int>(std::ceil(3 * scale_px));
  std::vector<float> weights;
  float sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(static_cast<float>(std::exp(-0.5 * i * i / (scale_px * scale_px))));
    sum += weights.back();
  }
  const PaddedImage padded(image, reach + 1);
  for (int y = 0; y < to.height; ++y) {
    const float* const row = padded.row(y);
    for (int x = 0; x < to.width; ++x) {
      float smooth = 0;
      for (int i = -reach; i <= reach; ++i) {
        smooth += weights[static_cast<std::size_t>(i + reach)] * (row[x + i + 1] - row[x + i - 1]);
      }
      to.row(0, y)[x] = whole(smooth / sum);
    }
  }
}

constexpr float grey_steps = 64;

/// Grey levels in sixty-fourths.
FilteredImage fine(const GreyLevels& image, int margin_x, int margin_y) {
  FilteredImage result{image.width_px, image.height_px, 1, margin_x, margin_y, {}};
  result.values.resize(result.stride() * static_cast<std::size_t>(image.height_px + 2 * margin_y));
  for (int y = 0; y < image.height_px; ++y) {
    const float* const from =
        image.values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(result.width);
    std::int16_t* const to = result.row(0, y);
    for (int x = 0; x < result.width; ++x) {
      const float level = std::min(std::max(grey_steps * from[x], -32000.0f), 32000.0f);
      to[x] = static_cast<std::int16_t>(static_cast<int>(level));
    }
  }
  repeat_borders(result);
  return result;
}

void rank(const GreyLevels& image, int reach, double min_grey, FilteredImage& to) {
  const auto least = static_cast<std::int16_t>(std::lround(grey_steps * min_grey));
  const FilteredImage levels = fine(image, reach + vector_pixels, reach);
  std::vector<const std::int16_t*> rows(static_cast<std::size_t>(2 * reach + 1));
  std::vector<std::int16_t> row(static_cast<std::size_t>(to.width + vector_pixels));
  for (int y = 0; y < to.height; ++y) {
    for (int j = -reach; j <= reach; ++j) {
      rows[static_cast<std::size_t>(j + reach)] = levels.row(0, y + j) - reach;
    }
    HWY_DYNAMIC_DISPATCH(ranks)(rows.data(), reach, least, to.width, row.data());
    std::copy_n(row.data(), to.width, to.row(0, y));
  }
}

constexpr int census_planes = 8;

void census(const GreyLevels& image, FilteredImage& to) {
  constexpr int away = 2;
  const PaddedImage padded(image, away);
  int plane = 0;
  for (int j = -away; j <= away; j += away) {
    for (int i = -away; i <= away; i += away) {
      if (i == 0 && j == 0) continue;
      for (int y = 0; y < to.height; ++y) {
        const float *const row = padded.row(y), *const there = padded.row(y + j) + i;
        for (int x = 0; x < to.width; ++x) {
          to.row(plane, y)[x] = there[x] > row[x] ? 1 : -1;
        }
      }
      ++plane;
    }
  }
}

}  // namespace

FilteredImage filtered(const GreyLevels& image,
                       const StretchOptions& options,
                       int margin_x,
                       int margin_y) {
  FilteredImage result{image.width_px, image.height_px, 1, margin_x, margin_y, {}};
  if (options.filter == StretchFilter::census) result.planes = census_planes;
  result.values.resize(result.stride() * static_cast<std::size_t>(result.planes) *
                       static_cast<std::size_t>(result.height + 2 * margin_y));
  switch (options.filter) {
    case StretchFilter::grey:
      grey(image, result);
      break;
    case StretchFilter::derivative:
      derivative(image, options.scale_px, result);
      break;
    case StretchFilter::rank:
      rank(image, options.rank_reach_px, options.rank_least_grey, result);
      break;
    case StretchFilter::census:
      census(image, result);
      break;
  }
  repeat_borders(result);
  return result;
}

}  // namespace vernier::stereo::internal
#endif  // HWY_ONCE
