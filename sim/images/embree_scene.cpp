// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <string>

#include "calib/error.h"
#include "sim/images/ray_scene.h"

namespace vernier::sim::internal {
namespace {

/// One device for the process: what it costs to make one is 1 ms, and it starts no threads. It is
/// not limited to one thread here: Embree would limit all of TBB in the process, studies too.
RTCDevice device() {
  static RTCDevice shared = rtcNewDevice("threads=0");
  if (shared != nullptr) return shared;
  // Embree tells any failure of its own to start as one of no kind; memory is the usual one.
  if (rtcGetDeviceError(nullptr) != RTC_ERROR_UNSUPPORTED_CPU) throw std::bad_alloc();
  throw Error("images", "cannot be rendered: Embree does not start on this processor",
              "use a processor with SSE2");
}

/// The context of a query for crossings; the filter finds it behind Embree's own.
struct CrossingContext {
  RTCIntersectContext embree;
  BundleCrossings* found = nullptr;
};

/// Keeps a crossing and lets the ray pass.
void keep_crossing(const RTCFilterFunctionNArguments* at) {
  BundleCrossings& found = *reinterpret_cast<CrossingContext*>(at->context)->found;
  for (unsigned i = 0; i < at->N; ++i) {
    if (at->valid[i] != -1) continue;
    at->valid[i] = 0;
    const unsigned ray = RTCRayN_id(at->ray, at->N, i);
    int& n = found.count[ray];
    if (n == BundleCrossings::limit) continue;
    found.triangle[ray][n] = RTCHitN_primID(at->hit, at->N, i);
    found.distance[ray][n] = RTCRayN_tfar(at->ray, at->N, i);
    ++n;
  }
}

/// On the calling thread alone: who makes many scenes makes them at the same time.
void commit(RTCScene scene) {
  tbb::task_arena alone(1, 1);
  alone.execute([scene] { rtcCommitScene(scene); });
}

using Valid = std::array<int, bundle_size>;

void fill(const RayBundle& rays, RTCRayHit16& r, Valid& valid) {
  constexpr float all = std::numeric_limits<float>::infinity();
  for (int i = 0; i < bundle_size; ++i) {
    const bool used = i < rays.count && rays.x[i] == rays.x[i];
    valid[i] = used ? -1 : 0;
    r.ray.org_x[i] = rays.origin_m.x();
    r.ray.org_y[i] = rays.origin_m.y();
    r.ray.org_z[i] = rays.origin_m.z();
    r.ray.dir_x[i] = used ? rays.x[i] : 0;
    r.ray.dir_y[i] = used ? rays.y[i] : 0;
    r.ray.dir_z[i] = used ? rays.z[i] : 1;
    r.ray.tnear[i] = 0;
    r.ray.tfar[i] = all;
    r.ray.time[i] = 0;
    r.ray.mask[i] = ~0U;
    r.ray.id[i] = static_cast<unsigned>(i);
    r.ray.flags[i] = 0;
    r.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    r.hit.primID[i] = RTC_INVALID_GEOMETRY_ID;
    r.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
}

}  // namespace

struct RayScene::Tree {
  RTCScene scene = nullptr;
  bool empty = true;
  ~Tree() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }
};

RayScene::RayScene(const Triangles& triangles) : tree_(new Tree) {
  tree_->scene = rtcNewScene(device());
  rtcSetSceneFlags(
      tree_->scene,
      static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  rtcSetSceneBuildQuality(tree_->scene, RTC_BUILD_QUALITY_HIGH);
  tree_->empty = triangles.corners.empty();
  if (tree_->empty) return;
  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           3 * sizeof(float), triangles.vertices_m.size());
  void* corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(unsigned), triangles.corners.size());
  if (vertices == nullptr || corners == nullptr) {
    rtcReleaseGeometry(geometry);
    throw Error("images", "the world has more surfaces than fit in memory", "use a smaller world");
  }
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  std::memcpy(vertices, triangles.vertices_m.data(),
              triangles.vertices_m.size() * 3 * sizeof(float));
  std::memcpy(corners, triangles.corners.data(), triangles.corners.size() * 3 * sizeof(unsigned));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(tree_->scene, geometry);
  rtcReleaseGeometry(geometry);
  commit(tree_->scene);
}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;

void RayScene::nearest(const RayBundle& rays, BundleHits& hits) const {
  if (tree_->empty) {
    hits.triangle.fill(no_triangle);
    return;
  }
  alignas(64) RTCRayHit16 r;
  alignas(64) Valid valid;
  fill(rays, r, valid);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid.data(), tree_->scene, &context, &r);
  for (int i = 0; i < bundle_size; ++i) {
    hits.triangle[i] = r.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? no_triangle : r.hit.primID[i];
    hits.distance[i] = r.ray.tfar[i];
  }
}

void RayScene::crossings(const RayBundle& rays,
                         const std::array<float, bundle_size>& farthest,
                         BundleCrossings& found) const {
  found.count.fill(0);
  if (tree_->empty) return;
  alignas(64) RTCRayHit16 r;
  alignas(64) Valid valid;
  fill(rays, r, valid);
  for (int i = 0; i < bundle_size; ++i) r.ray.tfar[i] = farthest[i];
  CrossingContext context;
  rtcInitIntersectContext(&context.embree);
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  context.embree.filter = &keep_crossing;
  context.found = &found;
  rtcIntersect16(valid.data(), tree_->scene, &context.embree, &r);
}

bool RayScene::blocked(const Eigen::Vector3f& from_m, const Eigen::Vector3f& to_m) const {
  if (tree_->empty) return false;
  const Eigen::Vector3f along = to_m - from_m;
  RTCRay ray{};
  ray.org_x = from_m.x();
  ray.org_y = from_m.y();
  ray.org_z = from_m.z();
  ray.dir_x = along.x();
  ray.dir_y = along.y();
  ray.dir_z = along.z();
  ray.tfar = 1;
  ray.mask = ~0U;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(tree_->scene, &context, &ray);
  return ray.tfar < 0;
}

std::string embree_version() {
  return std::to_string(RTC_VERSION_MAJOR) + "." + std::to_string(RTC_VERSION_MINOR) + "." +
         std::to_string(RTC_VERSION_PATCH);
}

}  // namespace vernier::sim::internal
