// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "localise/pgh.h"
#include "localise/place.h"
#include "stereo/segment.h"

namespace vernier::test {

/// Pairwise geometric histograms by brute force, from the definitions in localise/pgh.h alone: the
/// other line in 240 points, each displaced by 400 quantiles of its Gaussian error, and likewise
/// the angle; every result falls into one bin. Rows sum to 1. max_lines is not looked at.
localise::HistogramRows sampled_image(std::span<const stereo::ImageSegment> lines,
                                      const localise::PghOptions& options);
localise::HistogramRows sampled_ground(std::span<const localise::PlaceLine> lines,
                                       const localise::PghOptions& options);
localise::HistogramRows sampled_spatial(std::span<const localise::PlaceLine> lines,
                                        const localise::PghOptions& options);

}  // namespace vernier::test
