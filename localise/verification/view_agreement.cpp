// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/view_agreement.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/place/view_camera.h"
#include "localise/verification/image_lines.h"

namespace vernier::localise::internal {

float observations(float length_px) {
  constexpr float observation_px = 40, most_px = 120;
  return std::min(length_px, most_px) / observation_px;
}

float likeness(const LineMatch& match) {
  return match.line >= 0 ? std::exp(-0.5f * match.energy) : 0.0f;
}

float likelihood(const LineMatch& match, const AgreementOptions& options) {
  return options.background + (1 - options.background) * likeness(match);
}

bool may_be_missed(const ImageLines& lines, int line, const ViewCamera& camera) {
  constexpr float shortest_px = 25;    // shorter ones are often lost
  constexpr float least_sine = 0.14f;  // 8 degrees: closer to the baseline, no disparity
  const float sine =
      lines.dy[line] * camera.along_baseline.x() - lines.dx[line] * camera.along_baseline.y();
  return lines.length_px[line] >= shortest_px && std::abs(sine) >= least_sine;
}

float missed(const ImageLines& lines, int line, const ViewCamera& camera) {
  constexpr float seen_share = 0.8f;  // the rest may be lost to gaps
  if (lines.counted[line] == 0 || !may_be_missed(lines, line, camera)) return 0;
  const float length = lines.length_px[line];
  const float seen = std::min(1.0f, lines.covered_px[line] / (seen_share * length));
  return observations(length) * (1 - seen);
}

namespace {

float missed(const ImageLines& lines, const ViewCamera& camera) {
  float sum = 0;
  for (int i = 0; i < lines.size; ++i) sum += missed(lines, i, camera);
  return sum;
}

}  // namespace

QueryLine as_query_line(const ImageLines& lines, int line) {
  const float half = 0.5f * lines.length_px[line];
  return {lines.u[line] + half * lines.dx[line],
          lines.v[line] + half * lines.dy[line],
          lines.w[line] + 0.5f * lines.dw[line],
          lines.dx[line],
          lines.dy[line],
          lines.length_px[line],
          lines.variance_m2[line],
          is_steep(lines.dx[line])};
}

AgreementOptions wide_agreement() {
  AgreementOptions options;
  options.tolerance.offset_px = 20;
  options.tolerance.offset_m = 0.06f;
  options.tolerance.angle_rad = 0.1f;
  options.tolerance.disparity_px = 1.5f;
  options.tolerance.disparity_share = 0.05f;
  return options;
}

AgreementOptions rough_agreement() { return {}; }

AgreementOptions fine_agreement() {
  AgreementOptions options;
  options.tolerance.angle_rad = 0.01f;
  options.tolerance.angle_px = 1;
  options.tolerance.disparity_px = 0.3f;
  options.tolerance.disparity_share = 0.01f;
  return options;
}

ComparedView compared_view(const PlaceView& view) {
  ComparedView compared{view_camera(view), {}, 0};
  compared.lines = query_lines(view, compared.camera);
  for (const QueryLine& line : compared.lines) {
    compared.observations += observations(line.length_px);
  }
  return compared;
}

ComparedView predicted_view(const SpaceLines& lines,
                            const Pose2D& pose,
                            const ViewCamera& camera,
                            PredictedLines& room) {
  predict(lines, pose, camera, room);
  ComparedView view{camera, {}, 0};
  for (const ImageLines* set : {&room.steep, &room.flat}) {
    for (int i = 0; i < set->size; ++i) {
      const QueryLine line = as_query_line(*set, i);
      if (line.steep != (set == &room.steep)) continue;  // those of both sets once
      view.lines.push_back(line);
      view.observations += observations(line.length_px);
    }
  }
  return view;
}

ViewAgreement agreement(const ComparedView& view,
                        const SpaceLines& lines,
                        const Pose2D& pose,
                        const AgreementOptions& options,
                        PredictedLines& room) {
  ViewAgreement result;
  predict(lines, pose, view.camera, room);
  for (const QueryLine& query : view.lines) {
    ImageLines& partners = query.steep ? room.steep : room.flat;
    const LineMatch match = best_match(query, partners, view.camera, options.tolerance);
    const float weight = observations(query.length_px);
    result.score += weight * std::log(likelihood(match, options));
    if (match.line < 0) continue;
    // Gauss-Newton with the weight that the mixture gives the partner.
    const LineDeviation d = deviation(query, partners, match.line, view.camera, options.tolerance);
    const float like = likeness(match);
    const float trust = weight * like / (like + options.background);
    const Eigen::Matrix3f J = step_jacobian(view.camera, {query.u, query.v, query.w});
    const Eigen::RowVector3f by_offset =
        (J.row(0) * partners.dy[match.line] - J.row(1) * partners.dx[match.line]) /
        d.offset_sigma_px;
    result.gradient -= trust * d.offset * by_offset.transpose();
    result.information += trust * by_offset.transpose() * by_offset;
    if (d.disparity * d.disparity < options.tolerance.most_disparity_energy) {
      const Eigen::RowVector3f by_disparity =
          view.camera.disparity_px_m() * J.row(2) / d.disparity_sigma_px;
      result.gradient -= trust * d.disparity * by_disparity.transpose();
      result.information += trust * by_disparity.transpose() * by_disparity;
    }
  }
  result.score += std::log(options.missing) *
                  (missed(room.steep, view.camera) + missed(room.flat, view.camera));
  return result;
}

Eigen::Matrix3f step_damping() { return Eigen::Vector3f(1, 1, 100).asDiagonal(); }

ImprovedPose improve(const ComparedView& view,
                     const SpaceLines& lines,
                     const Pose2D& start,
                     int steps,
                     const AgreementOptions& options,
                     PredictedLines& room) {
  ImprovedPose best;
  Pose2D at = start;
  for (int step = 0; step <= steps; ++step) {
    const ViewAgreement here = agreement(view, lines, at, options, room);
    if (step == 0 || here.score > best.score) best = {at, here.score, here.information};
    if (step == steps) break;
    const Eigen::Vector3f move = (here.information + step_damping()).inverse() * here.gradient;
    if (!move.allFinite()) break;
    at = compose(at, {move[0], move[1], move[2]});
  }
  return best;
}

}  // namespace vernier::localise::internal
