// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/experiment.h"

#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/study/blocked_route.h"
#include "sim/study/free_floor.h"
#include "sim/study/standing_place.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim {

using namespace localise;
using namespace vernier::internal;
using namespace internal;

std::string_view name(QueryProtocol protocol) {
  switch (protocol) {
    case QueryProtocol::near_path:
      return "near_path";
    case QueryProtocol::path:
      return "path";
    case QueryProtocol::anywhere:
      return "anywhere";
    case QueryProtocol::free:
      return "free";
  }
  return "";
}

QueryProtocol query_protocol(std::string_view name_of) {
  for (const auto protocol : {QueryProtocol::near_path, QueryProtocol::path,
                              QueryProtocol::anywhere, QueryProtocol::free}) {
    if (name(protocol) == name_of) return protocol;
  }
  throw Error("protocol " + vernier::internal::in_quotes(name_of), "unknown protocol",
              "use near_path, path, anywhere or free");
}

QueryPlaces::QueryPlaces(const Visibility& visibility, QueryProtocol protocol, double eye_height_m)
    : visibility_(visibility), protocol_(protocol), eye_height_m_(eye_height_m) {
  if (!(route_length_m(visibility.world().route) > 0)) {
    throw Error("queries", "the world has no route", "add [[route]] to the world");
  }
  if (protocol == QueryProtocol::free) {
    floor_ = std::make_unique<const FreeFloor>(visibility, eye_height_m);
  }
}

QueryPlaces::~QueryPlaces() = default;
QueryPlaces::QueryPlaces(QueryPlaces&&) noexcept = default;

Pose2D QueryPlaces::draw(std::uint64_t seed, std::uint32_t trial) const {
  const World& world = visibility_.world();
  RandomStream draws(
      {.seed = seed, .trial = trial, .source = static_cast<std::uint32_t>(DrawSource::query_pose)});
  if (floor_) {
    const Eigen::Vector2d at = floor_->draw(draws);
    return {at.x(), at.y(), draws.uniform(-std::numbers::pi, std::numbers::pi)};
  }
  const double length = route_length_m(world.route);
  const ProtocolSpan reach = span(protocol_);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const Pose2D on_route = route_point(world.route, draws.uniform(0, length)).pose;
    const double across = draws.uniform(-reach.across_m, reach.across_m);
    const double turn = draws.uniform(-reach.heading_rad, reach.heading_rad);
    const Pose2D query = compose(on_route, {0, across, turn});
    if (is_free_at(query) && is_seen_from({on_route.x_m, on_route.y_m}, query)) return query;
  }
  throw_no_free_position(world, eye_height_m_);
}

bool QueryPlaces::is_free_at(const Pose2D& pose) const {
  return is_free(visibility_.world(), {pose.x_m, pose.y_m}, robot_radius_m,
                 eye_height_m_ + robot_top_m);
}

bool QueryPlaces::is_seen_from(const Eigen::Vector2d& on_route_m, const Pose2D& pose) const {
  return visibility_.sees({on_route_m.x(), on_route_m.y(), eye_height_m_},
                          {pose.x_m, pose.y_m, eye_height_m_});
}

double QueryPlaces::density(const Pose2D& pose) const {
  const Eigen::Vector2d at(pose.x_m, pose.y_m);
  if (floor_) return floor_->reaches(at) ? 1 : 0;
  constexpr double rounding = 1e-9;
  const ProtocolSpan reach = span(protocol_);
  double density = 0;
  for (const RouteLeg& leg : visibility_.world().route) {
    for (std::size_t i = 1; i < leg.points_m.size(); ++i) {
      const Eigen::Vector2d &a = leg.points_m[i - 1], &b = leg.points_m[i];
      const double length = (b - a).norm();
      if (!(length > 0)) continue;
      const Eigen::Vector2d ahead = (b - a) / length, left(-ahead.y(), ahead.x());
      const double along = ahead.dot(at - a);
      if (along < -rounding || along > length + rounding) continue;
      if (std::abs(left.dot(at - a)) > reach.across_m + rounding) continue;
      const Eigen::Vector2d foot = a + along * ahead;
      const Pose2D on_route{foot.x(), foot.y(), std::atan2(ahead.y(), ahead.x())};
      const double turn = heading_difference_rad(on_route, pose);
      if (std::abs(turn) > reach.heading_rad + rounding) continue;
      if (is_seen_from(foot, pose)) density += 1;
    }
  }
  return density > 0 && is_free_at(pose) ? density : 0;
}

Pose2D draw_query(const Visibility& visibility,
                  QueryProtocol protocol,
                  double eye_height_m,
                  std::uint64_t seed,
                  std::uint32_t trial) {
  return QueryPlaces(visibility, protocol, eye_height_m).draw(seed, trial);
}

}  // namespace vernier::sim
