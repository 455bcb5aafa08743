// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "calib/pose.h"
#include "sim/sequence/lost_again.h"
#include "sim/sequence/sequence_samples.h"
#include "sim/sources/measured_sources.h"

namespace vernier::sim::internal {

/// Figures of a sequence, all of it or a part by range or angle. NaN with fewer than 30 samples.
/// Shares are corrected for what happens by chance: with c what is found on expected lines, and c₀
/// what is on lines displaced by 8 and 12 px, a loss is (1 − c) / (1 − c₀).
struct SequenceFigures {
  MeasuredValue loss;           ///< of the expected length
  MeasuredValue lost_whole;     ///< of the expected lines
  MeasuredValue loss_of_found;  ///< of the length of lines that are found; not corrected
  MeasuredValue pieces;         ///< segments on a line that is found
  /// Of an end across its line, of segments that the join gives to it: from the difference of both
  /// ends, without the turn of the view: E[(e_b − e_a)²] − line = 2 σ² + φ² l².
  MeasuredValue end_across_px;
  MeasuredValue end_along_px;  ///< from two views of the same end: robust, of those within 10 px
  MeasuredValue cut_short;     ///< share of ends that two views have farther apart
  /// False edges, as a share f of the segments: of those that k views should show, with ℓ the share
  /// of lines of that length lost whole, f + (1 − f) ℓᵏ are shown by none, but for chance.
  MeasuredValue not_confirmed;
  /// Segments on no line that enough other views saw: false edges, and lines that few views show.
  MeasuredValue beside_lines;
  MeasuredValue mismatch;  ///< segments on lines whose depth is off, as a share
};

/// The part of the samples in [from, to): metres, radians or pixels.
struct SequenceBand {
  double from = 0, to = 0;
  SequenceFigures figures;
};

struct MeasuredSequence {
  int views = 0, lines = 0;
  int clusters = 0;    ///< of the intervals: blocks of the way
  double block_m = 0;  ///< their length; 0: of as many views each
  bool with_depth = false;
  SequenceFigures all;
  double turn_rad = 0;  ///< φ above: error of a view's turn about its optical axis, and the like
  std::vector<SequenceBand> by_range, by_angle, by_length;
  std::vector<LostAgain> lost_again;  ///< by the distance between two views
  LossesAlike alike;
  double depths_agree = 1;  ///< share of the segments along which their view's depth map agrees
};

/// The block of the way that each view belongs to: `block_m` of it each; equal numbers of views, of
/// 8 blocks at most, where that makes fewer than six. `block_m` is set to 0 then.
std::vector<int> blocks_of_way(std::span<const SequenceView> views, double& block_m);

/// Values with 95 % intervals by a bootstrap over blocks of the way: what neighbouring views show
/// is alike.
MeasuredSequence measure_sequence(const SequenceSamples& samples,
                                  std::span<const SequenceView> views,
                                  double block_m = 2,
                                  const MeasuringOptions& options = {});

}  // namespace vernier::sim::internal
