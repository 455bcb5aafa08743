// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/stretch_correlation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "calib/error.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matching/matcher_input.h"
#include "stereo/matching/right_edges.h"
#include "stereo/matching/stretch_search.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

void require(bool good, const char* fault, const char* remedy) {
  if (!good) throw Error("stretch options", fault, remedy);
}

void check_options(const StretchOptions& o) {
  const auto odd = [](int n, int least, int most) { return n % 2 == 1 && n >= least && n <= most; };
  require(odd(o.width_px, 3, 63) && odd(o.height_px, 1, 63) && o.width_px * o.height_px <= 2000,
          "the block size is not odd or not from 3 x 1 to 2000 pixels", "use e.g. 17 x 9");
  require(o.step_x_px > 0 && o.step_y_px > 0, "the block spacing is not positive",
          "use at least 1 px");
  require(odd(o.stretches, 1, 99) && odd(o.shears, 1, 99),
          "the number of stretches or shears is not odd", "use odd numbers below 100");
  require(o.max_gradient > 0 && o.max_gradient <= 1.5,
          "the disparity gradient limit is not above 0 and at most 1.5", "use e.g. 1");
  require(std::abs(o.max_shear) <= 2, "the maximum shear is above 2", "use e.g. 0.5");
  require(o.scale_px > 0 && o.scale_px <= 10,
          "the derivative scale is not above 0 and at most 10 px", "use e.g. 1 px");
  require(o.rank_reach_px >= 1 && o.rank_reach_px <= 7,
          "the rank window reach is not from 1 to 7 px", "use e.g. 4");
  require(o.rank_least_grey >= 0 && o.rank_least_grey <= 255,
          "the minimum difference for ranks is not from 0 to 255 grey levels", "use e.g. 4");
  require(o.halvings >= 0 && o.halvings <= 6, "halvings is not from 0 to 6", "use 1 or 2");
  require(o.edge_reach_px >= 0 && o.max_contrast_ratio >= 1 && o.margin_px >= 0,
          "a reach or margin is negative or the contrast ratio is below 1", "use larger values");
}

bool agrees(const StretchBlock& a, const StretchBlock& b, double gradient) {
  const float apart = a.disparity_px - b.disparity_px;
  const float across = static_cast<float>(a.x - b.x) - 0.5f * apart;
  return std::abs(apart) <=
         static_cast<float>(gradient) * std::hypot(across, static_cast<float>(a.y - b.y));
}

/// Calls visit(block) for the blocks of a grid at a position and around it.
template <class Blocks, class Visit>
void for_each_about(Blocks& grid, int column, int row, const Visit& visit) {
  for (int y = std::max(0, row - 1); y <= std::min(grid.rows - 1, row + 1); ++y) {
    for (int x = std::max(0, column - 1); x <= std::min(grid.columns - 1, column + 1); ++x) {
      visit(grid.blocks[static_cast<std::size_t>(y * grid.columns + x)]);
    }
  }
}

/// Sets the status of every block.
void decide(const StretchOptions& options, StretchBlocks& grid) {
  const auto good = [&](const StretchBlock& block) {
    return block.searched > 0 && block.score >= static_cast<float>(options.min_score);
  };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      StretchBlock& block = grid.blocks[static_cast<std::size_t>(row * grid.columns + column)];
      if (block.edges < options.min_edges) continue;
      block.fate = BlockStatus::weak;
      if (!good(block)) continue;
      for_each_about(grid, column, row, [&](const StretchBlock& other) {
        if (&other == &block || !good(other)) return;
        block.support += agrees(block, other, options.max_gradient) ? 1 : 0;
      });
      const bool supported = block.support >= options.min_support;
      block.fate = supported ? BlockStatus::kept : BlockStatus::lonely;
    }
  }
}

/// Search ranges from the kept blocks of `from` around every block, with pixels `scale` wide; the
/// full range if there are none.
std::vector<BlockRange> ranges_about(const StretchBlocks& from,
                                     int scale,
                                     const StretchBlocks& grid,
                                     const DisparityRange& range,
                                     const StretchOptions& options) {
  std::vector<BlockRange> ranges;
  for (const StretchBlock& block : grid.blocks) {
    constexpr float infinite = std::numeric_limits<float>::infinity();
    float min_px = infinite, max_px = -infinite, least = infinite, most = -infinite;
    const auto at = [scale](int pixel, int step, int count) {
      return std::min(count - 1, pixel / scale / step);
    };
    const int column = at(block.x, options.step_x_px, from.columns);
    const int row = at(block.y, options.step_y_px, from.rows);
    for_each_about(from, column, row, [&](const StretchBlock& other) {
      if (other.fate != BlockStatus::kept) return;
      min_px = std::min(min_px, static_cast<float>(scale) * other.disparity_px);
      max_px = std::max(max_px, static_cast<float>(scale) * other.disparity_px);
      least = std::min(least, other.stretch);
      most = std::max(most, other.stretch);
    });
    BlockRange& of_block = ranges.emplace_back(BlockRange{range});
    if (min_px > max_px) continue;
    const int from_px = static_cast<int>(std::floor(min_px)) - options.margin_px;
    const int to_px = static_cast<int>(std::ceil(max_px)) + options.margin_px;
    of_block.disparities = {std::clamp(from_px, range.min_px, range.max_px),
                            std::clamp(to_px, range.min_px, range.max_px)};
    of_block.min_stretch = least;
    of_block.max_stretch = most;
  }
  return ranges;
}

