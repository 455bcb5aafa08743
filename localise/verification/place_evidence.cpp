// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/place_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

double probability_common(double likeness, double common, const RecordingOptions& options) {
  // Equation (1): the density of what the map holds at the other place, if that has the line (and
  // the recording kept or lost it), and if it has not.
  const double as_one = (1 - options.lost) * likeness + options.lost * options.chance;
  const double as_others = options.chance;
  return common * as_one / (common * as_one + (1 - common) * as_others);
}

double common_share(std::span<const LineLikeness> lines, const RecordingOptions& options) {
  constexpr int rounds = 20;
  double share = 0.5;
  for (int round = 0; round < rounds; ++round) {
    double common = 1, all = 2;
    for (const LineLikeness& line : lines) {
      common += line.weight * probability_common(line.likeness, share, options);
      all += line.weight;
    }
    share = common / all;
  }
  return share;
}

double seen_evidence(double likelihood_a, double likelihood_b, double common) {
  // Equation (2): a line of both places is seen as the better recording has it.
  const double as_one = common * std::max(likelihood_a, likelihood_b);
  return std::log(((1 - common) * likelihood_a + as_one) / ((1 - common) * likelihood_b + as_one));
}

double missed_evidence(double missing, double common) {
  return std::log(missing / ((1 - common) + common * missing));  // Equation (3)
}

namespace {

std::array<ImageLines*, 2> sets(PredictedLines& lines) { return {&lines.steep, &lines.flat}; }

/// Of the lines of one place, that each is common to both, by what the map holds at the other.
using Commons = std::array<std::vector<LineLikeness>, 2>;

Commons likenesses(PredictedLines& lines,
                   PredictedLines& others,
                   const ViewCamera& camera,
                   const AgreementOptions& options) {
  Commons result;
  for (std::size_t set = 0; set < 2; ++set) {
    const ImageLines& own = *sets(lines)[set];
    ImageLines& other = *sets(others)[set];
    result[set].reserve(own.size);
    for (int i = 0; i < own.size; ++i) {
      const QueryLine line = as_query_line(own, i);
      const LineMatch match = best_match(line, other, camera, options.tolerance);
      result[set].push_back({likeness(match), line.steep == (set == 0) && may_be_missed(own, i)
                                                  ? observations(line.length_px)
                                                  : 0});
    }
  }
  return result;
}

}  // namespace

PlaceEvidence place_evidence(const ComparedView& view,
                             const SpaceLines& lines,
                             const Pose2D& pose,
                             const AgreementOptions& options) {
  PlaceEvidence evidence;
  predict(lines, pose, view.camera, evidence.predicted);
  evidence.seen.reserve(view.lines.size());
  for (const QueryLine& query : view.lines) {
    ImageLines& partners = query.steep ? evidence.predicted.steep : evidence.predicted.flat;
    const LineMatch match = best_match(query, partners, view.camera, options.tolerance);
    evidence.seen.push_back({likelihood(match, options), match.line});
  }
  for (std::size_t set = 0; set < 2; ++set) {
    const ImageLines& predicted = *sets(evidence.predicted)[set];
    for (int i = 0; i < predicted.size; ++i) {
      evidence.missed[set].push_back(missed(predicted, i));
    }
  }
  return evidence;
}

double evidence_between(const ComparedView& view,
                        PlaceEvidence& a,
                        PlaceEvidence& b,
                        const AgreementOptions& options,
                        const RecordingOptions& recording) {
  const Commons of_a = likenesses(a.predicted, b.predicted, view.camera, options);
  const Commons of_b = likenesses(b.predicted, a.predicted, view.camera, options);
  std::vector<LineLikeness> lines;
  for (const Commons* of : {&of_a, &of_b}) {
    for (const auto& set : *of) lines.insert(lines.end(), set.begin(), set.end());
  }
  const double share = common_share(lines, recording);
  const auto common = [&](const LineLikeness& line) {
    return probability_common(line.likeness, share, recording);
  };
  double evidence = 0;
  for (std::size_t i = 0; i < view.lines.size(); ++i) {
    const auto &at_a = a.seen[i], &at_b = b.seen[i];
    const bool is_of_a = at_a.likelihood >= at_b.likelihood;
    const int partner = is_of_a ? at_a.partner : at_b.partner;
    if (partner < 0) continue;  // background at both
    const LineLikeness& line = (is_of_a ? of_a : of_b)[view.lines[i].steep ? 0 : 1][partner];
    evidence += observations(view.lines[i].length_px) *
                seen_evidence(at_a.likelihood, at_b.likelihood, common(line));
  }
  const auto missed_of = [&](const PlaceEvidence& place, const Commons& of) {
    double sum = 0;
    for (std::size_t set = 0; set < 2; ++set) {
      for (std::size_t i = 0; i < of[set].size(); ++i) {
        if (place.missed[set][i] == 0) continue;
        sum += place.missed[set][i] * missed_evidence(options.missing, common(of[set][i]));
      }
    }
    return sum;
  };
  return evidence + missed_of(a, of_a) - missed_of(b, of_b);
}

}  // namespace vernier::localise::internal
