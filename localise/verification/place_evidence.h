// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/place/view_camera.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

/// What the map holds at a pose, as a view sees it.
struct PlacePrediction {
  Pose2D pose_in_map;
  PredictedLines lines;
};

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
};

/// Of a over b, two poses in one map. Uses `covered_px` of the predicted lines as memory.
PlaceDifference difference_between(const ComparedView& view,
                                   PlaceEvidence& a,
                                   PlaceEvidence& b,
                                   const AgreementOptions& options);

}  // namespace vernier::localise::internal
