// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/wire_paint.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/images/backing.h"
#include "sim/images/materials.h"
#include "sim/images/surface_appearance.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace vernier::internal;
using Eigen::Vector3d;

namespace {

constexpr double reach_m = 0.025;

/// An end of a segment of an object, to 0.1 mm.
using EndKey = std::array<std::int64_t, 4>;

EndKey key_of(std::int32_t object, const Vector3d& x) {
  constexpr double grid = 1e4;
  const auto rounded = [](double value) { return std::llround(grid * value + 0.37); };
  return {object, rounded(x.x()), rounded(x.y()), rounded(x.z())};
}

/// The segments that end at each place.
using Ends = std::map<EndKey, std::vector<int>>;

Ends ends_of(const World& world) {
  Ends ends;
  for (std::size_t i = 0; i < world.segments.size(); ++i) {
    const WorldSegment& s = world.segments[i];
    ends[key_of(s.object, s.a_m)].push_back(static_cast<int>(i));
    ends[key_of(s.object, s.b_m)].push_back(static_cast<int>(i));
  }
  return ends;
}

struct Loop {
  std::vector<int> segments;
  std::vector<Vector3d> polygon_m;
};

/// The loop that starts with a segment, if every end on the way has two segments.
std::optional<Loop> loop_from(const World& world, const Ends& ends, int first) {
  constexpr std::size_t longest = 64;
  const WorldSegment& start = world.segments[static_cast<std::size_t>(first)];
  const EndKey home = key_of(start.object, start.a_m);
  Loop loop{{first}, {start.a_m}};
  Vector3d at = start.b_m;
  int last = first;
  while (loop.segments.size() <= longest) {
    const EndKey here = key_of(start.object, at);
    const std::vector<int>& met = ends.at(here);
    if (met.size() != 2) return std::nullopt;
    if (here == home) return loop.segments.size() < 3 ? std::nullopt : std::optional(loop);
    const int next = met[0] == last ? met[1] : met[0];
    if (next == last) return std::nullopt;
    const WorldSegment& s = world.segments[static_cast<std::size_t>(next)];
    loop.polygon_m.push_back(at);
    at = key_of(s.object, s.a_m) == here ? s.b_m : s.a_m;
    loop.segments.push_back(next);
    last = next;
  }
  return std::nullopt;
}

/// Points inside a loop, near its corners and in its middle; none if it is not plane.
std::vector<Vector3d> inside_of(const Loop& loop) {
  constexpr double plane_to_m = 1e-3, towards_corners = 0.97;
  const PolygonPlane plane = polygon_plane(loop.polygon_m);
  if (plane.normal.isZero()) return {};
  for (const Vector3d& x : loop.polygon_m) {
    if (std::abs(plane.normal.dot(x) - plane.distance_m) > plane_to_m) return {};
  }
  std::vector<Vector3d> points;
  for (const std::vector<int>& piece : convex_pieces(loop.polygon_m)) {
    Vector3d middle = Vector3d::Zero();
    for (const int k : piece) middle += loop.polygon_m[static_cast<std::size_t>(k)];
    middle /= static_cast<double>(piece.size());
    points.push_back(middle);
    for (const int k : piece) {
      const Vector3d& corner = loop.polygon_m[static_cast<std::size_t>(k)];
      points.push_back(middle + towards_corners * (corner - middle));
    }
  }
  return points;
}

std::vector<Vector3d> samples_of(const WorldSegment& s) {
  std::vector<Vector3d> points;
  for (const double t : {0.05, 0.3, 0.5, 0.7, 0.95}) points.push_back(s.a_m + t * (s.b_m - s.a_m));
  return points;
}

PaintedFigure stripe(const WorldSegment& s, const Vector3d& normal, double width, double factor) {
  const Vector3d side = normal.cross(s.b_m - s.a_m).normalized() * (width / 2);
  return {{s.a_m - side, s.b_m - side, s.b_m + side, s.a_m + side}, factor};
}

/// Numbers of segments within their objects, which are the same in all instances of a template.
std::vector<std::uint32_t> numbers_within_objects(const World& world) {
  std::vector<std::uint32_t> next(world.objects.size(), 0), numbers;
  numbers.reserve(world.segments.size());
  for (const WorldSegment& s : world.segments) {
    numbers.push_back(next[static_cast<std::size_t>(s.object)]++);
  }
  return numbers;
}

/// Draws what each segment is painted with.
class Paints {
 public:
  Paints(const World& world, const SurfaceAppearanceOptions& options)
      : world_(world), options_(options), numbers_(numbers_within_objects(world)) {}

