// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/stretch_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "calib/base/ordered_parallel.h"
#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/stretch_correlation.h"
#include "stereo/matching/stretch_filter.h"
#include "stereo/matching/stretch_kernel.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

constexpr int lanes = 32;  // row padding for vector reads and writes

/// Block sums around all right centres of a row of blocks; the sums of each pixel row are computed
/// once and reused.
class RightSums {
 public:
  RightSums(const PairedRows& right, const StretchWarp& warp, int planes, int width)
      : right_(right),
        warp_(warp),
        planes_(planes),
        width_(width),
        size_(static_cast<std::size_t>(width + lanes)),
        sums_(size_),
        inverse_(size_),
        row_sums_(static_cast<std::size_t>(warp.rows) * size_),
        row_squares_(row_sums_.size()),
        held_(static_cast<std::size_t>(warp.rows), none) {
    window_.sums.resize(held_.size());
    window_.squares.resize(held_.size());
  }

  /// For blocks whose middle row is y.
  void compute(int y) {
    if (y == y_) return;
    y_ = y;
    for (int j = 0; j < warp_.rows; ++j) hold(y + j - warp_.rows / 2, j);
    const auto count = static_cast<float>(warp_.rows * warp_.width * planes_);
    window_sums(window_, width_, count, sums_.data(), inverse_.data());
  }

  const float* sums() const { return sums_.data(); }
  const float* inverse() const { return inverse_.data(); }

 private:
  /// Row y of the image as row j of the block: with a shear it depends on j.
  void hold(int y, int j) {
    const auto slot = static_cast<std::size_t>((y + warp_.rows) % warp_.rows);
    float *const sums = row_sums_.data() + slot * size_, *const squares =
                                                             row_squares_.data() + slot * size_;
    window_.sums[static_cast<std::size_t>(j)] = sums;
    window_.squares[static_cast<std::size_t>(j)] = squares;
    if (held_[slot] == y && warp_.shear == 0) return;
    held_[slot] = y;
    std::fill_n(sums, size_, 0.0f);
    std::fill_n(squares, size_, 0.0f);
    for (int plane = 0; plane < planes_; ++plane) {
      add_row_sums(right_.row(plane, y), warp_, j, width_, sums, squares);
    }
  }

  static constexpr int none = -1000000;
  const PairedRows& right_;
  const StretchWarp& warp_;
  int planes_, width_, y_ = none;
  std::size_t size_;
  std::vector<float> sums_, inverse_, row_sums_, row_squares_;
  std::vector<int> held_;
  WindowRows window_;
};

/// The left image rows of a row of blocks, transposed: pixels by column and row.
class LeftStrip {
 public:
  LeftStrip(const FilteredImage& image, int width, int rows)
      : image_(image),
        width_(width),
        rows_(rows),
        stride_(static_cast<std::size_t>(StretchWarp::row_stride(rows))),
        values_(image.stride() * static_cast<std::size_t>(image.planes) * stride_),
        sums_(image.stride()),
        squares_(image.stride()) {}

  /// For blocks whose middle row is y.
  void take(int y) {
    std::fill(sums_.begin(), sums_.end(), 0);
    std::fill(squares_.begin(), squares_.end(), 0);
    for (int plane = 0; plane < image_.planes; ++plane) {
      for (int j = 0; j < rows_; ++j) {
        const std::int16_t* const row = image_.row(plane, y + j - rows_ / 2) - image_.margin_x;
        std::int16_t* const to = column(plane, 0) + j;
        for (std::size_t x = 0; x < sums_.size(); ++x) {
          to[x * stride_] = row[x];
          sums_[x] += row[x];
          squares_[x] += row[x] * row[x];
        }
      }
    }
  }

  /// Pixels of the block around column x, its mean and the root of its centred sum of squares.
  const std::int16_t* block(int plane, int x) const {
    return values_.data() +
           (static_cast<std::size_t>(plane) * image_.stride() + first(x)) * stride_;
  }
  void statistics(int x, float& mean, float& deviation) const {
    std::int64_t sum = 0, squares = 0;
    for (std::size_t k = first(x); k < first(x) + static_cast<std::size_t>(width_); ++k) {
      sum += sums_[k];
      squares += squares_[k];
    }
    const double count = image_.planes * width_ * rows_, total = static_cast<double>(sum);
    mean = static_cast<float>(total / count);
    deviation = static_cast<float>(std::sqrt(static_cast<double>(squares) - total * total / count));
  }

 private:
  std::size_t first(int x) const {
    return static_cast<std::size_t>(x + image_.margin_x - width_ / 2);
  }
  std::int16_t* column(int plane, std::size_t x) {
    return values_.data() + (static_cast<std::size_t>(plane) * image_.stride() + x) * stride_;
  }

  const FilteredImage& image_;
  int width_, rows_;
  std::size_t stride_;
  std::vector<std::int16_t> values_;
  std::vector<int> sums_, squares_;
};

