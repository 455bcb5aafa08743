// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "localise/place.h"

namespace vernier::sim {

/// A straight edge of the wire frame, in metres, z up. `object` is its owner.
struct WorldSegment {
  Eigen::Vector3d a_m, b_m;
  std::int32_t object = 0;
};

/// A point where edges meet, detected as a corner in an image.
struct WorldCorner {
  Eigen::Vector3d position_m;
  std::int32_t object = 0;
};

/// A planar polygon, opaque from both sides. It may be non-convex but must not intersect itself.
struct WorldSurface {
  std::vector<Eigen::Vector3d> polygon_m;
  std::int32_t object = 0;
};

/// An object of the world: an instance of a template, or the loose features (empty template name).
struct WorldObject {
  std::string template_name;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< mean of its segments' ends
  double yaw_rad = 0;                                  ///< of the instance
};

/// One leg of a map route: a polyline on the floor.
struct RouteLeg {
  std::vector<Eigen::Vector2d> points_m;
};

/// The segments that are seen from about a reference pose, by their indices in the world: a set of
/// the memo's view-dependency file.
struct ViewSet {
  localise::Pose2D at;
  std::vector<int> segments;  ///< ascending
};

/// A building as a wire frame with opaque surfaces, in world coordinates.
struct World {
  std::string name;
  std::vector<WorldSegment> segments;
  std::vector<WorldCorner> corners;
  std::vector<WorldSurface> surfaces;
  std::vector<WorldObject> objects;
  std::vector<RouteLeg> route;  ///< the path "default" of studies
  std::vector<ViewSet> view_sets;
};

/// Features in the frame of a template, or of the world.
struct FeatureSet {
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> segments_m;
  std::vector<Eigen::Vector3d> corners_m;
  std::vector<std::vector<Eigen::Vector3d>> surfaces_m;
};

struct WorldTemplate {
  std::string name;
  FeatureSet features;
};

struct WorldInstance {
  std::string template_name;
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0;  ///< about z, counter-clockwise
};

/// Content of a .world.toml: named templates, their instances, and loose features.
struct WorldDescription {
  std::string name;
  std::vector<WorldTemplate> templates;
  std::vector<WorldInstance> instances;
  FeatureSet loose;
  std::vector<RouteLeg> route;
  std::vector<ViewSet> view_sets;  ///< of the world that is built: loose segments come first
};

/// Instantiates the templates. Object 0 holds the loose features, object i + 1 instance i. Throws
/// Error for an instance of an unknown template, a view set that names a segment twice or one that
/// is not there, a segment shorter than 1 mm, and a surface with
/// fewer than three points or not planar to 1 mm, naming template and index; and for a world larger
/// than 10 km or 1,000,000 features of a kind (docs/robustness.md).
World build_world(const WorldDescription& description);

/// Fraction of the world's segments that belong to templates used at least twice, in [0, 1].
double repeated_share(const World& world);

/// Lower and upper corner of the bounding box of all segments, metres.
struct WorldExtent {
  Eigen::Vector3d low_m, high_m;
};
WorldExtent extent(const World& world);

/// A point of a route and the direction of travel.
struct RoutePoint {
  localise::Pose2D pose;
  double leg_position_m = 0;  ///< from the start of its leg
  int leg = 0;
};

/// Total length of all legs, metres.
double route_length_m(const std::vector<RouteLeg>& route);

/// The point at `s_m` metres along all legs in sequence (clamped to the ends of the route).
RoutePoint route_point(const std::vector<RouteLeg>& route, double s_m);

/// Poses at which a map is recorded: every leg is divided evenly into steps of at most `spacing_m`,
/// including its start but not its end. With `headings` = 0 one per position, facing along the
/// route; else that many all around. Throws Error for an empty route, spacing <= 0 or
/// more than 100,000 views.
std::vector<localise::Pose2D> map_poses(const std::vector<RouteLeg>& route,
                                        double spacing_m,
                                        int headings = 0);

/// Poses of a robot that drives along a leg: at most `step_m` apart, and turning on the spot by at
/// most `turn_rad` where the leg bends. Throws Error for steps that are not above 0, and more than
/// 100,000 poses.
std::vector<localise::Pose2D> drive_poses(const RouteLeg& leg, double step_m, double turn_rad);

}  // namespace vernier::sim
