// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/world.h"

namespace vernier::sim::internal {

enum class BuildingKind { office, home, hall, corridors };

/// "office", "home", "hall", "corridors".
std::string_view name_of(BuildingKind kind);

/// None for a name of no kind.
std::optional<BuildingKind> building_kind(std::string_view name);

/// A floor of one kind, or of several parts side by side along x.
struct BuildingOptions {
  std::vector<BuildingKind> kinds{BuildingKind::office};
  /// Length, width and height of the whole; by default what suits each kind, and the largest width
  /// and height among them.
  std::optional<Eigen::Vector3d> size_m;
};

/// Generates a floor from a seed. Its parts have equal lengths, the same width and height, walls of
/// 0.1 m between them and a doorway in the middle of each such wall. Halls need 4.5 m of height,
/// and so do buildings that hold one. The first part has the draws of a building of its kind alone;
/// the same seed and options give the same description to the bit. Throws Error for no kind, and
/// for a size that does not suit one of the parts.
WorldDescription make_building(std::uint64_t seed, const BuildingOptions& options = {});

}  // namespace vernier::sim::internal