/// Vertex of the parabola through three values at −1, 0 and 1, clamped to ± one half.
float vertex(float before, float at, float after) {
  const float bend = before - 2 * at + after;
  return bend < 0 ? std::clamp(0.5f * (before - after) / bend, -0.5f, 0.5f) : 0;
}

/// Maximum distance in pixels of a sample from its block's right centre, plus vector padding.
int right_margin(const StretchOptions& options) {
  const int half_width_px = options.width_px / 2, half_height_px = options.height_px / 2;
  const double most = stretches_of(options).back() * half_width_px +
                      std::abs(shears_of(options).back()) * half_height_px;
  return static_cast<int>(std::ceil(most)) + 2 + lanes;
}

std::vector<StretchWarp> warps_of(const StretchOptions& options, std::size_t row_pairs) {
  std::vector<StretchWarp> warps;
  for (const double shear : shears_of(options)) {
    for (const double stretch : stretches_of(options)) {
      warps.emplace_back(stretch, shear, options.width_px, options.height_px,
                         static_cast<int>(row_pairs));
    }
  }
  return warps;
}

/// Data common to all blocks of a pair.
class StretchSearch {
 public:
  StretchSearch(const RectifiedPair& pair, const StretchOptions& options)
      : options_(options),
        width_(pair.left.width_px),
        stretches_(stretches_of(options)),
        left_(filtered(pair.left, options, options.width_px / 2, options.height_px / 2)),
        right_(filtered(pair.right, options, right_margin(options), options.height_px / 2)),
        paired_(right_),
        warps_(warps_of(options, paired_.row_pairs())) {}

  /// Rows [first, end) of the blocks.
  void search(StretchBlocks& blocks,
              const std::vector<BlockRange>& ranges,
              int first,
              int end) const {
    Buffers buffers{LeftStrip(left_, options_.width_px, options_.height_px), {}, {}, {}};
    for (const StretchWarp& warp : warps_) {
      buffers.sums.emplace_back(paired_, warp, right_.planes, width_);
    }
    for (int row = first; row < end; ++row) {
      const auto begin = static_cast<std::size_t>(row * blocks.columns);
      bool known = false;
      for (std::size_t k = begin; k < begin + static_cast<std::size_t>(blocks.columns); ++k) {
        if (blocks.blocks[k].edges < options_.min_edges) continue;
        if (!known) buffers.left.take(blocks.blocks[k].y);
        known = true;
        search(blocks.blocks[k], ranges[k], buffers);
      }
    }
  }

 private:
  struct Buffers {
    LeftStrip left;
    std::vector<RightSums> sums;  // by warp
    std::vector<std::int32_t> weights;
    std::vector<float> scores;  // by warp, then by right centre

    float* row(std::size_t warp, int n) {
      return scores.data() + warp * static_cast<std::size_t>(n + lanes);
    }
  };

  struct Best {
    std::size_t warp;
    float score;
  };

  void search(StretchBlock& block, const BlockRange& range, Buffers& buffers) const {
    const int first = std::max(0, block.x - range.disparities.max_px);
    const int n = std::min(width_ - 1, block.x - range.disparities.min_px) - first + 1;
    block.searched = std::max(0, n);
    float mean = 0, deviation = 0;
    buffers.left.statistics(block.x, mean, deviation);
    if (n <= 0 || !(deviation > 0)) return;
    buffers.scores.resize(warps_.size() * static_cast<std::size_t>(n + lanes));
    Best best{0, -1e30f};
    for (std::size_t w = 0; w < warps_.size(); ++w) {
      if (!is_searched(w % stretches_.size(), range)) continue;
      const float most = score(block, w, mean, first, n, buffers.row(w, n), buffers);
      if (most > best.score) best = {w, most};
    }
    // The largest disparity if tied.
    const float* const row = buffers.row(best.warp, n);
    const auto k = static_cast<int>(std::find(row, row + n, best.score) - row);
    settle(block, first, n, k, best.warp, mean, range, buffers);
    block.score = best.score / deviation;
  }

  /// Scores of a warp at n right centres; returns the largest.
  float score(const StretchBlock& block,
              std::size_t w,
              float mean,
              int first,
              int n,
              float* scores,
              Buffers& buffers) const {
    weigh(warps_[w], block.x, buffers);
    RightSums& sums = buffers.sums[w];
    sums.compute(block.y);
    return block_scores({warps_[w], paired_, right_.planes, block.y - options_.height_px / 2,
                         buffers.weights.data(), mean, first, n, sums.sums(), sums.inverse()},
                        scores);
  }

  bool is_searched(std::size_t stretch, const BlockRange& range) const {
    const std::size_t last = stretches_.size() - 1;
    return stretches_[std::min(stretch + 1, last)] >= range.min_stretch &&
           stretches_[stretch == 0 ? 0 : stretch - 1] <= range.max_stretch;
  }

  void weigh(const StretchWarp& warp, int x, Buffers& buffers) const {
    const std::size_t count = static_cast<std::size_t>(warp.pairs) *
                              static_cast<std::size_t>(StretchWarp::row_stride(warp.rows));
    buffers.weights.resize(
        std::max(buffers.weights.size(), count * static_cast<std::size_t>(right_.planes)));
    for (int plane = 0; plane < right_.planes; ++plane) {
      block_weights(warp, buffers.left.block(plane, x),
                    buffers.weights.data() + static_cast<std::size_t>(plane) * count);
    }
  }

