// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/stretch_search.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "calib/ordered_parallel.h"
#include "stereo/stretch_kernel.h"

namespace vernier {
namespace {

constexpr int lanes = 32;  // and more of every row that vectors may read or write

/// Sums over blocks about all right centres of a row of blocks, those of a row of pixels found once
/// while they are of use.
class RightSums {
 public:
  RightSums(const PairedRows& right, const StretchWarp& warp, int planes, int width)
      : right_(right), warp_(warp), planes_(planes), width_(width) {
    const auto size = static_cast<std::size_t>(width + lanes);
    sums_.resize(size);
    inverse_.resize(size);
    kept_ = warp.shear == 0 ? warp.rows : 1;
    row_sums_.resize(static_cast<std::size_t>(kept_) * size);
    row_squares_.resize(row_sums_.size());
    row_.assign(static_cast<std::size_t>(kept_), none);
  }

  /// For blocks whose middle row is y.
  void compute(int y) {
    std::fill(sums_.begin(), sums_.end(), 0.0f);
    std::fill(inverse_.begin(), inverse_.end(), 0.0f);
    for (int j = 0; j < warp_.rows; ++j) add_row(y + j - warp_.rows / 2, j);
    // Below a grey level's hundredth of variance there is nothing to compare.
    constexpr float least_variance = 0.01f * StretchWarp::steps * StretchWarp::steps;
    const auto count = static_cast<float>(warp_.rows * warp_.width * planes_);
    for (std::size_t x = 0; x < sums_.size(); ++x) {
      const float squares = inverse_[x] - sums_[x] * sums_[x] / count;
      inverse_[x] = 1 / std::sqrt(std::max(squares, count * least_variance));
    }
  }

  const float* sums() const { return sums_.data(); }
  const float* inverse() const { return inverse_.data(); }

 private:
  void add_row(int y, int j) {
    const auto size = sums_.size();
    const auto slot = static_cast<std::size_t>((y + warp_.rows) % kept_);
    float *const sums = row_sums_.data() + slot * size, *const squares =
                                                            row_squares_.data() + slot * size;
    if (row_[slot] != y || kept_ == 1) {
      row_[slot] = y;
      std::fill_n(sums, size, 0.0f);
      std::fill_n(squares, size, 0.0f);
      for (int plane = 0; plane < planes_; ++plane) {
        add_row_sums(right_.row(plane, y), warp_, j, width_, sums, squares);
      }
    }
    for (std::size_t x = 0; x < size; ++x) sums_[x] += sums[x];
    for (std::size_t x = 0; x < size; ++x) inverse_[x] += squares[x];
  }

  static constexpr int none = -1000000;
  const PairedRows& right_;
  const StretchWarp& warp_;
  int planes_, width_, kept_ = 1;
  std::vector<float> sums_, inverse_, row_sums_, row_squares_;
  std::vector<int> row_;
};

/// A left block's pixels by column and row, and what correlation needs of them.
struct LeftBlock {
  std::vector<std::int16_t> values;  // of all planes
  float mean = 0, deviation = 0;     // the latter of the sum of squares

  void take(const FilteredImage& image, const StretchBlock& block, int width, int rows) {
    const int stride = StretchWarp::row_stride(rows);
    values.assign(static_cast<std::size_t>(image.planes * width * stride), 0);
    std::int64_t sum = 0, squares = 0;
    std::int16_t* to = values.data();
    for (int plane = 0; plane < image.planes; ++plane, to += width * stride) {
      for (int j = 0; j < rows; ++j) {
        const std::int16_t* const from =
            image.row(plane, block.y + j - rows / 2) + block.x - width / 2;
        for (int i = 0; i < width; ++i) {
          to[i * stride + j] = from[i];
          sum += from[i];
          squares += from[i] * from[i];
        }
      }
    }
    const double count = image.planes * width * rows;
    mean = static_cast<float>(static_cast<double>(sum) / count);
    deviation =
        static_cast<float>(std::sqrt(static_cast<double>(squares) -
                                     static_cast<double>(sum) * static_cast<double>(sum) / count));
  }
};

/// How far the vertex of the parabola through three values at −1, 0 and 1 is from 0, at most half.
float vertex(float before, float at, float after) {
  const float bend = before - 2 * at + after;
  return bend < 0 ? std::clamp(0.5f * (before - after) / bend, -0.5f, 0.5f) : 0;
}

std::vector<StretchWarp> warps_of(const StretchOptions& options) {
  std::vector<StretchWarp> warps;
  for (const double shear : shears_of(options)) {
    for (const double stretch : stretches_of(options)) {
      warps.emplace_back(stretch, shear, options.width_px, options.height_px);
    }
  }
  return warps;
}

int most_reach(const std::vector<StretchWarp>& warps) {
  int most = 0;
  for (const StretchWarp& warp : warps) most = std::max(most, warp.most_reach());
  return most;
}

/// What all blocks of a pair share.
class Search {
 public:
  Search(const RectifiedPair& pair, const StretchOptions& options)
      : options_(options),
        width_(pair.left.width_px),
        stretches_(stretches_of(options)),
        warps_(warps_of(options)),
        left_(filtered(pair.left, options, options.width_px / 2, options.height_px / 2)),
        right_(filtered(pair.right, options, most_reach(warps_) + lanes, options.height_px / 2)),
        paired_(right_) {}

