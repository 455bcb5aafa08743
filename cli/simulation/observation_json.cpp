// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/observation_json.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>

#include "calib/rig.h"
#include "cli/program/session.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/uncertainty_source.h"
#include "stereo/segment.h"

namespace vernier::cli {
namespace {

Json point_json(const Eigen::Vector3d& x) { return {x.x(), x.y(), x.z()}; }

/// The visible edges, and for each sensed segment the edge it belongs to.
void add_identities(const NoiseFreeView& seen, const StereoObservation& sighting, Json& json) {
  Json &truth = json["true"], &sensed = json["sensed"];
  for (const char* key : {"feature", "segment", "object", "a_m", "b_m"}) truth[key] = Json::array();
  std::map<std::uint32_t, std::size_t> place;
  for (const VisibleEdge& edge : seen.edges) {
    place[edge.feature] = place.size();
    truth["feature"].push_back(edge.feature);
    truth["segment"].push_back(edge.segment);
    truth["object"].push_back(edge.object);
    truth["a_m"].push_back(point_json(edge.a_m));
    truth["b_m"].push_back(point_json(edge.b_m));
  }
  for (const char* key : {"feature", "edge", "segment"}) sensed[key] = Json::array();
  for (const StereoSegment& s : sighting.segments) sensed["feature"].push_back(s.feature);
  for (const VisibleEdge& edge : sighting.true_edges) {
    sensed["edge"].push_back(edge.is_false() ? Json() : Json(place.at(edge.feature)));
    sensed["segment"].push_back(edge.segment);
  }
}

}  // namespace

Json segment_json(const ImageSegment& s) {
  return {s.a_px.x(), s.a_px.y(), s.b_px.x(), s.b_px.y()};
}

Json space_json(const std::vector<SpaceSegment>& lines) {
  Json json{{"a_m", Json::array()},
            {"b_m", Json::array()},
            {"depth_sigma_m", Json::array()},
            {"reliable", Json::array()}};
  for (const SpaceSegment& line : lines) {
    json["a_m"].push_back(point_json(line.a_m));
    json["b_m"].push_back(point_json(line.b_m));
    json["depth_sigma_m"].push_back(json_number(line.depth_sigma_m));
    json["reliable"].push_back(line.reliable);
  }
  return json;
}

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
  add_identities(seen, sighting, json);
  for (const char* key : {"corner", "mismatched"}) json["corners"][key] = Json::array();
  for (const SensedCorner& c : sighting.corners) {
    json["corners"]["corner"].push_back(c.truth.feature);
    json["corners"]["mismatched"].push_back(c.mismatched);
  }
  return json;
}

}  // namespace vernier::cli
