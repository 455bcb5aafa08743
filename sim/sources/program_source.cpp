// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sources/program_source.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/all_within.h"
#include "calib/base/answering_program.h"
#include "calib/base/json_node.h"
#include "calib/base/program_run.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/formats/rig_json.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "sim/sources/false_features.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using namespace stereo;
using namespace vernier::internal;

namespace {

using Json = nlohmann::ordered_json;

constexpr int protocol_version = 2;
constexpr double start_s = 10;   ///< to get ready, in addition to the time limit of a view
constexpr double most_px = 1e6;  ///< of a coordinate
constexpr std::size_t most_added = 100'000;

std::string hello_line(const Rig& rig) {
  return Json{{"vernier_source", protocol_version}, {"cameras", rig_json::cameras_json(rig)}}
             .dump() +
         "\n";
}

Json segment_json(const ImageSegment& s) {
  return {s.a_px.x(), s.a_px.y(), s.b_px.x(), s.b_px.y()};
}

std::uint32_t identity(const SensedEdge& edge) { return edge.truth.feature * 2 + edge.piece; }

Json view_json(const SensingContext& context, const SensedView& view) {
  Json edges = Json::array();
  for (const SensedEdge& edge : view.edges) {
    edges.push_back({{"id", identity(edge)},
                     {"left_px", segment_json(image_of(context.rig, edge, 0))},
                     {"right_px", segment_json(image_of(context.rig, edge, 1))},
                     {"in_stereo", edge.in_stereo}});
  }
  return Json{{"seed", context.seed},
              {"trial", context.trial},
              {"frame", context.frame},
              {"edges", std::move(edges)}};
}

ImageSegment parse_segment(const JsonNode& node) {
  const Eigen::VectorXd ends = node.vector();
  if (ends.size() != 4 || !all_within(ends, most_px) || ends.head<2>() == ends.tail<2>()) {
    throw Error(node.place(), "is no segment within 1e6 pixels", "give u, v, u, v of its two ends");
  }
  return {ends.head<2>(), ends.tail<2>()};
}

/// Moves an eye's image of the edge.
void move_to(const Rig& rig, const ImageSegment& wanted, int eye, SensedEdge& edge) {
  const ImageSegment now = image_of(rig, edge, eye);
  edge.offset_px[eye][0] += wanted.a_px - now.a_px;
  edge.offset_px[eye][1] += wanted.b_px - now.b_px;
}

/// The point of the left eye's ray that is nearest to the right eye's; at 10 m where they do not
/// meet in front of the rig.
Eigen::Vector3d meeting_point(const Rig& rig,
                              const Eigen::Vector2d& left_px,
                              const Eigen::Vector2d& right_px) {
  constexpr double nearest_m = 0.1, farthest_m = 1000, otherwise_m = 10;
  const std::optional<Eigen::Vector3d> left = try_unproject(rig.cameras[0], left_px),
                                       right = try_unproject(rig.cameras[1], right_px);
  if (!left || !right) return {0, 0, otherwise_m};
  const Pose T_left_right = rig.T_camera_first[1].inverse();
  const Eigen::Vector3d d = *left, e = T_left_right.R * *right;
  const double dd = d.dot(d), de = d.dot(e), ee = e.dot(e);
  const double depth =
      (ee * d.dot(T_left_right.t) - de * e.dot(T_left_right.t)) / (dd * ee - de * de);
  return (depth >= nearest_m && depth <= farthest_m ? depth : otherwise_m) * d;
}

/// An edge that the program adds: false, with these images.
SensedEdge added_edge(const Rig& rig, const JsonNode& node, std::size_t number) {
  const ImageSegment left = parse_segment(node.at("left_px")),
                     right = parse_segment(node.at("right_px"));
  SensedEdge edge;
  edge.truth.a_m = meeting_point(rig, left.a_px, right.a_px);
  edge.truth.b_m = meeting_point(rig, left.b_px, right.b_px);
  edge.truth.segment = no_segment;
  edge.truth.feature =
      first_false_feature + most_false_features + static_cast<std::uint32_t>(number);
  edge.truth.object_centre_m.setZero();
  move_to(rig, left, 0, edge);
  move_to(rig, right, 1, edge);
  return edge;
}

bool parse_flag(const JsonNode& node) {
  if (!node.json().is_boolean()) throw Error(node.place(), "is not true or false", "use one");
  return node.json().get<bool>();
}

}  // namespace

void apply_answer(const JsonNode& answer, const Rig& rig, SensedView& view) {
  const JsonNode edges = answer.at("edges");
  edges.array();
  std::map<std::uint32_t, SensedEdge*> known;  // those not yet answered
  for (SensedEdge& edge : view.edges) known[identity(edge)] = &edge;
  std::vector<SensedEdge> kept;
  std::size_t added = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const JsonNode node = edges.at(i);
    check_spelling(node, {"id", "left_px", "right_px", "in_stereo"});
    SensedEdge edge;
    if (node.has("id") && !node.at("id").json().is_null()) {
      const Json& id = node.at("id").json();
      const auto found =
          id.is_number_unsigned() ? known.find(id.get<std::uint32_t>()) : known.end();
      if (found == known.end() || id.get<std::uint64_t>() != found->first) {
        throw Error(node.at("id").place(), "is no edge of the view, or is there twice",
                    "leave it out for an edge that is added");
      }
      edge = *found->second;
      known.erase(found);
      if (node.has("left_px")) move_to(rig, parse_segment(node.at("left_px")), 0, edge);
      if (node.has("right_px")) move_to(rig, parse_segment(node.at("right_px")), 1, edge);
    } else {
      if (added == most_added) {
        throw Error(node.place(), fmt::format("is one of more than {} edges added", most_added),
                    "add fewer");
      }
      edge = added_edge(rig, node, added++);
    }
    if (node.has("in_stereo")) edge.in_stereo = parse_flag(node.at("in_stereo"));
    kept.push_back(std::move(edge));
  }
  view.edges = std::move(kept);
}

ProgramSource::ProgramSource(const SourceSettings& settings, const Rig& rig)
    : program_(
          command_words(settings.command, "sources.command"),
          {[hello = hello_line(rig)] { return hello; }, "the rig", settings.time_limit_s + start_s},
          settings.time_limit_s) {}

void ProgramSource::apply(const SensingContext& context, SensedView& view) const {
  const std::lock_guard lock(mutex_);
  const auto question = [&] { return view_json(context, view); };
  const auto take = [&](const JsonNode& answer) { apply_answer(answer, context.rig, view); };
  if (!program_.ask(question, take)) view.failure = "the source's program " + program_.failure();
}

SourcePointer make_program_source(const SourceSettings& settings, const Rig& rig) {
  return std::make_unique<ProgramSource>(settings, rig);
}

}  // namespace vernier::sim::internal
