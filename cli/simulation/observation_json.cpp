// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/observation_json.h"

#include <numbers>

#include "calib/rig.h"
#include "cli/program/session.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sensed_view.h"
#include "stereo/segment.h"

namespace vernier::cli {
namespace {

Json segment_json(const ImageSegment& s) {
  return {s.a_px.x(), s.a_px.y(), s.b_px.x(), s.b_px.y()};
}

}  // namespace

Json sighting_json(const Rig& rig, const NoiseFreeView& seen, const StereoObservation& sighting) {
  Json json;
  json["pose"] = {seen.pose.x_m, seen.pose.y_m, seen.pose.heading_rad * 180 / std::numbers::pi};
  json["camera_size_px"] = {rig.cameras[0].size_px[0], rig.cameras[0].size_px[1]};
  const char* eyes[] = {"left", "right"};
  for (int eye = 0; eye < 2; ++eye) {
    Json& truth = json["true"][eyes[eye]] = Json::array();
    for (const VisibleEdge& edge : seen.edges) {
      SensedEdge exact;
      exact.truth = edge;
      truth.push_back(segment_json(image_of(rig, exact, eye)));
    }
    Json& sensed = json["sensed"][eyes[eye]] = Json::array();
    for (const StereoSegment& segment : sighting.segments) {
      sensed.push_back(segment_json(eye == 0 ? segment.left : segment.right));
    }
    Json& corners = json["corners"][eyes[eye]] = Json::array();
    for (const SensedCorner& corner : sighting.corners) {
      corners.push_back({corner.pixel_px[eye].x(), corner.pixel_px[eye].y()});
    }
  }
  json["sensed"]["feature"] = Json::array();
  for (const StereoSegment& s : sighting.segments) json["sensed"]["feature"].push_back(s.feature);
  json["corners"]["mismatched"] = Json::array();
  for (const SensedCorner& c : sighting.corners) {
    json["corners"]["mismatched"].push_back(c.mismatched);
  }
  return json;
}

}  // namespace vernier::cli