  /// Darker or brighter by a relative step between the options' limits.
  double factor(int segment) const {
    RandomStream draws = stream(segment);
    const double step =
        options_.least_step + draws.uniform() * (options_.largest_step - options_.least_step);
    return draws.uniform() < 0.5 ? 1 - step : 1 / (1 - step);
  }

  double reflectance(int segment) const {
    const double u = stream(segment).uniform();
    return options_.least_reflectance +
           u * (options_.largest_reflectance - options_.least_reflectance);
  }

 private:
  RandomStream stream(int segment) const {
    const auto i = static_cast<std::size_t>(segment);
    const auto object = static_cast<std::size_t>(world_.segments[i].object);
    return RandomStream({options_.seed, numbers_[i],
                         template_key(world_.objects[object].template_name),
                         static_cast<std::uint32_t>(DrawSource::surface_appearance), 3, 0});
  }

  const World& world_;
  const SurfaceAppearanceOptions& options_;
  std::vector<std::uint32_t> numbers_;
};

/// Paints the loop that a segment begins, if it is one and has a surface behind it.
bool paint_loop(const World& world,
                const Ends& ends,
                const Backing& backing,
                const Paints& paints,
                int first,
                WirePaint& paint,
                std::vector<char>& done) {
  const std::optional<Loop> loop = loop_from(world, ends, first);
  if (!loop) return false;
  const std::vector<Vector3d> points = inside_of(*loop);
  if (points.empty() || !backing.behind(points, reach_m)) return false;
  for (const int i : loop->segments) {
    paint.of_segment[static_cast<std::size_t>(i)] = EdgeAppearance::outline;
    done[static_cast<std::size_t>(i)] = 1;
  }
  paint.figures.push_back({loop->polygon_m, paints.factor(first)});
  return true;
}

}  // namespace

std::string_view name(EdgeAppearance appearance) {
  constexpr std::array<std::string_view, appearance_count> names{"border", "outline", "line",
                                                                 "bar"};
  return names[static_cast<std::size_t>(appearance)];
}

WirePaint wire_paint(const World& world, const SurfaceAppearanceOptions& options) {
  check_appearance(options);
  const Backing backing(world);
  const Ends ends = ends_of(world);
  const Paints paints(world, options);
  const std::size_t n = world.segments.size();
  WirePaint paint;
  paint.of_segment.assign(n, EdgeAppearance::border);
  std::vector<char> done(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    done[i] = backing.borders(world.segments[i].a_m, world.segments[i].b_m) ? 1 : 0;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const int number = static_cast<int>(i);
    if (done[i] || paint_loop(world, ends, backing, paints, number, paint, done)) continue;
    const WorldSegment& s = world.segments[i];
    if (const auto normal = backing.behind(samples_of(s), reach_m)) {
      paint.of_segment[i] = EdgeAppearance::line;
      paint.figures.push_back(stripe(s, *normal, options.line_width_m, paints.factor(number)));
    } else {
      paint.of_segment[i] = EdgeAppearance::bar;
      paint.bars.push_back({s.a_m, s.b_m, number, paints.reflectance(number)});
    }
  }
  return paint;
}

}  // namespace vernier::sim::internal
