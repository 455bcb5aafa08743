// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "calib/rig.h"
#include "sim/sources.h"
#include "sim/uncertainty_source.h"

/// The sources that ship, each in a file of its own name. Not installed.
namespace vernier::sim::internal {

using SourcePointer = std::unique_ptr<UncertaintySource>;

SourcePointer make_unseen_edges(const SourceSettings& settings);
SourcePointer make_missed_edges(const SourceSettings& settings);
/// No false edge is shorter than `min_length_px` in the left image.
SourcePointer make_clutter(const SourceSettings& settings, double min_length_px);
SourcePointer make_lateral_shift(const SourceSettings& settings);
SourcePointer make_line_merging(const SourceSettings& settings);
/// Drops pieces that are shorter than `min_length_px` in the left image.
SourcePointer make_edge_loss(const SourceSettings& settings, double min_length_px);
SourcePointer make_endpoint_error(const SourceSettings& settings);
SourcePointer make_epipolar_rejection(const SourceSettings& settings);
SourcePointer make_stereo_mismatch(const SourceSettings& settings);
SourcePointer make_corner_loss(const SourceSettings& settings);
SourcePointer make_corner_error(const SourceSettings& settings);
SourcePointer make_corner_mismatch(const SourceSettings& settings);
/// Throws Error for a name that is not registered.
SourcePointer make_own(const OwnSource& own);
SourcePointer make_program_source(const SourceSettings& settings, const Rig& rig);

}  // namespace vernier::sim::internal
