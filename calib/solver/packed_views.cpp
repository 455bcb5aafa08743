// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/packed_views.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>

#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/solver/frame_kernel.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/solver/view_kernel.h"

namespace vernier::internal {
namespace {

/// View of every (frame, camera), -1 for none, and the frames in the order of their corner counts.
struct FrameTable {
  std::vector<std::vector<int>> views;
  std::vector<int> order;

  FrameTable(const BoardObservations& observations, const BoardState& state) {
    const std::size_t cameras = state.rig.cameras.size();
    views.assign(state.frames.size(), std::vector<int>(cameras, -1));
    std::vector<std::vector<std::size_t>> counts(state.frames.size(),
                                                 std::vector<std::size_t>(cameras, 0));
    std::size_t frame = 0;
    for (std::size_t v = 0; v < observations.views.size(); ++v) {
      const BoardView& view = observations.views[v];
      while (frame < state.frames.size() && state.frames[frame] != view.frame) ++frame;
      if (frame == state.frames.size() || view.camera >= static_cast<int>(cameras) ||
          view.ids.size() != view.pixels_px.size()) {
        throw Error("frame " + std::to_string(view.frame),
                    "the state has no such frame or camera, or a corner has no pixel",
                    "give observations as check_and_sort leaves them and a state made for them");
      }
      views[frame][view.camera] = static_cast<int>(v);
      counts[frame][view.camera] = view.ids.size();
    }
    order.resize(state.frames.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return counts[a] > counts[b]; });
  }
};

double root_weight(const ReprojectionProblem& problem, int view, int corner) {
  const double w = problem.corner_weights.empty() ? 1 : problem.corner_weights[view][corner];
  return std::sqrt(w) / problem.pixel_sigma_px;
}

}  // namespace

PackedViews::PackedViews(const BoardObservations& observations,
                         const BoardState& state,
                         const ReprojectionProblem& problem)
    : warp_(problem.warp == BoardWarp::free) {
  const FrameTable table(observations, state);
  const auto target =
      warp_ ? observations.target_m : warped_target(observations.target_m, state.warp_m);
  const auto shapes = warp_shapes(observations.target_m);
  const std::size_t stride = target_stride(warp_) / kernel_lanes;

  std::vector<std::size_t> first_corner(1, 0);  // of every view
  for (const BoardView& view : observations.views) {
    first_corner.push_back(first_corner.back() + view.ids.size());
  }
  slots_.resize(first_corner.back());
  std::size_t row = 0;
  for (std::size_t begin = 0; begin < table.order.size(); begin += kernel_lanes) {
    FrameGroup group;
    group.frames.fill(-1);
    const std::size_t count = std::min<std::size_t>(kernel_lanes, table.order.size() - begin);
    for (std::size_t l = 0; l < count; ++l) group.frames[l] = table.order[begin + l];
    group.cameras.resize(state.rig.cameras.size());
    for (std::size_t c = 0; c < group.cameras.size(); ++c) {
      FrameGroup::Seen& seen = group.cameras[c];
      seen.views.fill(-1);
      seen.first = row;
      for (std::size_t l = 0; l < count; ++l) {
        seen.views[l] = table.views[group.frames[l]][c];
        if (seen.views[l] < 0) continue;
        const auto n = static_cast<int>(observations.views[seen.views[l]].ids.size());
        seen.corners = std::max(seen.corners, n);
      }
      row += seen.corners;
      target_.resize(row * stride);
      for (int l = 0; l < kernel_lanes; ++l) {
        const BoardView* view = seen.views[l] < 0 ? nullptr : &observations.views[seen.views[l]];
        for (int k = 0; k < seen.corners; ++k) {
          const bool real = view && k < static_cast<int>(view->ids.size());
          const int id = real ? view->ids[k] : 0;
          Lanes* at = &target_[(seen.first + k) * stride];
          for (int axis = 0; axis < 3; ++axis) at[axis].of[l] = target[id][axis];
          at[3].of[l] = real ? root_weight(problem, seen.views[l], k) : 0;
          for (int s = 0; warp_ && s < 2; ++s) at[4 + s].of[l] = shapes(id, s);
          if (real) slots_[first_corner[seen.views[l]] + k] = {seen.first + k, l};
        }
      }
    }
    groups_.push_back(std::move(group));
  }
}

