// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// psi_cd, psi_cm and psi_s from matched corners and lines.
#include <cmath>

#include "sim/measured_figures.h"
#include "sim/sources.h"

namespace vernier {
namespace {

constexpr double wrong_corner_px = 1.5, wrong_line_px = 3;
constexpr int disparity_bins = 4;
constexpr double most_reach_px = 500;  // that a study accepts

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A share's interval is no narrower than that of independent trials: without it, samples that are
/// all alike would have none.
void widen_to_wilson(Measured& share) {
  if (!share.known()) return;
  const Interval wilson = wilson_interval(share.value * share.samples, share.samples);
  share.interval.low = std::fmin(share.interval.low, wilson.low);
  share.interval.high = std::min(1.0, std::fmax(share.interval.high, wilson.high));
}

/// How far mismatches reach that are spread evenly over a disc, or (`line`) over ± a range, from
/// those seen beyond `seen_from_px`. Not a number for fewer than `least`.
double reach_of(const std::vector<double>& errors_px, double seen_from_px, bool line, int least) {
  if (static_cast<int>(errors_px.size()) < least) return std::numeric_limits<double>::quiet_NaN();
  const double middle = median(errors_px);
  const double reach = line ? 2 * middle - seen_from_px
                            : std::sqrt(2 * middle * middle - seen_from_px * seen_from_px);
  return std::min(most_reach_px, reach);
}

/// Share of mismatches that lie beyond `seen_from_px`; at least a half of them.
double seen_share(double reach_px, double otherwise_px, double seen_from_px, bool line) {
  const double reach = reach_px == reach_px ? reach_px : otherwise_px;
  const double hidden = std::min(0.5, seen_from_px / reach);
  return 1 - (line ? hidden : hidden * hidden);
}

Measured mismatch_share(const std::map<int, Sums>& sums,
                        int count,
                        double seen,
                        const MeasuringOptions& options) {
  Measured share = measured_ratio(sums, count, options, [=](const Sums& all) {
    return std::min(1.0, all.part / (all.whole * seen));
  });
  widen_to_wilson(share);
  return share;
}

Measured corner_loss(const PairList& pairs,
                     const ClusterOf& cluster,
                     const MeasuringOptions& options,
                     double& chance) {
  std::map<int, Sums> sums;
  int count = 0;
  double by_chance = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (const CornerRepeat& corner : pairs[p].corners) {
      Sums& sum = sums[cluster(pairs[p], static_cast<int>(p), corner.left_px)];
      sum.part += corner.found ? 0 : 1;
      sum.whole += 1;
      sum.chance += corner.chance;
      by_chance += corner.chance;
      ++count;
    }
  }
  chance = by_chance / std::max(1, count);
  Measured loss = measured_ratio(sums, count, options, [](const Sums& all) {
    return std::min(1.0, all.part / std::max(1e-3 * all.whole, all.whole - all.chance));
  });
  widen_to_wilson(loss);
  return loss;
}

void add_bins(const PairList& pairs, MeasuredStereoMismatch& result) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const PairSamples& pair : pairs) {
    for (const LineMatch& line : pair.lines) {
      least = std::min(least, line.disparity_px);
      most = std::max(most, line.disparity_px);
    }
  }
  if (!(most > least)) return;
  const double width = (most - least) / disparity_bins;
  for (int bin = 0; bin < disparity_bins; ++bin) {
    result.by_disparity.push_back({least + bin * width, least + (bin + 1) * width, 0, 0, {}});
  }
  for (const PairSamples& pair : pairs) {
    for (const LineMatch& line : pair.lines) {
      if (!line.matched) continue;
      const int at = static_cast<int>((line.disparity_px - least) / width);
      MismatchByDisparity& bin = result.by_disparity[std::min(at, disparity_bins - 1)];
      ++bin.lines;
      bin.wrong += line.error_px > wrong_line_px;
    }
  }
  for (MismatchByDisparity& bin : result.by_disparity) {
    bin.wilson = wilson_interval(bin.wrong, bin.lines);
  }
}

}  // namespace

MeasuredCorners measured_corners(const PairList& pairs,
                                 const ClusterOf& cluster,
                                 const MeasuringOptions& options) {
  MeasuredCorners result;
  result.loss = corner_loss(pairs, cluster, options, result.chance);
  std::map<int, Sums> sums;
  std::vector<double> errors;
  int count = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (const CornerError& match : pairs[p].corner_matches) {
      Sums& sum = sums[cluster(pairs[p], static_cast<int>(p), match.left_px)];
      const bool wrong = match.error_px > wrong_corner_px;
      if (wrong) errors.push_back(match.error_px);
      sum.part += wrong;
      sum.whole += 1;
      ++count;
    }
  }
  result.wrong = static_cast<int>(errors.size());
  result.reach_px = reach_of(errors, wrong_corner_px, false, options.wrong_for_reach);
  const double seen =
      seen_share(result.reach_px, SourceSettings().corner_mismatch_px, wrong_corner_px, false);
  result.mismatch = mismatch_share(sums, count, seen, options);
  return result;
}

MeasuredStereoMismatch measured_stereo_mismatch(const PairList& pairs,
                                                const ClusterOf& cluster,
                                                const MeasuringOptions& options) {
  MeasuredStereoMismatch result;
  std::map<int, Sums> sums;
  std::vector<double> errors;
  int matched = 0, shown = 0, unmatched = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (const LineMatch& line : pairs[p].lines) {
      shown += !line.occluded;
      unmatched += !line.occluded && !line.matched;
      if (!line.matched) continue;
      Sums& sum = sums[cluster(pairs[p], static_cast<int>(p), line.left_px)];
      const bool wrong = line.error_px > wrong_line_px;
      if (wrong) errors.push_back(line.error_px);
      result.occluded += wrong && line.occluded;
      sum.part += wrong;
      sum.whole += 1;
      ++matched;
    }
  }
  result.wrong = static_cast<int>(errors.size());
  result.unmatched = static_cast<double>(unmatched) / std::max(1, shown);
  result.reach_px = reach_of(errors, wrong_line_px, true, options.wrong_for_reach);
  const double seen =
      seen_share(result.reach_px, SourceSettings().stereo_mismatch_px, wrong_line_px, true);
  result.share = mismatch_share(sums, matched, seen, options);
  add_bins(pairs, result);
  return result;
}

}  // namespace vernier
