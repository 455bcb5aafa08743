// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/stretch_correlation.h"

namespace vernier::stereo::internal {

/// The grid of blocks over an image, with the number of edge points in each, excluding those too
/// close to horizontal.
StretchBlocks block_grid(int width_px,
                         int height_px,
                         const std::vector<EdgePoint>& left_edges,
                         const StretchOptions& options);

/// Search range of a block: disparities, and stretches from the one before `min_stretch` to the one
/// after `max_stretch`.
struct BlockRange {
  DisparityRange disparities;
  float min_stretch = 0, max_stretch = std::numeric_limits<float>::infinity();
};

/// Finds the best disparity, stretch and shear within its own range of every block with enough edge
/// points.
void search_blocks(const RectifiedPair& pair,
                   const std::vector<BlockRange>& ranges,
                   const StretchOptions& options,
                   StretchBlocks& blocks);

/// Stretches M / N searched, ascending, evenly spaced in their logarithm, with 1 in the middle.
std::vector<double> stretches_of(const StretchOptions& options);

/// Shears searched, ascending, with 0 in the middle.
std::vector<double> shears_of(const StretchOptions& options);

}  // namespace vernier::stereo::internal
