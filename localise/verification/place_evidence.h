// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/place/view_camera.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

/// What a map does to lines, for the comparison of two places in it: with the probability `lost`
/// it holds no line where the world has one, and `chance` is the density, of a perfect one, of a
/// line of another place that looks the same. So many observations are of one thing, whose lines
/// are all at another place or not: some two or three lines.
struct RecordingOptions {
  float lost = 0.2f;
  float chance = 0.1f;
  float of_one_thing = 6;
};

/// A line that the map holds at one place, and how well the best line that it holds at another one
/// agrees with it.
struct LineLikeness {
  float likeness = 0;   ///< in [0, 1]: exp(-energy / 2), 0 without a partner
  float weight = 0;     ///< observations; 0: it says nothing of the share in common
  int partner = -1;     ///< among the other's lines of the same class
  bool is_one = false;  ///< the partner is the line itself, seen from the other place
};

/// Probability that a line of one place is also a line of the other, given what the map holds
/// there, where the share `common` of all lines is (Bayes; docs/localisation.md, equation 1).
double probability_common(double likeness, double common, const RecordingOptions& options);

/// The share of lines that two places have in common: the maximum of the likelihood of what the map
/// holds at both times a prior that is worth one observation of either kind, by expectation
/// maximisation. 0.5 without lines.
double common_share(std::span<const LineLikeness> lines, const RecordingOptions& options);

/// Probability that two places have all lines of a view in common, by what the map holds there and
/// `around`, beyond the view: of its things each is common with the probability that its lines
/// have, where the share of all is that of both. The lines are those of both places.
double probability_equal(std::span<const LineLikeness> view,
                         std::span<const LineLikeness> around,
                         const RecordingOptions& options = {});

/// What the map holds at a pose, as a view sees it.
struct PlacePrediction {
  Pose2D pose_in_map;
  PredictedLines lines;
};

/// How alike two places are: of the lines of each, what the map holds at the other. Uses
/// `covered_px` of the predicted lines as memory.
std::vector<LineLikeness> likenesses_between(PlacePrediction& a,
                                             PlacePrediction& b,
                                             const ViewCamera& camera,
                                             const AgreementOptions& options);

/// What a view says of a pose, line by line: the terms of agreement().
struct PlaceEvidence {
  PlacePrediction predicted;
  struct SeenLine {
    float likelihood = 0;
    int partner = -1;  ///< among the predicted lines of its class; -1: background
  };
  std::vector<SeenLine> seen;                ///< of the view's lines
  std::array<std::vector<float>, 2> missed;  ///< observations, of the steep and flat lines
};
/// Of `pose` in the frame of `lines`, which is `pose_in_map` in that of all places.
PlaceEvidence place_evidence(const ComparedView& view,
                             const SpaceLines& lines,
                             const Pose2D& pose,
                             const Pose2D& pose_in_map,
                             const AgreementOptions& options);

/// What tells two places of a map apart in a view: the difference of their scores in agreement(),
/// in nats, by lines that both poses see, which are one recording, and by the others.
struct PlaceDifference {
  double by_one_recording = 0;
  double by_two_recordings = 0;
  /// Of the latter if the places are equal and their recordings differ alone: then each line is
  /// more like one of them by chance, terms have random signs, and this is the sum of their
  /// squares.
  double variance = 0;
  std::vector<LineLikeness> lines;  ///< of both places
};

/// Of a over b, two poses in one map. Uses `covered_px` of the predicted lines as memory.
PlaceDifference difference_between(const ComparedView& view,
                                   PlaceEvidence& a,
                                   PlaceEvidence& b,
                                   const AgreementOptions& options);

}  // namespace vernier::localise::internal
