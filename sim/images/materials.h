// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/images/surface_appearance.h"
#include "sim/images/texture.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// A painted plane: mean reflectance, and a texture in coordinates (x · across, x · up) of the
/// object's plane.
struct Material {
  double reflectance = 0.5;
  double texture_contrast = 0;
  Texture texture;
  Eigen::Vector3d across, up;  ///< unit, in the plane, world frame
};

/// Materials of all surfaces of a world. Surfaces of one object that lie in one plane share one, so
/// that no seam shows; the mean reflectance is that of the template and plane, the same for all
/// instances, and the texture has phases of its own for each object. Loose surfaces have a material
/// a plane. Draws: counter (plane within the object, template's name) for reflectances and (plane,
/// object) for textures, source `surface_appearance`, eyes 0 and 1.
struct Materials {
  std::vector<Material> list;
  std::vector<int> of_surface;  ///< index into the list, one per surface of the world
};
Materials materials(const World& world, const SurfaceAppearanceOptions& options);

/// Key of what is drawn for all instances of a template: 32 bits of its name's hash.
std::uint32_t template_key(const std::string& template_name);

/// Axes in a plane: `across` is level, where the plane is not.
void plane_axes(const Eigen::Vector3d& normal, Eigen::Vector3d& across, Eigen::Vector3d& up);

}  // namespace vernier::sim::internal
