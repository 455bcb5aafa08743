// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matcher_evaluation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/error.h"
#include "calib/statistics/distributions.h"
#include "stereo/canny_edges.h"
#include "stereo/evaluation/edge_error.h"
#include "stereo/matcher.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo {

using namespace internal;

namespace {

constexpr double mismatch_px = 3, inlier_px = 1;
constexpr int angle_bins = 9;

void check_sizes(const std::vector<EdgePoint>& edges,
                 const std::vector<EdgeDisparity>& found,
                 const std::vector<TruthAtEdge>& truth) {
  if (edges.size() == found.size() && edges.size() == truth.size()) return;
  throw Error("evaluation", "edges, disparities and truth differ in number",
              "give one of each per edge");
}

/// Running counts for EdgeMetrics.
struct Tally {
  EdgeMetrics of;
  double squares = 0, sum = 0;

  void add(bool matched, double error) {
    ++of.edges;
    if (!matched) return;
    ++of.matched;
    const double size = std::abs(error);
    of.bad_0_5 += size > 0.5;
    of.bad_1 += size > 1;
    of.bad_2 += size > 2;
    of.bad_3 += size > mismatch_px;
    if (size > inlier_px) return;
    ++of.inliers;
    squares += error * error;
    sum += error;
  }

  EdgeMetrics figures() const {
    EdgeMetrics shares = of;
    const double matched = std::max(1, of.matched), within = std::max(1, of.inliers);
    shares.density = static_cast<double>(of.matched) / std::max(1, of.edges);
    for (double* bad : {&shares.bad_0_5, &shares.bad_1, &shares.bad_2, &shares.bad_3}) {
      *bad /= matched;
    }
    shares.rms_inlier_px = std::sqrt(squares / within);
    shares.bias_inlier_px = sum / within;
    return shares;
  }
};

int angle_bin(const EdgePoint& edge) {
  const double sine = std::min(1.0, static_cast<double>(std::abs(edge.normal.x())));
  const double share = std::asin(sine) / (0.5 * M_PI);  // 0 along the row, 1 vertical
  return std::min(angle_bins - 1, static_cast<int>(share * angle_bins));
}

}  // namespace

MatcherScore evaluate(const std::vector<EdgePoint>& edges,
                      const std::vector<EdgeDisparity>& found,
                      const std::vector<TruthAtEdge>& truth,
                      int width_px,
                      const EvaluationOptions& options) {
  check_sizes(edges, found, truth);
  MatcherScore score;
  Tally all, smooth, discontinuity, by_angle[angle_bins];
  int wrong = 0, covered = 0, inliers = 0;
  double z_squares = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!is_scored(edges[i], truth[i], width_px, options)) continue;
    const bool matched = found[i].matched();
    const double error = matched ? error_px(found[i], truth[i], options.outline) : 0;
    wrong += std::abs(error) > mismatch_px;
    if (is_occluded(truth[i], options.outline)) {
      ++score.occluded;
      score.occluded_matched += matched;
      continue;
    }
    all.add(matched, error);
    (truth[i].discontinuity ? discontinuity : smooth).add(matched, error);
    by_angle[angle_bin(edges[i])].add(matched, error);
    if (!matched || truth[i].discontinuity || !(found[i].sigma_px > 0)) continue;
    const double z = error / found[i].sigma_px;
    ++score.stated;
    covered += std::abs(z) <= vernier::internal::z_95;
    if (std::abs(error) > inlier_px) continue;
    ++inliers;
    z_squares += z * z;
  }
  score.all = all.figures();
  score.smooth = smooth.figures();
  score.discontinuity = discontinuity.figures();
  for (const Tally& tally : by_angle) score.by_angle.push_back(tally.figures());
  score.mismatch =
      static_cast<double>(wrong) / std::max(1, score.all.matched + score.occluded_matched);
  score.coverage_95 = static_cast<double>(covered) / std::max(1, score.stated);
  score.z_rms = std::sqrt(z_squares / std::max(1, inliers));
  return score;
}

std::vector<CurvePoint> density_curve(const std::vector<EdgePoint>& edges,
                                      const std::vector<EdgeDisparity>& found,
                                      const std::vector<TruthAtEdge>& truth,
                                      int width_px,
                                      const DensityCurveOptions& how) {
  const auto& [points, options] = how;
  check_sizes(edges, found, truth);
  struct Match {
    float confidence;
    bool visible, bad, wrong;
  };
  constexpr float unsure = -std::numeric_limits<float>::infinity();
  std::vector<Match> matches;
  int visible = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!is_scored(edges[i], truth[i], width_px, options)) continue;
    const bool shown = !is_occluded(truth[i], options.outline);
    visible += shown;
    if (!found[i].matched()) continue;
    const double error = std::abs(error_px(found[i], truth[i], options.outline));
    matches.push_back({std::isnan(found[i].confidence) ? unsure : found[i].confidence, shown,
                       error > inlier_px, error > mismatch_px});
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const Match& a, const Match& b) { return a.confidence > b.confidence; });
  std::vector<CurvePoint> curve;
  int seen = 0, bad = 0, wrong = 0;
  std::size_t kept = 0;
  for (int k = 1; k <= points; ++k) {
    const auto wanted =
        matches.size() * static_cast<std::size_t>(k) / static_cast<std::size_t>(points);
    while (
        kept < matches.size() &&
        (kept < wanted || (kept > 0 && matches[kept].confidence == matches[kept - 1].confidence))) {
      const Match& match = matches[kept++];
      seen += match.visible;
      bad += match.visible && match.bad;
      wrong += match.wrong;
    }
    if (kept == 0) continue;
    curve.push_back({matches[kept - 1].confidence, static_cast<double>(seen) / std::max(1, visible),
                     static_cast<double>(bad) / std::max(1, seen),
                     static_cast<double>(wrong) / static_cast<double>(kept)});
  }
  std::reverse(curve.begin(), curve.end());
  return curve;
}

double bad_1_at(const std::vector<CurvePoint>& curve, double density) {
  if (curve.empty()) return 0;
  for (std::size_t i = 1; i < curve.size(); ++i) {  // densities decrease
    const CurvePoint &a = curve[i - 1], &b = curve[i];
    if (density > a.density) return a.bad_1;
    if (density < b.density) continue;
    const double t = a.density > b.density ? (a.density - density) / (a.density - b.density) : 0;
    return a.bad_1 + t * (b.bad_1 - a.bad_1);
  }
  return density > curve.front().density ? curve.front().bad_1 : curve.back().bad_1;
}

}  // namespace vernier::stereo
