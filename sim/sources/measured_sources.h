// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "calib/interval.h"
#include "calib/statistics/bootstrap.h"
#include "stereo/evaluation/pair_samples.h"

namespace vernier::sim::internal {

/// A figure with its 95 % interval.
struct MeasuredValue {
  double value = std::numeric_limits<double>::quiet_NaN();
  Interval interval{std::numeric_limits<double>::quiet_NaN(),
                    std::numeric_limits<double>::quiet_NaN()};
  int samples = 0;

  bool known() const { return value == value; }
};

/// psi_e: shares of the length of segments.
struct MeasuredEdgeLoss {
  MeasuredValue share;     ///< on no segment of the right image, chance taken away; what is written
  MeasuredValue to_left;   ///< the same of right segments in the left image
  MeasuredValue on_edges;  ///< on no edge at all of the right image, chance not taken away
  double chance = 0;       ///< of a lost stretch to be covered by another edge's segment
  double whole = 0, none = 0;  ///< share of segments that are lost whole, and not at all
  double gaps = 0;             ///< mean number of gaps of the others
  double longest_gap = 0;      ///< share of all lost length that each segment's longest gap holds
};

/// psi_l, as far as two simultaneous views can tell: by what they differ.
struct MeasuredLateralShift {
  MeasuredValue independent_px;  ///< the setting under which the simulator's eyes differ as much
  MeasuredValue relative_px;     ///< root mean square of right less left
  MeasuredValue towards_px;      ///< mean of right less left, towards the brighter side
  double truth_px = 0;           ///< standard deviation of the truth's own error, along the row
  double beyond = 0;             ///< share of segments that differ by more than four deviations
};

/// psi_g, each image's.
struct MeasuredEndpoints {
  MeasuredValue across_px;  ///< across the line; what is written
  MeasuredValue along_px;   ///< along it
  double broken = 0;    ///< share of segments with an end more than 3 px off along them: left out
  double outliers = 0;  ///< share of the others beyond three deviations across
};

/// psi_cd and psi_cm.
struct MeasuredCorners {
  MeasuredValue loss;      ///< of pairs; chance taken away
  double chance = 0;       ///< of a lost corner to have another one in its place
  MeasuredValue mismatch;  ///< share of matches, the unseen ones in the middle of the disc added
  int wrong = 0;           ///< matches more than 1.5 px off
  MeasuredValue reach_px;  ///< radius of the disc with their median distance
};

/// Lines matched at some disparities.
struct MismatchByDisparity {
  double from_px = 0, to_px = 0;
  int lines = 0, wrong = 0;
  MeasuredValue share;  ///< of the lines; not a number where they are few
};

/// psi_s.
struct MeasuredStereoMismatch {
  MeasuredValue share;     ///< of matched lines, the unseen ones near 0 added
  int wrong = 0;           ///< lines more than 3 px off …
  int occluded = 0;        ///< … and of them, such as the right image does not show
  MeasuredValue reach_px;  ///< ± range with their median error
  double unmatched = 0;    ///< share of lines that the right image shows and that are not matched
  std::vector<MismatchByDisparity> by_disparity;  ///< four quarters of the range that occurs
};

struct MeasuredSources {
  std::vector<std::string> pairs;
  int clusters = 0;      ///< that intervals are over
  bool by_pair = false;  ///< they are pairs; else the 4 x 4 parts of each image
  MeasuredEdgeLoss edge_loss;
  MeasuredLateralShift lateral_shift;
  MeasuredEndpoints endpoints;
  MeasuredCorners corners;
  MeasuredStereoMismatch stereo_mismatch;
};

struct MeasuringOptions {
  int min_samples = 30;        ///< of a figure; else it is not a number
  int pairs_for_clusters = 6;  ///< with fewer, parts of images are the clusters
  int wrong_for_reach = 5;     ///< mismatches from which their range is measured
  vernier::internal::BootstrapOptions bootstrap{.resamples = 999};  ///< 0 resamples: no intervals
};

/// The simulator's sources from samples of pairs with truth: equations in docs/characterise.md.
MeasuredSources measure_sources(const std::vector<stereo::internal::PairSamples>& pairs,
                                const MeasuringOptions& options = {});

}  // namespace vernier::sim::internal
