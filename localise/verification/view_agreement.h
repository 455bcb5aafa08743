// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/place/view_camera.h"
#include "localise/verification/image_lines.h"

namespace vernier::localise::internal {

/// The likelihood model of a view given the lines that should be seen.
struct AgreementOptions {
  LineTolerance tolerance;
  float background = 0.03f;  ///< density of a line that the map does not hold, of a perfect one
  float missing = 0.06f;     ///< probability of not seeing again what the map holds
};

/// For poses as votes give them: it leads to the right one from about 0.15 m and 3 degrees away.
AgreementOptions wide_agreement();
/// For choosing among candidates, whose poses are still rough.
AgreementOptions rough_agreement();
/// For the last comparison.
AgreementOptions fine_agreement();

/// A view as it is compared.
struct ComparedView {
  ViewCamera camera;
  std::vector<QueryLine> lines;
  double observations = 0;  ///< sum of the lines' weights, see agreement()
};
ComparedView compared_view(const PlaceView& view);

/// The view that lines would give.
ComparedView predicted_view(const SpaceLines& lines,
                            const Pose2D& pose,
                            const ViewCamera& camera,
                            PredictedLines& room);

/// How well lines that the map holds explain a view from a pose, and the Gauss-Newton model of it.
struct ViewAgreement {
  float score = 0;  ///< log-likelihood in nats, up to a constant of the view
  Eigen::Matrix3f information = Eigen::Matrix3f::Zero();  ///< of (x, y, turn), robot frame
  Eigen::Vector3f gradient = Eigen::Vector3f::Zero();
};

/// Lines are sampled by the error sources in pieces: 40 px of one count as one observation, of its
/// first 120 px.
float observations(float length_px);

/// How much a line is like its best partner, in [0, 1]: exp(-energy / 2), 0 without one.
float likeness(const LineMatch& match);

/// Density of a line of a view with this best partner, of a perfect one: its own or background.
float likelihood(const LineMatch& match, const AgreementOptions& options);

/// Whether a predicted line is long and steep enough to the baseline to be in views.
bool may_be_missed(const ImageLines& lines, int line, const ViewCamera& camera);

/// Length of a predicted line that counts and was not seen, by `covered_px`, in observations.
float missed(const ImageLines& lines, int line, const ViewCamera& camera);

/// A predicted line as one of a view.
QueryLine as_query_line(const ImageLines& lines, int line);

/// Compares a view with lines in its image, both ways: every line of the view has its best
/// partner or is background; every counted line that both eyes should see has been seen in part or
/// whole, or is missing. `room` is memory that calls share.
ViewAgreement agreement(const ComparedView& view,
                        const SpaceLines& lines,
                        const Pose2D& pose,
                        const AgreementOptions& options,
                        PredictedLines& room);

/// Information that keeps a Gauss-Newton step short: a candidate's pose is known to 1 m and 0.1
/// rad.
Eigen::Matrix3f step_damping();

struct ImprovedPose {
  Pose2D pose;
  float score = 0;
  Eigen::Matrix3f information = Eigen::Matrix3f::Zero();
};

/// The best of the poses that `steps` Gauss-Newton steps go through.
ImprovedPose improve(const ComparedView& view,
                     const SpaceLines& lines,
                     const Pose2D& start,
                     int steps,
                     const AgreementOptions& options,
                     PredictedLines& room);

}  // namespace vernier::localise::internal
