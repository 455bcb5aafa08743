// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/eliminated_boards.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "calib/base/ordered_parallel.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/estimate/held_parameters.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/frame_kernel.h"
#include "calib/solver/packed_views.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/solver/view_kernel.h"

namespace vernier::internal {
namespace {

constexpr std::size_t chunk_groups = 16;  // groups summed together: 128 frames

double sum(const Lanes& lanes) {
  const double* a = lanes.of;
  return ((a[0] + a[1]) + (a[2] + a[3])) + ((a[4] + a[5]) + (a[6] + a[7]));
}

/// Restores held components of a rotation vector exactly, not only to first order.
void put_back_held(const Rig& before, const std::vector<bool>& held, Rig& rig) {
  for (int c = 1; !held.empty() && c < static_cast<int>(rig.cameras.size()); ++c) {
    const auto i = static_cast<std::size_t>(pose_index(rig, c));
    if (!held[i] && !held[i + 1] && !held[i + 2]) continue;
    const Eigen::Vector3d old = vector_from_rotation(before.T_camera_first[c].R);
    Eigen::Vector3d r = vector_from_rotation(rig.T_camera_first[c].R);
    for (int k = 0; k < 3; ++k) r[k] = held[i + k] ? old[k] : r[k];
    rig.T_camera_first[c].R = held[i] && held[i + 1] && held[i + 2] ? before.T_camera_first[c].R
                                                                    : rotation_from_vector(r);
  }
}

}  // namespace

EliminatedBoards::EliminatedBoards(const PackedViews& views,
                                   const ReprojectionProblem& cost,
                                   std::vector<Lanes> pixels,
                                   int parameters,
                                   int threads)
    : views_(views),
      cost_(cost),
      pixels_(std::move(pixels)),
      parameters_(parameters),
      threads_(threads),
      factors_(views.groups().size() * frame_factor_size(parameters_)),
      chunks_((views.groups().size() + chunk_groups - 1) / chunk_groups, ReducedSums(parameters_)) {
}

void EliminatedBoards::sum_chunk(const BoardState& state,
                                 const std::vector<CameraTransform>& places,
                                 const std::vector<Eigen::VectorXd>& intrinsics,
                                 double damping,
                                 std::size_t chunk) {
  ReducedSums& total = chunks_[chunk];
  total = ReducedSums(parameters_);
  std::vector<std::vector<Lanes>> blocks;
  for (const Camera& camera : state.rig.cameras) {
    blocks.emplace_back(packed_size(view_columns(camera.model, views_.warp())));
  }
  std::vector<const double*> sums(places.size());
  const std::size_t end = std::min((chunk + 1) * chunk_groups, views_.groups().size());
  for (std::size_t g = chunk * chunk_groups; g < end; ++g) {
    const FrameGroup& group = views_.groups()[g];
    for (std::size_t c = 0; c < places.size(); ++c) {
      sums[c] = nullptr;
      if (group.cameras[c].corners == 0) continue;
      Lanes poses[12];
      camera_poses(state, static_cast<int>(c), group, poses);
      sum_views(views_.lanes(group, static_cast<int>(c), state, intrinsics[c].data(), poses[0].of,
                             pixels_),
                blocks[c][0].of);
      sums[c] = blocks[c][0].of;
    }
    Lanes absent;
    for (int l = 0; l < kernel_lanes; ++l) absent.of[l] = group.frames[l] < 0 ? 1 : 0;
    eliminate_frames(places, sums, absent, damping, &factors_[g * frame_factor_size(parameters_)],
                     total);
  }
}

Eigen::MatrixXd EliminatedBoards::kernel_by_step(const Rig& rig) const {
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(parameters_, parameters_);
  const int n = parameter_count(rig);
  M.topLeftCorner(n, n) = kernel_by_tangent(rig);
  return M;
}

ReducedSystem EliminatedBoards::reduced() const {
  const int n = parameters_;
  ReducedSystem system{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n),
                       Eigen::VectorXd::Zero(n)};
  for (const ReducedSums& part : chunks_) {  // in a fixed order, independent of the threads
    for (int i = 0; i < n; ++i) {
      for (int j = i; j < n; ++j) {
        system.information(j, i) += sum(part.information[packed_index(i, j, n)]);
      }
      system.gradient[i] += sum(part.gradient[i]);
      system.diagonal[i] += sum(part.diagonal[i]);
    }
    system.chi2 += sum(part.chi2);
    system.frames_drop += sum(part.frames_drop);
  }
  return system;
}

ReducedSystem EliminatedBoards::linearise(const BoardState& state, double damping) {
  const std::vector<CameraTransform> places = camera_transforms(state.rig, views_.warp());
  std::vector<Eigen::VectorXd> intrinsics;
  for (const Camera& camera : state.rig.cameras) intrinsics.push_back(kernel_intrinsics(camera));
  for_each_index(chunks_.size(), threads_,
                 [&](std::size_t chunk) { sum_chunk(state, places, intrinsics, damping, chunk); });
  ReducedSystem system = reduced();
  system.information.diagonal() += damping * system.diagonal;
  const Eigen::MatrixXd M = kernel_by_step(state.rig);
  const Eigen::MatrixXd S = system.information.selfadjointView<Eigen::Lower>();
  system.information = M.transpose() * S * M;
  system.gradient = M.transpose() * system.gradient;
  system.diagonal = M.cwiseAbs2().transpose() * system.diagonal;
  const int n = parameter_count(state.rig);
  for (const RigPrior& prior : cost_.priors) {
    const PriorOffset offset = prior_offset(prior, state.rig);
    const Eigen::MatrixXd pull = offset.by_rig.transpose() * prior.information;
    const Eigen::MatrixXd information = pull * offset.by_rig;
    system.information.topLeftCorner(n, n) += information;
    system.gradient.head(n) += pull * offset.delta;
    system.diagonal.head(n) += information.diagonal();
    system.chi2 += offset.delta.dot(prior.information * offset.delta);
  }
  return system;
}

Eigen::MatrixXd directions(const Rig& rig, const std::vector<bool>& held, int parameters) {
  if (held.empty()) return {};
  const Eigen::MatrixXd of_rig = free_directions(rig, held);
  const Eigen::Index warp = parameters - of_rig.rows();
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(parameters, of_rig.cols() + warp);
  E.topLeftCorner(of_rig.rows(), of_rig.cols()) = of_rig;
  E.bottomRightCorner(warp, warp).setIdentity();
  return E;
}

BoardState EliminatedBoards::moved(const BoardState& state, const Eigen::VectorXd& step) const {
  BoardState next = state;
  next.rig = retract(state.rig, step.head(parameter_count(state.rig)));
  put_back_held(state.rig, cost_.held, next.rig);
  if (views_.warp()) next.warp_m += step.tail<2>();
  const Eigen::VectorXd kernel_step = kernel_by_step(state.rig) * step;
  for (std::size_t g = 0; g < views_.groups().size(); ++g) {
    Lanes twists[6];
    frame_steps(&factors_[g * frame_factor_size(parameters_)], kernel_step, twists);
    for (int l = 0; l < kernel_lanes; ++l) {
      const int frame = views_.groups()[g].frames[l];
      if (frame < 0) continue;
      const auto at = [&](int k) { return twists[k].of[l]; };
      const Eigen::Matrix3d turn = rotation_from_vector({at(0), at(1), at(2)});
      Pose& T = next.T_first_board[frame];
      T = {turn * T.R, turn * T.t + Eigen::Vector3d(at(3), at(4), at(5))};
    }
  }
  return next;
}

}  // namespace vernier::internal
