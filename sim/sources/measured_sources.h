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

/// A value with its 95 % interval.
struct MeasuredValue {
  double value = std::numeric_limits<double>::quiet_NaN();
  Interval interval{std::numeric_limits<double>::quiet_NaN(),
                    std::numeric_limits<double>::quiet_NaN()};
  int samples = 0;

  bool known() const { return value == value; }
};

/// psi_e: fractions of the length of segments.
struct MeasuredEdgeLoss {
  MeasuredValue share;     ///< on no right segment, corrected for chance; written to the file
  MeasuredValue to_left;   ///< the same for right segments in the left image
  MeasuredValue on_edges;  ///< on no edge point of the right image, not corrected for chance
  double chance = 0;       ///< probability that a lost stretch is covered by another edge's segment
  double whole = 0, none = 0;  ///< fraction of segments that are entirely lost, and fully found
  double gaps = 0;             ///< mean number of gaps of the other segments
  double longest_gap = 0;      ///< fraction of the lost length in the longest gap of each segment
};

/// psi_l, as far as it is observable in two simultaneous views: from their difference.
struct MeasuredLateralShift {
  MeasuredValue independent_px;  ///< setting with which the simulated cameras differ as much
  MeasuredValue relative_px;     ///< RMS of right minus left
  MeasuredValue towards_px;      ///< mean of right minus left, towards the brighter side
  double truth_px = 0;  ///< standard deviation of the ground truth's own error, along the row
  double beyond = 0;    ///< fraction of segments that differ by more than four standard deviations
};

/// psi_g, per image.
struct MeasuredEndpoints {
  MeasuredValue across_px;  ///< across the line; written to the file
  MeasuredValue along_px;   ///< along the line
  double broken = 0;  ///< fraction of segments with an end more than 3 px off along them: excluded
  double outliers = 0;  ///< fraction of the others beyond three standard deviations across
};

/// psi_cd and psi_cm.
struct MeasuredCorners {
  MeasuredValue loss;  ///< of pairs; corrected for chance
  double chance = 0;   ///< probability that another corner is found in place of a lost one
  /// Fraction of matches, including undetected mismatches near the centre of the disc.
  MeasuredValue mismatch;
  int wrong = 0;           ///< number of matches more than 1.5 px off
  MeasuredValue reach_px;  ///< radius of the disc with the same median distance
};

/// Lines matched within a range of disparities.
struct MismatchByDisparity {
  double from_px = 0, to_px = 0;
  int lines = 0, wrong = 0;
  MeasuredValue share;  ///< of the lines; NaN if there are few
};

/// psi_s.
struct MeasuredStereoMismatch {
  MeasuredValue share;     ///< of matched lines, including undetected mismatches near 0
  int wrong = 0;           ///< number of lines more than 3 px off …
  int occluded = 0;        ///< … and how many of them are not visible in the right image
  MeasuredValue reach_px;  ///< ± range with the same median error
  double unmatched = 0;    ///< fraction of lines visible in the right image that are not matched
  std::vector<MismatchByDisparity> by_disparity;  ///< four quarters of the observed range
};

struct MeasuredSources {
  std::vector<std::string> pairs;
  int clusters = 0;      ///< number of clusters for the intervals
  bool by_pair = false;  ///< clusters are pairs; else the 4 x 4 parts of each image
  MeasuredEdgeLoss edge_loss;
  MeasuredLateralShift lateral_shift;
  MeasuredEndpoints endpoints;
  MeasuredCorners corners;
  MeasuredStereoMismatch stereo_mismatch;
};

struct MeasuringOptions {
  int min_samples = 30;        ///< per statistic; NaN if fewer
  int pairs_for_clusters = 6;  ///< with fewer pairs, parts of images are the clusters
  int wrong_for_reach = 5;     ///< minimum number of mismatches to estimate their range
  vernier::internal::BootstrapOptions bootstrap{.resamples = 999};  ///< 0 resamples: no intervals
};

/// Estimates the simulator's error sources from samples of pairs with ground truth: equations in
/// docs/characterise.md.
MeasuredSources measure_sources(const std::vector<stereo::internal::PairSamples>& pairs,
                                const MeasuringOptions& options = {});

}  // namespace vernier::sim::internal
