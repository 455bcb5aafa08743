// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>
#include <string>

#include "calib/error.h"
#include "sim/images/ray_scene.h"

namespace vernier::sim::internal {

struct RayScene::Tree {};

RayScene::RayScene(const Triangles&) {
  throw Error("images", "cannot be rendered, because Embree was missing when Vernier was built",
              "install Debian's libembree-dev and rebuild");
}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
void RayScene::nearest(const RayBundle&, BundleHits&) const {}
void RayScene::crossings(const RayBundle&,
                         const std::array<float, bundle_size>&,
                         BundleCrossings&) const {}
bool RayScene::blocked(const Eigen::Vector3f&, const Eigen::Vector3f&) const { return false; }

std::string embree_version() { return ""; }

}  // namespace vernier::sim::internal