std::vector<Lanes> PackedViews::pack(const Eigen::Matrix2Xd& pixels_px) const {
  if (pixels_px.cols() != static_cast<Eigen::Index>(slots_.size())) {
    throw Error("pixels",
                "there are " + std::to_string(pixels_px.cols()) + " for " +
                    std::to_string(slots_.size()) + " corners",
                "give one per corner, in the order of the observations");
  }
  if (!pixels_px.allFinite()) {
    Eigen::Index bad = 0;
    while (pixels_px.col(bad).allFinite()) ++bad;
    throw Error("corner " + std::to_string(bad), "its pixel is not finite", "leave the corner out");
  }
  const std::size_t rows = target_.size() / (target_stride(warp_) / kernel_lanes);
  std::vector<Lanes> packed(2 * rows);
  const double* from = pixels_px.data();
  for (const auto& [row, lane] : slots_) {
    packed[2 * row].of[lane] = *from++;
    packed[2 * row + 1].of[lane] = *from++;
  }
  return packed;
}

Eigen::Matrix2Xd PackedViews::observed_px(const BoardObservations& observations) const {
  Eigen::Matrix2Xd pixels(2, static_cast<Eigen::Index>(slots_.size()));
  Eigen::Index i = 0;
  for (const BoardView& view : observations.views) {
    for (const Eigen::Vector2d& q : view.pixels_px) pixels.col(i++) = q;
  }
  return pixels;
}

ViewLanes PackedViews::lanes(const FrameGroup& group,
                             int camera,
                             const BoardState& state,
                             const double* intrinsics,
                             const double* pose,
                             const std::vector<Lanes>& pixels) const {
  const FrameGroup::Seen& seen = group.cameras[camera];
  const std::size_t stride = target_stride(warp_) / kernel_lanes;
  ViewLanes lanes;
  lanes.model = &state.rig.cameras[camera].model;
  lanes.intrinsics = intrinsics;
  lanes.pose = pose;
  lanes.target = target_[seen.first * stride].of;
  lanes.pixels = pixels[2 * seen.first].of;
  lanes.corners = seen.corners;
  lanes.warp = warp_;
  for (int i = 0; i < 2; ++i) lanes.warp_m[i] = warp_ ? state.warp_m[i] : 0;
  return lanes;
}

void camera_poses(const BoardState& state,
                  int camera,
                  const FrameGroup& group,
                  Lanes (&poses)[12]) {
  for (int l = 0; l < kernel_lanes; ++l) {
    const int frame = group.frames[l] < 0 ? group.frames[0] : group.frames[l];
    const Pose T = state.rig.T_camera_first[camera] * state.T_first_board[frame];
    for (int i = 0; i < 9; ++i) poses[i].of[l] = T.R(i / 3, i % 3);
    for (int i = 0; i < 3; ++i) poses[9 + i].of[l] = T.t[i];
  }
}

Eigen::VectorXd kernel_intrinsics(const Camera& camera) {
  Eigen::VectorXd a = camera.parameters;
  a[0] = camera.f_px() * camera.ax();
  a[1] = camera.f_px();
  a[2] = camera.ox_px();
  a[3] = camera.oy_px();
  return a;
}

Eigen::MatrixXd kernel_by_tangent(const Rig& rig) {
  const int n = parameter_count(rig);
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(n, n);
  for (int c = 0; c < static_cast<int>(rig.cameras.size()); ++c) {
    const Camera& camera = rig.cameras[c];
    M.block<2, 2>(intrinsics_index(rig, c), intrinsics_index(rig, c)) << camera.ax(), camera.f_px(),
        1, 0;
    if (c > 0) {  // v = dt + t x w
      M.block<3, 3>(pose_index(rig, c) + 3, pose_index(rig, c)) = hat(rig.T_camera_first[c].t);
    }
  }
  return M;
}

}  // namespace vernier::internal