  /// Interpolates between positions and between stretches at the best position k of the best warp.
  void settle(StretchBlock& block,
              int first,
              int n,
              int k,
              std::size_t best,
              float mean,
              const BlockRange& range,
              Buffers& buffers) const {
    const float* const at = buffers.row(best, n) + k;
    block.stretch = static_cast<float>(warps_[best].stretch);
    block.shear = static_cast<float>(warps_[best].shear);
    block.disparity_px = static_cast<float>(block.x - first - k);
    if (k > 0 && k + 1 < n) block.disparity_px -= vertex(at[-1], at[0], at[1]);
    const std::size_t along = best % stretches_.size();
    if (along == 0 || along + 1 == stretches_.size()) return;
    const auto beside = [&](std::size_t w) {
      float* const there = buffers.row(w, n) + k;
      if (!is_searched(w % stretches_.size(), range)) {
        score(block, w, mean, first + k, 1, there, buffers);
      }
      return *there;
    };
    const double off = vertex(beside(best - 1), *at, beside(best + 1));
    block.stretch *= static_cast<float>(std::pow(stretches_[1] / stretches_[0], off));
  }

  const StretchOptions& options_;
  int width_;
  std::vector<double> stretches_;
  FilteredImage left_, right_;
  PairedRows paired_;
  std::vector<StretchWarp> warps_;
};

}  // namespace

std::vector<double> stretches_of(const StretchOptions& options) {
  const double most = (2 + options.max_gradient) / (2 - options.max_gradient);
  std::vector<double> stretches;
  const int half = options.stretches / 2;
  for (int k = -half; k <= half; ++k) {
    stretches.push_back(k == 0 ? 1 : std::pow(most, static_cast<double>(k) / half));
  }
  return stretches;
}

std::vector<double> shears_of(const StretchOptions& options) {
  std::vector<double> shears;
  const int half = options.shears / 2;
  for (int k = -half; k <= half; ++k) {
    shears.push_back(k == 0 ? 0 : options.max_shear * k / half);
  }
  return shears;
}

StretchBlocks block_grid(int width_px,
                         int height_px,
                         const std::vector<EdgePoint>& left_edges,
                         const StretchOptions& options) {
  StretchBlocks grid;
  grid.columns = (width_px + options.step_x_px - 1) / options.step_x_px;
  grid.rows = (height_px + options.step_y_px - 1) / options.step_y_px;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      StretchBlock block;
      block.x = std::min(width_px - 1, column * options.step_x_px + options.step_x_px / 2);
      block.y = std::min(height_px - 1, row * options.step_y_px + options.step_y_px / 2);
      grid.blocks.push_back(block);
    }
  }
  // Integral image: points above and to the left of a pixel.
  const auto stride = static_cast<std::size_t>(width_px + 1);
  std::vector<int> before(stride * static_cast<std::size_t>(height_px + 1));
  const auto min_sine = static_cast<float>(std::sin(options.min_angle_rad));
  for (const EdgePoint& edge : left_edges) {
    if (std::abs(edge.normal.x()) < min_sine) continue;
    before[static_cast<std::size_t>(edge.y + 1) * stride + static_cast<std::size_t>(edge.x + 1)]++;
  }
  for (std::size_t y = 1; y <= static_cast<std::size_t>(height_px); ++y) {
    int in_row = 0;
    for (std::size_t x = 1; x < stride; ++x) {
      in_row += before[y * stride + x];
      before[y * stride + x] = before[(y - 1) * stride + x] + in_row;
    }
  }
  for (StretchBlock& block : grid.blocks) {
    const auto column = [&](int x) { return static_cast<std::size_t>(std::clamp(x, 0, width_px)); };
    const auto row = [&](int y) {
      return static_cast<std::size_t>(std::clamp(y, 0, height_px)) * stride;
    };
    const std::size_t left = column(block.x - options.width_px / 2);
    const std::size_t right = column(block.x + options.width_px / 2 + 1);
    const std::size_t top = row(block.y - options.height_px / 2);
    const std::size_t bottom = row(block.y + options.height_px / 2 + 1);
    block.edges =
        before[bottom + right] - before[bottom + left] - before[top + right] + before[top + left];
  }
  return grid;
}

void search_blocks(const RectifiedPair& pair,
                   const std::vector<BlockRange>& ranges,
                   const StretchOptions& options,
                   StretchBlocks& blocks) {
  const StretchSearch search(pair, options);
  constexpr int rows_at_once = 24;
  const int bands = (blocks.rows + rows_at_once - 1) / rows_at_once;
  for_each_index(static_cast<std::size_t>(bands), options.threads, [&](std::size_t band) {
    const int first = static_cast<int>(band) * rows_at_once;
    search.search(blocks, ranges, first, std::min(first + rows_at_once, blocks.rows));
  });
}

}  // namespace vernier::stereo::internal
