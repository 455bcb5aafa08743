// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/images/lighting.h"
#include "sim/images/materials.h"
#include "sim/images/ray_scene.h"
#include "sim/images/surface_appearance.h"
#include "sim/images/wire_paint.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// A surface of the world, or a face of a bar.
struct SolidFace {
  Eigen::Vector3d normal;  ///< unit, plane normal · x = distance, world frame
  double distance_m = 0;
  int material = 0;
  std::vector<int> lamps;  ///< that reach it
};

/// The plane of a painted figure.
struct PaintPlane {
  Eigen::Vector3d normal;
  double distance_m = 0;
  double factor = 1;
  double area_m2 = 0;
};

/// A world prepared for rendering: its surfaces and bars in one tree, what is painted in another.
/// Trees are single precision about the middle of the world; planes are double.
struct ImageScene {
  Eigen::Vector3d middle_m;
  RayScene solids, paint;
  std::vector<int> face_of_triangle, figure_of_triangle;
  std::vector<SolidFace> faces;
  std::vector<PaintPlane> figures;
  std::vector<Material> materials;
  std::vector<Eigen::Vector3d> lamps_m;
  LightingOptions lighting;
  std::vector<EdgeAppearance> segments;  ///< how each segment of the world is shown
};

struct ImageSceneOptions {
  SurfaceAppearanceOptions appearance;
  LightingOptions lighting;
};

/// Throws Error for a world without surfaces, options out of range, and where Embree is missing.
ImageScene image_scene(const World& world, const ImageSceneOptions& options = {});

}  // namespace vernier::sim::internal
