// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/view_json.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/base/all_within.h"
#include "calib/base/json_node.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/formats/rig_json.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "localise/view_file.h"
#include "localise/views/corner_json.h"
#include "stereo/reconstruction/triangulate.h"
#include "stereo/segment.h"

namespace vernier::localise::internal {

using stereo::ImageSegment;
using stereo::StereoSegment;
using vernier::internal::check_spelling;
using vernier::internal::in_quotes;
using vernier::internal::JsonNode;
using vernier::internal::rig_json::cameras_json;
using vernier::internal::rig_json::parse_cameras;

namespace {

constexpr std::size_t most_looks = 64, most_view_lines = 10'000;
constexpr double shortest_m = 1e-6, shortest_px = 1e-6;

std::string_view kind_name(LineKind kind) {
  switch (kind) {
    case LineKind::vertical:
      return "vertical";
    case LineKind::level:
      return "level";
    case LineKind::oblique:
      return "oblique";
  }
  return "";
}

LineKind parse_kind(const JsonNode& node) {
  const std::string word = node.text();
  for (const LineKind kind : {LineKind::vertical, LineKind::level, LineKind::oblique}) {
    if (word == kind_name(kind)) return kind;
  }
  throw Error(node.place(), in_quotes(word) + " is no kind of line",
              "use vertical, level or oblique");
}

/// Keys of a look; others are passed over, but not those that are nearly one of these.
constexpr std::array<std::string_view, 8> view_keys{
    "cameras", "mount",   "lines", "segments", "image_lines_px", "monocular_lines_px",
    "corners", "turn_rad"};

/// Of a position or a look.
void check_keys_of_view(const JsonNode& node) {
  std::vector<std::string_view> known{"pose", "looks"};
  known.insert(known.end(), view_keys.begin(), view_keys.end());
  check_spelling(node, known);
}

/// Entries of a list that may be missing, at most so many.
std::size_t entries(const JsonNode& node, const std::string& key, std::size_t most) {
  if (!node.has(key)) return 0;
  const std::size_t n = node.at(key).array().size();
  if (n > most) {
    throw Error(node.at(key).place(), fmt::format("has {} entries", n),
                fmt::format("give at most {}", most));
  }
  return n;
}

Eigen::Vector3d parse_point(const JsonNode& node) {
  constexpr double furthest_m = 1000;
  const Eigen::Vector3d point = node.vector3();
  if (!all_within(point, furthest_m)) {
    throw Error(node.place(), fmt::format("is further than {} m away", furthest_m),
                "give metres in the robot frame");
  }
  return point;
}

PlaceLine parse_line(const JsonNode& node) {
  check_spelling(node, {"a_m", "b_m", "kind", "sigma_m"});
  PlaceLine line;
  line.a_m = parse_point(node.at("a_m"));
  line.b_m = parse_point(node.at("b_m"));
  line.sigma_m = node.at("sigma_m").number();
  constexpr double most_sigma_m = 1e6;  // as in maps
  if (!(line.sigma_m >= 0 && line.sigma_m <= most_sigma_m)) {
    throw Error(node.at("sigma_m").place(), fmt::format("is not from 0 to {:g}", most_sigma_m),
                "give metres");
  }
  if (!(line.length_m() > shortest_m)) {
    throw Error(node.place(), "its ends are the same point", "leave the line out");
  }
  line.kind = parse_kind(node.at("kind"));
  if (line.kind == LineKind::vertical) {
    const Eigen::Vector2d middle = 0.5 * (line.a_m + line.b_m).head<2>();
    line.a_m.head<2>() = line.b_m.head<2>() = middle;
    if (!(line.length_m() > shortest_m)) {
      throw Error(node.at("kind").place(), "is vertical, and its ends are equally high",
                  "correct the kind");
    }
  }
  return line;
}

/// Ends in pixels. A rig's camera tells pixels from other units.
ImageSegment parse_segment(const JsonNode& node, const Camera* camera) {
  const Eigen::VectorXd v = node.vector();
  if (v.size() != 4) throw Error(node.place(), "is not a list of 4 numbers", "give u, v, u, v");
  const ImageSegment segment{{v[0], v[1]}, {v[2], v[3]}};
  const double most_px = camera ? 2.0 * camera->size_px.maxCoeff() : 1e6;
  if (!all_within(v, most_px)) {
    throw Error(node.place(), "lies far off the image", "give pixels of the image");
  }
  if (!(segment.length_px() > shortest_px)) {
    throw Error(node.place(), "its ends are the same pixel", "leave the line out");
  }
  return segment;
}

/// Pixels of a whole view within a few units are most probably no pixels.
void check_unit(const std::vector<ImageSegment>& lines, const JsonNode& node) {
  constexpr double normalised = 4;
  if (lines.empty()) return;
  double most = 0;
  for (const ImageSegment& line : lines) {
    most = std::max({most, line.a_px.cwiseAbs().maxCoeff(), line.b_px.cwiseAbs().maxCoeff()});
  }
  if (most < normalised) {
    throw Error(node.place(), fmt::format("every coordinate is below {}", normalised),
                "give pixels, not normalised coordinates");
  }
}

CameraMount parse_mount(const JsonNode& node) {
  check_spelling(node, {"height_m", "pitch_rad"});
  CameraMount mount{node.at("height_m").number(), node.at("pitch_rad").number()};
  constexpr double highest_m = 100;
  if (!(mount.height_m > 0 && mount.height_m <= highest_m)) {
    throw Error(node.at("height_m").place(),
                fmt::format("is not above 0 and at most {}", highest_m), "give metres");
  }
  if (!(std::abs(mount.pitch_rad) < 0.5 * std::numbers::pi)) {
    throw Error(node.at("pitch_rad").place(), "is not within a quarter turn", "give radians");
  }
  return mount;
}

/// The view that matched segments give with the rig that saw them.
PlaceView reconstructed(const JsonNode& node, const PlaceView& seen) {
  if (!seen.rig) {
    throw Error(node.place(), "segments need the cameras that saw them",
                "give a rig, or \"cameras\" with each view");
  }
  std::vector<StereoSegment> segments;
  std::vector<ImageSegment> left;
  for (std::size_t i = 0; i < node.size(); ++i) {
    const JsonNode pair = node.at(i);
    check_spelling(pair, {"left_px", "right_px"});
    segments.push_back({parse_segment(pair.at("left_px"), &seen.rig->cameras[0]),
                        parse_segment(pair.at("right_px"), &seen.rig->cameras[1])});
    left.push_back(segments.back().left);
  }
  check_unit(left, node);
  return select_lines(stereo::internal::triangulate(*seen.rig, segments), segments, seen.mount);
}

/// Segments of the left image under a key of a view; none without the key.
std::vector<ImageSegment> parse_segments(const JsonNode& node, const char* key, const Rig* rig) {
  std::vector<ImageSegment> segments;
  const std::size_t count = entries(node, key, most_view_lines);
  for (std::size_t i = 0; i < count; ++i) {
    segments.push_back(parse_segment(node.at(key).at(i), rig ? rig->cameras.data() : nullptr));
  }
  check_unit(segments, node);
  return segments;
}

Json segments_json(const std::vector<ImageSegment>& segments) {
  Json json = Json::array();
  for (const ImageSegment& line : segments) {
    json.push_back({line.a_px.x(), line.a_px.y(), line.b_px.x(), line.b_px.y()});
  }
  return json;
}

PlaceView parse_view(const JsonNode& node, const std::shared_ptr<const Rig>& rig) {
  PlaceView view;
  view.rig = rig;
  if (node.has("cameras")) {
    view.rig = std::make_shared<const Rig>(parse_cameras(node.at("cameras")));
  }
  // lines may be those of one camera, as of an image with depths
  const bool needs_pair = node.has("segments") || node.has("corners");
  const std::size_t cameras = view.rig ? view.rig->cameras.size() : 2;
  if (cameras != 2 && (cameras != 1 || needs_pair)) {
    throw Error(node.has("cameras") ? node.at("cameras").place() : node.place(),
                "the rig does not have two cameras", "give a stereo rig");
  }
  if (node.has("mount")) view.mount = parse_mount(node.at("mount"));
  if (entries(node, "corners", most_view_lines) > 0) {
    view.corners = parse_corners(node.at("corners"), view.rig.get());
  }
  view.monocular_lines = parse_segments(node, "monocular_lines_px", view.rig.get());
  if (node.has("segments")) {
    if (node.has("lines") || node.has("image_lines_px")) {
      throw Error(node.place(), "has segments and lines", "give one of them");
    }
    entries(node, "segments", most_view_lines);
    const PlaceView lines = reconstructed(node.at("segments"), view);
    view.lines = lines.lines;
    view.image_lines = lines.image_lines;
    return view;
  }
  if (!node.has("lines") && !node.has("corners")) {
    throw Error(node.place(), "has neither \"lines\", \"segments\" nor \"corners\"",
                "give \"lines\": [] for a view without any");
  }
  const std::size_t lines = entries(node, "lines", most_view_lines);
  for (std::size_t i = 0; i < lines; ++i) view.lines.push_back(parse_line(node.at("lines").at(i)));
  view.image_lines = parse_segments(node, "image_lines_px", view.rig.get());
  return view;
}

double parse_angle(const JsonNode& node) {
  const double angle = node.number();
  if (!(std::abs(angle) <= 2 * std::numbers::pi)) {
    throw Error(node.place(), "is more than a turn", "give radians");
  }
  return angle;
}

Json point_json(const Eigen::Vector3d& x) { return {x.x(), x.y(), x.z()}; }

}  // namespace

Json pose_json(const Pose2D& pose) {
  return {pose.x_m, pose.y_m, std::remainder(pose.heading_rad, 2 * std::numbers::pi)};
}

Pose2D parse_pose(const JsonNode& node) {
  constexpr double most_m = 1e6;
  if (node.array().size() != 3) {
    throw Error(node.place(), "is not a list of 3 numbers", "give x_m, y_m, heading_rad");
  }
  const Pose2D pose{node.at(0).number(), node.at(1).number(), parse_angle(node.at(2))};
  if (!(std::abs(pose.x_m) <= most_m && std::abs(pose.y_m) <= most_m)) {
    throw Error(node.place(), "is beyond 1,000 km", "give metres");
  }
  return pose;
}

Json view_json(const PlaceView& view) {
  Json json;
  json["mount"] = {{"height_m", view.mount.height_m}, {"pitch_rad", view.mount.pitch_rad}};
  if (view.rig) json["cameras"] = cameras_json(*view.rig);
  Json& lines = json["lines"] = Json::array();
  for (const PlaceLine& line : view.lines) {
    lines.push_back({{"a_m", point_json(line.a_m)},
                     {"b_m", point_json(line.b_m)},
                     {"kind", kind_name(line.kind)},
                     {"sigma_m", line.sigma_m}});
  }
  json["image_lines_px"] = segments_json(view.image_lines);
  if (!view.monocular_lines.empty()) {
    json["monocular_lines_px"] = segments_json(view.monocular_lines);
  }
  if (!view.corners.empty()) json["corners"] = corners_json(view.corners);
  return json;
}

Json looks_json(std::span<const Look> looks) {
  Json json = Json::array();
  for (const Look& look : looks) {
    Json one{{"turn_rad", look.turn_rad}};
    one.update(view_json(look.view));
    json.push_back(std::move(one));
  }
  return json;
}

RecordedLooks parse_looks(const JsonNode& node, const std::shared_ptr<const Rig>& rig) {
  RecordedLooks recorded;
  check_keys_of_view(node);
  if (node.has("pose")) recorded.pose = parse_pose(node.at("pose"));
  if (!node.has("looks")) {
    if (node.has("turn_rad")) {
      throw Error(node.at("turn_rad").place(), "is of no look", "give \"looks\", or leave it out");
    }
    recorded.looks.push_back({parse_view(node, rig), 0});
    return recorded;
  }
  for (const std::string_view key : view_keys) {
    if (!node.has(std::string(key))) continue;
    throw Error(node.place(), fmt::format("has \"{}\" beside \"looks\"", key),
                "put it into each of the looks");
  }
  const std::size_t looks = entries(node, "looks", most_looks);
  if (looks == 0) throw Error(node.at("looks").place(), "is empty", "give at least one");
  for (std::size_t i = 0; i < looks; ++i) {
    const JsonNode look = node.at("looks").at(i);
    check_keys_of_view(look);
    for (const char* key : {"pose", "looks"}) {
      if (look.has(key)) {
        throw Error(look.at(key).place(), "is inside a look",
                    "put it beside \"looks\", or leave it out");
      }
    }
    const bool has_turn = look.has("turn_rad");
    if (i > 0 && !has_turn) {
      throw Error(look.place(), "has no \"turn_rad\"",
                  "give its heading less that of the first look, rad");
    }
    const double turn = has_turn ? parse_angle(look.at("turn_rad")) : 0;
    if (i == 0 && turn != 0) {
      throw Error(look.at("turn_rad").place(), "is not 0 for the first look",
                  "count turns from its heading");
    }
    recorded.looks.push_back({parse_view(look, rig), turn});
  }
  return recorded;
}

}  // namespace vernier::localise::internal
