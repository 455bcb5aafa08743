// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

/// What a recording does to lines, for the comparison of two places of one map: with the
/// probability `lost` it holds no line where the world has one, and `chance` is the density, of a
/// perfect one, of a line of another place that looks the same.
struct RecordingOptions {
  float lost = 0.2f;
  float chance = 0.1f;
};

/// A line that the map holds at one place, and how well the best line that it holds at another one
/// agrees with it.
struct LineLikeness {
  float likeness = 0;  ///< in [0, 1]: exp(-energy / 2), 0 without a partner
  float weight = 0;    ///< observations
};

/// Probability that a line of one place is also a line of the other, given what the map holds
/// there, where the share `common` of all lines is (Bayes; docs/localisation.md, equation 1).
double probability_common(double likeness, double common, const RecordingOptions& options);

/// The share of lines that two places have in common: the maximum of the likelihood of what the map
/// holds at both times a prior that is worth one observation of either kind, by expectation
/// maximisation. 0.5 without lines.
double common_share(std::span<const LineLikeness> lines, const RecordingOptions& options);

/// Log-likelihood ratio, nats, of place a over place b by a line of a view, which is probable by
/// what the map holds at a or at b, and which both have in common with the probability `common`
/// (equation 2). Nothing if it is 1, whatever the map holds; the plain ratio if it is 0.
double seen_evidence(double likelihood_a, double likelihood_b, double common);

/// The same by a line of place a that a view lacks, of which `missing` is the probability if the
/// place has it (equation 3). Never positive.
double missed_evidence(double missing, double common);

/// What a view says of a pose, line by line: the terms of agreement().
struct PlaceEvidence {
  PredictedLines predicted;
  struct SeenLine {
    float likelihood = 0;
    int partner = -1;  ///< among the predicted lines of its class; -1: background
  };
  std::vector<SeenLine> seen;                ///< of the view's lines
  std::array<std::vector<float>, 2> missed;  ///< observations, of the steep and flat lines
};
PlaceEvidence place_evidence(const ComparedView& view,
                             const SpaceLines& lines,
                             const Pose2D& pose,
                             const AgreementOptions& options);

/// Log-likelihood ratio, nats, that the view was taken at a and not at b, two poses in one map: the
/// difference of their scores in agreement(), less what is explained by one recording of the same
/// lines at both. Uses `covered_px` of the predicted lines as memory.
double evidence_between(const ComparedView& view,
                        PlaceEvidence& a,
                        PlaceEvidence& b,
                        const AgreementOptions& options,
                        const RecordingOptions& recording = {});

}  // namespace vernier::localise::internal
