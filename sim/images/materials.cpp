// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/materials.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "calib/base/fingerprint.h"
#include "calib/error.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/images/surface_appearance.h"
#include "sim/images/texture.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace vernier::internal;
using Eigen::Vector3d;

namespace {

constexpr auto appearance_draws = static_cast<std::uint32_t>(DrawSource::surface_appearance);

/// An object and a plane, to a millimetre; a normal and its opposite are the same. The offset keeps
/// what lies on the 0.1 mm grid of world files away from where rounding changes.
using PlaneKey = std::array<std::int64_t, 5>;

PlaneKey key_of(std::int32_t object, const PolygonPlane& plane) {
  constexpr double grid = 1000, offset = 3.7e-5;
  Vector3d n = plane.normal;
  double d = plane.distance_m;
  Eigen::Index axis = 0;
  n.cwiseAbs().maxCoeff(&axis);
  if (n[axis] < 0) {
    n = -n;
    d = -d;
  }
  const auto rounded = [](double x) { return std::llround(grid * (x + offset)); };
  return {object, rounded(n.x()), rounded(n.y()), rounded(n.z()), rounded(d)};
}

/// Reflectance of a plane of a template: the template's own, varied by up to a fifth.
double reflectance_of(std::uint32_t key, std::uint32_t plane, const SurfaceAppearanceOptions& o) {
  const auto draw = [&](std::uint32_t trial) {
    return RandomStream({o.seed, trial, key, appearance_draws, 0, 0}).uniform();
  };
  constexpr std::uint32_t whole = 0xFFFFFFFFU;  // the plane of the template as such
  const double base =
      o.least_reflectance + draw(whole) * (o.largest_reflectance - o.least_reflectance);
  return std::clamp(base * (0.8 + 0.4 * draw(plane)), o.least_reflectance, o.largest_reflectance);
}

double loose_reflectance(std::uint32_t plane, const SurfaceAppearanceOptions& o) {
  RandomStream draws({o.seed, plane, 0, appearance_draws, 2, 0});
  return draws.uniform(o.least_reflectance, o.largest_reflectance + 1e-12);
}

}  // namespace

void check_appearance(const SurfaceAppearanceOptions& o) {
  const auto require = [](bool fine, const char* fault, const char* remedy) {
    if (!fine) throw Error("appearance", fault, remedy);
  };
  require(o.least_reflectance > 0 && o.largest_reflectance < 1 &&
              o.least_reflectance <= o.largest_reflectance,
          "the reflectances are not in (0, 1), the least first", "use 0.25 and 0.85, say");
  require(o.texture_contrast >= 0 && o.texture_contrast <= 0.3,
          "the texture's contrast is not in [0, 0.3]", "use 0.02, say");
  require(o.texture_scale_m >= 1e-3 && o.texture_scale_m <= 100,
          "the texture's scale is not from 1 mm to 100 m", "use 0.1 m, say");
  require(o.least_step >= 0 && o.largest_step < 1 && o.least_step <= o.largest_step,
          "the steps of what is painted are not in [0, 1), the least first",
          "use 0.1 and 0.5, say");
  require(o.line_width_m >= 1e-4 && o.line_width_m <= 0.1,
          "the width of lines is not from 0.1 mm to 10 cm", "use 0.012 m, say");
}

std::uint32_t template_key(const std::string& template_name) {
  constexpr int hexadecimal = 16;
  return static_cast<std::uint32_t>(std::stoull(fingerprint(template_name), nullptr, hexadecimal));
}

void plane_axes(const Vector3d& normal, Vector3d& across, Vector3d& up) {
  constexpr double nearly_level = 0.999;
  const bool level = std::abs(normal.z()) > nearly_level;
  across = level ? Vector3d(0, 1, 0).cross(normal).normalized()
                 : Vector3d(0, 0, 1).cross(normal).normalized();
  up = normal.cross(across);
}

Materials materials(const World& world, const SurfaceAppearanceOptions& options) {
  check_appearance(options);
  Materials all;
  std::map<PlaneKey, int> known;
  std::vector<std::uint32_t> planes(world.objects.size(), 0);
  for (const WorldSurface& surface : world.surfaces) {
    const PolygonPlane plane = polygon_plane(surface.polygon_m);
    const auto [place, is_new] =
        known.emplace(key_of(surface.object, plane), static_cast<int>(all.list.size()));
    all.of_surface.push_back(place->second);
    if (!is_new) continue;
    const std::uint32_t number = planes[static_cast<std::size_t>(surface.object)]++;
    const std::string& name = world.objects[static_cast<std::size_t>(surface.object)].template_name;
    RandomStream draws(
        {options.seed, number, static_cast<std::uint32_t>(surface.object), appearance_draws, 1, 0});
    Material material{name.empty() ? loose_reflectance(number, options)
                                   : reflectance_of(template_key(name), number, options),
                      options.texture_contrast,
                      Texture(options.texture_scale_m, draws),
                      {},
                      {}};
    plane_axes(plane.normal, material.across, material.up);
    all.list.push_back(material);
  }
  return all;
}

}  // namespace vernier::sim::internal
