// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/image_scene.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "calib/error.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/images/lighting.h"
#include "sim/images/materials.h"
#include "sim/images/ray_scene.h"
#include "sim/images/surface_appearance.h"
#include "sim/images/texture.h"
#include "sim/images/wire_paint.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace vernier::internal;
using Eigen::Vector3d;

namespace {

using Polygon = std::vector<Vector3d>;

/// Triangles of polygons, and which polygon each belongs to.
struct SceneMesh {
  Triangles triangles;
  std::vector<int> owner;

  void add(const Polygon& polygon, int number, const Vector3d& middle) {
    const auto first = static_cast<std::uint32_t>(triangles.vertices_m.size());
    for (const Vector3d& x : polygon) triangles.vertices_m.push_back((x - middle).cast<float>());
    for (const std::vector<int>& piece : convex_pieces(polygon)) {
      for (std::size_t k = 1; k + 1 < piece.size(); ++k) {
        const auto corner = [&](std::size_t i) {
          return first + static_cast<std::uint32_t>(piece[i]);
        };
        triangles.corners.push_back({corner(0), corner(k), corner(k + 1)});
        owner.push_back(number);
      }
    }
  }
};

/// The four long sides of a bar.
std::array<Polygon, 4> sides_of(const WireBar& bar, double width) {
  const Vector3d along = (bar.b_m - bar.a_m).normalized();
  Vector3d u, v;
  plane_axes(along, u, v);
  u *= width / 2;
  v *= width / 2;
  const std::array<Vector3d, 4> corners{u + v, v - u, -u - v, u - v};
  std::array<Polygon, 4> sides;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Vector3d &p = corners[k], &q = corners[(k + 1) % sides.size()];
    sides[k] = {bar.a_m + p, bar.b_m + p, bar.b_m + q, bar.a_m + q};
  }
  return sides;
}

/// The plain material of a bar; its texture is not seen.
Material material_of(const WireBar& bar, const SurfaceAppearanceOptions& options) {
  RandomStream draws({options.seed, 0, static_cast<std::uint32_t>(bar.segment),
                      static_cast<std::uint32_t>(DrawSource::surface_appearance), 1, 1});
  return {bar.reflectance, 0, Texture(options.texture_scale_m, draws), Vector3d::UnitX(),
          Vector3d::UnitY()};
}

double area_of(const Polygon& polygon, const Vector3d& normal) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    sum += (polygon[k] - polygon[0]).cross(polygon[k + 1] - polygon[0]);
  }
  return std::abs(sum.dot(normal)) / 2;
}

std::vector<int> lamps_near(const Polygon& polygon,
                            const std::vector<Vector3d>& lamps,
                            double reach) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& x : polygon) box.extend(x);
  std::vector<int> near;
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    if (box.squaredExteriorDistance(lamps[i]) < reach * reach) near.push_back(static_cast<int>(i));
  }
  return near;
}

Vector3d middle_of(const World& world) {
  Eigen::AlignedBox3d box;
  for (const WorldSurface& surface : world.surfaces) {
    for (const Vector3d& x : surface.polygon_m) box.extend(x);
  }
  return box.center();
}

/// Collects the solid faces of a world.
class Solids {
 public:
  Solids(const std::vector<Vector3d>& lamps, const Vector3d& middle, double reach)
      : lamps_(lamps), middle_(middle), reach_(reach) {}

  void add(const Polygon& polygon, int material) {
    const PolygonPlane plane = polygon_plane(polygon);
    mesh.add(polygon, static_cast<int>(faces.size()), middle_);
    faces.push_back(
        {plane.normal, plane.distance_m, material, lamps_near(polygon, lamps_, reach_)});
  }

  SceneMesh mesh;
  std::vector<SolidFace> faces;

 private:
  const std::vector<Vector3d>& lamps_;
  Vector3d middle_;
  double reach_;
};

}  // namespace

ImageScene image_scene(const World& world, const ImageSceneOptions& options) {
  check_appearance(options.appearance);
  check_lighting(options.lighting);
  if (world.surfaces.empty()) {
    throw Error("images",
                "the world '" + world.name + "' has no surfaces: nothing in it can be seen",
                "use a world with surfaces (vernier world info counts them)");
  }
  const Vector3d middle = middle_of(world);
  std::vector<Vector3d> lamps = lamps_of(world, options.lighting);
  Materials all = materials(world, options.appearance);
  WirePaint wires = wire_paint(world, options.appearance);
  Solids solids(lamps, middle, options.lighting.lamp_reach_m);
  for (std::size_t i = 0; i < world.surfaces.size(); ++i) {
    solids.add(world.surfaces[i].polygon_m, all.of_surface[i]);
  }
  for (const WireBar& bar : wires.bars) {
    const int material = static_cast<int>(all.list.size());
    all.list.push_back(material_of(bar, options.appearance));
    for (const Polygon& side : sides_of(bar, options.appearance.line_width_m))
      solids.add(side, material);
  }
  SceneMesh paint;
  std::vector<PaintPlane> figures;
  for (const PaintedFigure& figure : wires.figures) {
    const PolygonPlane plane = polygon_plane(figure.polygon_m);
    paint.add(figure.polygon_m, static_cast<int>(figures.size()), middle);
    figures.push_back(
        {plane.normal, plane.distance_m, figure.factor, area_of(figure.polygon_m, plane.normal)});
  }
  return {middle,
          RayScene(solids.mesh.triangles),
          RayScene(paint.triangles),
          std::move(solids.mesh.owner),
          std::move(paint.owner),
          std::move(solids.faces),
          std::move(figures),
          std::move(all.list),
          std::move(lamps),
          options.lighting,
          std::move(wires.of_segment)};
}

}  // namespace vernier::sim::internal