  /// Rows [first, end) of the blocks.
  void search(StretchBlocks& blocks,
              const std::vector<DisparityRange>& ranges,
              int first,
              int end) const {
    std::vector<RightSums> sums;
    for (const StretchWarp& warp : warps_) sums.emplace_back(paired_, warp, right_.planes, width_);
    Buffers buffers;
    for (int row = first; row < end; ++row) {
      const auto begin = static_cast<std::size_t>(row * blocks.columns);
      const int y = blocks.blocks[begin].y;
      bool known = false;
      for (std::size_t k = begin; k < begin + static_cast<std::size_t>(blocks.columns); ++k) {
        if (blocks.blocks[k].edges < options_.least_edges) continue;
        if (!known) {
          for (RightSums& of_warp : sums) of_warp.compute(y);
        }
        known = true;
        search(blocks.blocks[k], ranges[k], sums, buffers);
      }
    }
  }

 private:
  struct Buffers {
    LeftBlock left;
    std::vector<std::int32_t> weights;
    std::vector<float> scores;  // by warp, then by right centre
    std::vector<const std::int16_t*> rows;
  };

  void search(StretchBlock& block,
              const DisparityRange& range,
              const std::vector<RightSums>& sums,
              Buffers& buffers) const {
    const int first = std::max(0, block.x - range.most_px);
    const int n = std::min(width_ - 1, block.x - range.least_px) - first + 1;
    block.searched = std::max(0, n);
    if (n <= 0) return;
    buffers.left.take(left_, block, options_.width_px, options_.height_px);
    if (!(buffers.left.deviation > 0)) return;
    buffers.rows.clear();
    for (int plane = 0; plane < right_.planes; ++plane) {
      for (int j = 0; j < options_.height_px; ++j) {
        buffers.rows.push_back(paired_.row(plane, block.y + j - options_.height_px / 2));
      }
    }
    const auto stride = static_cast<std::size_t>(n + lanes);
    buffers.scores.resize(warps_.size() * stride);
    std::size_t best = 0;
    float most = -1e30f;
    for (std::size_t w = 0; w < warps_.size(); ++w) {
      weigh(warps_[w], buffers);
      const float score =
          block_scores({warps_[w], right_.planes, buffers.rows.data(), buffers.weights.data(),
                        buffers.left.mean, first, n, sums[w].sums(), sums[w].inverse()},
                       buffers.scores.data() + w * stride);
      if (score <= most) continue;
      most = score;
      best = w;
    }
    settle(block, first, n, best, most, buffers);
  }

  void weigh(const StretchWarp& warp, Buffers& buffers) const {
    const std::size_t stride = static_cast<std::size_t>(StretchWarp::row_stride(warp.rows));
    const std::size_t count = static_cast<std::size_t>(warp.pairs) * stride;
    const std::size_t left = static_cast<std::size_t>(warp.width) * stride;
    buffers.weights.resize(count * static_cast<std::size_t>(right_.planes));
    for (std::size_t plane = 0; plane < static_cast<std::size_t>(right_.planes); ++plane) {
      block_weights(warp, buffers.left.values.data() + plane * left,
                    buffers.weights.data() + plane * count);
    }
  }

  /// The best place of the best warp, between the places and stretches that were tried.
  void settle(StretchBlock& block,
              int first,
              int n,
              std::size_t best,
              float most,
              const Buffers& buffers) const {
    const auto stride = static_cast<std::size_t>(n + lanes);
    const float* const at = buffers.scores.data() + best * stride;
    // Of equal ones the largest disparity is taken.
    const auto k = static_cast<int>(std::find(at, at + n, most) - at);
    block.score = most / buffers.left.deviation;
    block.stretch = static_cast<float>(warps_[best].stretch);
    block.shear = static_cast<float>(warps_[best].shear);
    block.disparity_px = static_cast<float>(block.x - first - k);
    if (k > 0 && k + 1 < n) block.disparity_px -= vertex(at[k - 1], at[k], at[k + 1]);
    const std::size_t along = best % stretches_.size();
    if (along == 0 || along + 1 == stretches_.size()) return;
    const float* const narrower = at - stride;
    const float* const wider = at + stride;
    const double off = vertex(narrower[k], at[k], wider[k]);
    block.stretch *= static_cast<float>(std::pow(stretches_[1] / stretches_[0], off));
  }

  const StretchOptions& options_;
  int width_;
  std::vector<double> stretches_;
  std::vector<StretchWarp> warps_;
  FilteredImage left_, right_;
  PairedRows paired_;
};

}  // namespace

std::vector<double> stretches_of(const StretchOptions& options) {
  const double most = (2 + options.most_gradient) / (2 - options.most_gradient);
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
    shears.push_back(k == 0 ? 0 : options.most_shear * k / half);
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
  // Points above and to the left of a pixel.
  const auto stride = static_cast<std::size_t>(width_px + 1);
  std::vector<int> before(stride * static_cast<std::size_t>(height_px + 1));
  const auto least_sine = static_cast<float>(std::sin(options.least_angle_rad));
  for (const EdgePoint& edge : left_edges) {
    if (std::abs(edge.normal.x()) < least_sine) continue;
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
                   const std::vector<DisparityRange>& ranges,
                   const StretchOptions& options,
                   StretchBlocks& blocks) {
  const Search search(pair, options);
  constexpr int rows_at_once = 24;
  const int bands = (blocks.rows + rows_at_once - 1) / rows_at_once;
  for_each_index(static_cast<std::size_t>(bands), options.threads, [&](std::size_t band) {
    const int first = static_cast<int>(band) * rows_at_once;
    search.search(blocks, ranges, first, std::min(first + rows_at_once, blocks.rows));
  });
}

}  // namespace vernier
