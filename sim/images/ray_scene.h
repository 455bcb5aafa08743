// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace vernier::sim::internal {

/// Triangles by the indices of their corners; metres, float, from a common origin near the scene.
struct Triangles {
  std::vector<Eigen::Vector3f> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> corners;
};

/// How many rays are traced together.
inline constexpr int bundle_size = 16;

/// Rays from one point. Directions need not have unit length; distances are in units of them. A ray
/// with a direction of NaN hits nothing.
struct RayBundle {
  Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();
  std::array<float, bundle_size> x{}, y{}, z{};  ///< directions
  int count = bundle_size;
};

inline constexpr std::uint32_t no_triangle = 0xFFFFFFFFU;

/// The nearest triangle of every ray.
struct BundleHits {
  std::array<std::uint32_t, bundle_size> triangle;  ///< no_triangle: none
  std::array<float, bundle_size> distance;
};

/// Where rays cross triangles that let them through. Those beyond the limit are not kept; they are
/// in no order, and one triangle may be there twice.
struct BundleCrossings {
  static constexpr int limit = 12;
  std::array<int, bundle_size> count;
  std::array<std::array<std::uint32_t, limit>, bundle_size> triangle;
  std::array<std::array<float, limit>, bundle_size> distance;
};

/// Triangles in a tree that rays are traced through: Embree 3 (Wald et al., "Embree: a kernel
/// framework for efficient CPU ray tracing", 2014), which is optional when Vernier is built, with
/// its robust flag: no ray passes between two triangles with a common edge. Single precision.
class RayScene {
 public:
  /// Throws Error that says what to install where Vernier was built without Embree.
  explicit RayScene(const Triangles& triangles);
  ~RayScene();
  RayScene(RayScene&&) noexcept;

  void nearest(const RayBundle& rays, BundleHits& hits) const;
  /// All crossings up to `farthest` of each ray.
  void crossings(const RayBundle& rays,
                 const std::array<float, bundle_size>& farthest,
                 BundleCrossings& found) const;
  /// Whether a triangle crosses the open line between two points.
  bool blocked(const Eigen::Vector3f& from_m, const Eigen::Vector3f& to_m) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Embree's version; empty where Vernier was built without it.
std::string embree_version();

}  // namespace vernier::sim::internal