/// Blocks of the images at half size, unless they are too small.
StretchBlocks coarser_blocks(const RectifiedPair& pair,
                             const std::vector<EdgePoint>& left_edges,
                             const DisparityRange& range,
                             StretchOptions options) {
  const RectifiedPair half{half_size(pair.left), half_size(pair.right)};
  if (half.left.width_px < 3 * options.width_px || half.left.height_px < 3 * options.height_px) {
    return {};
  }
  --options.halvings;
  std::vector<EdgePoint> edges;
  for (EdgePoint edge : left_edges) {
    edge.x = std::min(edge.x / 2, half.left.width_px - 1);
    edge.y = std::min(edge.y / 2, half.left.height_px - 1);
    edges.push_back(edge);
  }
  const DisparityRange half_range{std::max(-half.left.width_px + 1, (range.min_px - 1) / 2),
                                  std::min(half.left.width_px - 1, (range.max_px + 1) / 2)};
  return stretch_blocks(half, edges, half_range, options);
}

/// Ranges from the last frame, and the full range for some blocks.
std::vector<BlockRange> ranges_after(const StretchBlocks& last,
                                     std::uint32_t frame,
                                     const StretchBlocks& grid,
                                     const DisparityRange& range,
                                     const StretchOptions& options) {
  if (last.columns != grid.columns || last.rows != grid.rows) {
    throw Error("last frame", "its blocks come from another image size or other options",
                "start a new sequence when these change");
  }
  std::vector<BlockRange> ranges = ranges_about(last, 1, grid, range, options);
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    RandomStream draws({.seed = options.seed,
                        .feature = static_cast<std::uint32_t>(k),
                        .source = static_cast<std::uint32_t>(DrawSource::full_search),
                        .frame = frame});
    if (draws.uniform() < options.full_search_share) ranges[k] = {range};
  }
  return ranges;
}

/// For every pixel, the kept block with the best score that contains it, −1 if none.
class BestBlocks {
 public:
  BestBlocks(const StretchBlocks& grid, const StretchOptions& options, int width, int height)
      : width_(static_cast<std::size_t>(width)),
        best_(width_ * static_cast<std::size_t>(height), -1),
        score_(best_.size(), -1) {
    const int half_x = options.width_px / 2, half_y = options.height_px / 2;
    for (std::size_t k = 0; k < grid.blocks.size(); ++k) {
      const StretchBlock& block = grid.blocks[k];
      if (block.fate != BlockStatus::kept) continue;
      const int first = std::max(0, block.x - half_x), end = std::min(width, block.x + half_x + 1);
      for (int y = std::max(0, block.y - half_y); y < std::min(height, block.y + half_y + 1); ++y) {
        paint(static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(first), end - first,
              static_cast<int>(k), block.score);
      }
    }
  }

  int at(int x, int y) const {
    return best_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)];
  }

 private:
  void paint(std::size_t first, int n, int block, float score) {
    int* const best = best_.data() + first;
    float* const scores = score_.data() + first;
    for (int x = 0; x < n; ++x) {
      const bool better = score > scores[x];
      best[x] = better ? block : best[x];
      scores[x] = better ? score : scores[x];
    }
  }

  std::size_t width_;
  std::vector<int> best_;
  std::vector<float> score_;
};

}  // namespace

StretchBlocks stretch_blocks(const RectifiedPair& pair,
                             const std::vector<EdgePoint>& left_edges,
                             const DisparityRange& range,
                             const StretchOptions& options,
                             const StretchBlocks* last,
                             std::uint32_t frame) {
  check_matcher_input(pair, range, "stretch");
  check_options(options);
  StretchBlocks grid = block_grid(pair.left.width_px, pair.left.height_px, left_edges, options);
  std::vector<BlockRange> ranges;
  if (last) {
    ranges = ranges_after(*last, frame, grid, range, options);
  } else if (options.halvings > 0) {
    const StretchBlocks coarser = coarser_blocks(pair, left_edges, range, options);
    if (!coarser.blocks.empty()) ranges = ranges_about(coarser, 2, grid, range, options);
  }
  if (ranges.empty()) ranges.assign(grid.blocks.size(), BlockRange{range});
  search_blocks(pair, ranges, options, grid);
  decide(options, grid);
  return grid;
}

StretchFrame match_by_stretch(const RectifiedPair& pair,
                              const std::vector<EdgePoint>& left_edges,
                              const DisparityRange& range,
                              const StretchOptions& options,
                              const StretchFrame* last) {
  StretchFrame frame;
  if (last) frame.number = last->number + 1;
  frame.blocks = stretch_blocks(pair, left_edges, range, options, last ? &last->blocks : nullptr,
                                frame.number);
  const RightEdges right(pair.right, options);
  const BestBlocks best_blocks(frame.blocks, options, pair.left.width_px, pair.left.height_px);
  const auto min_sine = static_cast<float>(std::sin(options.min_angle_rad));
  for (const EdgePoint& edge : left_edges) {
    EdgeDisparity& at = frame.at_edges.emplace_back();
    if (std::abs(edge.normal.x()) < min_sine) continue;
    const int best = best_blocks.at(edge.x, edge.y);
    if (best < 0) continue;
    const StretchBlock* const block = &frame.blocks.blocks[static_cast<std::size_t>(best)];
    const float across = edge.row_x_px - static_cast<float>(block->x);
    const float down = static_cast<float>(edge.y - block->y);
    const float disparity =
        block->disparity_px + (1 - block->stretch) * across - block->shear * down;
    at.disparity_px = edge.row_x_px - right.nearest_px(edge, edge.row_x_px - disparity);
    if (at.matched()) at.confidence = block->score;
  }
  return frame;
}

Matcher stretch_matcher(const StretchOptions& options) {
  return {"stretch",
          [options](const RectifiedPair& pair, const std::vector<EdgePoint>& left_edges,
                    const DisparityRange& range) {
            return match_by_stretch(pair, left_edges, range, options).at_edges;
          },
          true};
}

}  // namespace vernier::stereo::internal
