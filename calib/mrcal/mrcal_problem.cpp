// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/mrcal/mrcal_problem.h"

#include <algorithm>
#include <cstddef>

extern "C" {  // mrcal 2.2's header has no extern "C"
#include <mrcal/mrcal.h>
}
#include <cholmod.h>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/mrcal/board_grid.h"
#include "calib/mrcal/mrcal_parameters.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {

struct MrcalProblem::Layout {
  BoardGrid grid;
  mrcal_lensmodel_t lens{};
  int lens_parameters = 0, cameras = 0, frames = 0;
  Eigen::VectorXd state;
  std::vector<mrcal_observation_board_t> boards;
  std::vector<mrcal_point3_t> pool;  // x, y, weight; a negative weight marks an unobserved corner
  std::vector<int> image_sizes, frame_rows;
  mrcal_calobject_warp_t warp{};
  mrcal_problem_selections_t selections{};
  mrcal_problem_constants_t constants{};

  double* intrinsics() { return state.data(); }
  mrcal_pose_t* camera_poses() {
    return reinterpret_cast<mrcal_pose_t*>(state.data() + cameras * lens_parameters);
  }
  mrcal_pose_t* board_poses() { return camera_poses() + (cameras - 1); }
  int views() const { return static_cast<int>(boards.size()); }
  int rows() const { return 2 * views() * grid.points(); }

  void fill_rig(const Rig& rig);
  void fill_views(const BoardObservations& observations, const std::vector<int>& frame_numbers);
};

namespace {

void write_pose(const Pose& T, double* out) {
  Eigen::Map<Eigen::Vector3d>{out} = vector_from_rotation(T.R);
  Eigen::Map<Eigen::Vector3d>(out + 3) = T.t;
}

Pose read_pose(const double* in) {
  return {rotation_from_vector({in[0], in[1], in[2]}), {in[3], in[4], in[5]}};
}

}  // namespace

void MrcalProblem::Layout::fill_rig(const Rig& rig) {
  for (int c = 0; c < cameras; ++c) {
    const Camera& camera = rig.cameras[c];
    auto a = state.segment(c * lens_parameters, lens_parameters);
    a.setZero();
    a.head(camera.parameters.size()) = camera.parameters;
    a[0] = camera.f_px() * camera.ax();
    a[1] = camera.f_px();
    if (c > 0) write_pose(rig.T_camera_first[c], camera_poses()[c - 1].r.xyz);
    image_sizes.insert(image_sizes.end(), {camera.size_px.x(), camera.size_px.y()});
  }
}

void MrcalProblem::Layout::fill_views(const BoardObservations& observations,
                                      const std::vector<int>& frame_numbers) {
  const int points = grid.points();
  pool.assign(observations.views.size() * points, mrcal_point3_t{{0, 0, -1}});
  mrcal_point3_t* corners = pool.data();
  for (const BoardView& view : observations.views) {
    const auto frame = std::lower_bound(frame_numbers.begin(), frame_numbers.end(), view.frame);
    const auto index = static_cast<int>(frame - frame_numbers.begin());
    while (static_cast<int>(frame_rows.size()) <= index) frame_rows.push_back(rows());
    boards.push_back({{view.camera, view.camera - 1}, index});
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      corners[grid.cell[view.ids[i]]] = {{view.pixels_px[i].x(), view.pixels_px[i].y(), 1}};
    }
    corners += points;
  }
  while (static_cast<int>(frame_rows.size()) <= frames) frame_rows.push_back(rows());
}

MrcalProblem::MrcalProblem(const BoardObservations& observations, const BoardState& start)
    : layout_(std::make_unique<Layout>()) {
  Layout& p = *layout_;
  p.grid = board_grid(observations.target_m);
  const MrcalLens lens = mrcal_lens(start.rig);
  if (!mrcal_lensmodel_from_name(&p.lens, lens.name.c_str())) {
    throw Error("mrcal", "this version has no " + lens.name, "use mrcal 2.2");
  }
  p.lens_parameters = lens.parameters;
  p.cameras = static_cast<int>(start.rig.cameras.size());
  p.frames = static_cast<int>(start.frames.size());
  p.state.resize(p.cameras * p.lens_parameters + 6 * (p.cameras - 1 + p.frames));
  p.fill_rig(start.rig);
  for (int f = 0; f < p.frames; ++f) {
    const Pose& T = start.T_first_board[f];
    write_pose({T.R, T * p.grid.origin_m}, p.board_poses()[f].r.xyz);
  }
  p.fill_views(observations, start.frames);
  p.warp.x2 = start.warp_m.x();
  p.warp.y2 = start.warp_m.y();
  p.selections.do_optimize_intrinsics_core = true;
  p.selections.do_optimize_intrinsics_distortions = true;
  p.selections.do_optimize_extrinsics = true;
  p.selections.do_optimize_frames = true;
}

MrcalProblem::~MrcalProblem() = default;

Eigen::VectorXd& MrcalProblem::state() { return layout_->state; }

int MrcalProblem::rig_states() const {
  return layout_->cameras * layout_->lens_parameters + 6 * (layout_->cameras - 1);
}

const std::vector<int>& MrcalProblem::frame_rows() const { return layout_->frame_rows; }

Eigen::VectorXd MrcalProblem::packing_scales() const {
  const Layout& p = *layout_;
  Eigen::VectorXd scales = Eigen::VectorXd::Ones(p.state.size());
  mrcal_unpack_solver_state_vector(scales.data(), p.cameras, p.cameras - 1, p.frames, 0, 0,
                                   p.selections, &p.lens);
  return scales;
}

void MrcalProblem::optimise() {
  Layout& p = *layout_;
  const mrcal_stats_t stats = mrcal_optimize(
      nullptr, 0, nullptr, 0, p.intrinsics(), p.camera_poses(), p.board_poses(), nullptr, &p.warp,
      p.cameras, p.cameras - 1, p.frames, 0, 0, p.boards.data(), nullptr, p.views(), 0,
      p.pool.data(), &p.lens, p.image_sizes.data(), p.selections, &p.constants, p.grid.spacing_m,
      p.grid.columns, p.grid.rows, false, false);
  if (!(stats.rms_reproj_error__pixels >= 0)) {
    throw Error("mrcal", "mrcal_optimize did not converge", "leave mrcal out");
  }
}

MrcalEvaluation MrcalProblem::evaluate() const {
  Layout& p = *layout_;
  const int rows = p.rows(), states = static_cast<int>(p.state.size());
  // The buffer's size is mrcal's own count, which includes entries for unobserved corners.
  const int entries =
      _mrcal_num_j_nonzero(p.views(), 0, p.grid.columns, p.grid.rows, p.cameras, p.cameras - 1,
                           p.frames, 0, 0, p.boards.data(), nullptr, p.selections, &p.lens);
  MrcalEvaluation out;
  out.residual_px.resize(rows);
  out.row_start.resize(rows + 1);
  out.state.resize(entries);
  out.value.resize(entries);
  cholmod_sparse Jt{};
  Jt.nrow = states;
  Jt.ncol = rows;
  Jt.nzmax = entries;
  Jt.p = out.row_start.data();
  Jt.i = out.state.data();
  Jt.x = out.value.data();
  Jt.itype = CHOLMOD_INT;
  Jt.xtype = CHOLMOD_REAL;
  Jt.dtype = CHOLMOD_DOUBLE;
  Jt.sorted = Jt.packed = 1;
  Eigen::VectorXd packed(states);
  const auto bytes = [](const Eigen::VectorXd& v) { return static_cast<int>(8 * v.size()); };
  const bool good = mrcal_optimizer_callback(
      packed.data(), bytes(packed), out.residual_px.data(), bytes(out.residual_px), &Jt,
      p.intrinsics(), p.camera_poses(), p.board_poses(), nullptr, &p.warp, p.cameras, p.cameras - 1,
      p.frames, 0, 0, p.boards.data(), nullptr, p.views(), 0, p.pool.data(), &p.lens,
      p.image_sizes.data(), p.selections, &p.constants, p.grid.spacing_m, p.grid.columns,
      p.grid.rows, false);
  if (!good)
    throw Error("mrcal", "mrcal_optimizer_callback refused the problem", "leave mrcal out");
  const Eigen::VectorXd scales = packing_scales();
  for (int k = 0; k < out.row_start.back(); ++k) out.value[k] /= scales[out.state[k]];
  return out;
}

BoardState MrcalProblem::board_state(const BoardState& like) const {
  Layout& p = *layout_;
  BoardState out = like;
  for (int c = 0; c < p.cameras; ++c) {
    Eigen::VectorXd& a = out.rig.cameras[c].parameters;
    const auto b = p.state.segment(c * p.lens_parameters, p.lens_parameters);
    a = b.head(a.size());
    a[0] = b[1];
    a[1] = b[0] / b[1];
    if (c > 0) out.rig.T_camera_first[c] = read_pose(p.camera_poses()[c - 1].r.xyz);
  }
  for (int f = 0; f < p.frames; ++f) {
    const Pose T = read_pose(p.board_poses()[f].r.xyz);
    out.T_first_board[f] = {T.R, T.t - T.R * p.grid.origin_m};
  }
  return out;
}

bool mrcal_available() { return true; }

const char* mrcal_version() { return VERNIER_MRCAL_VERSION; }

}  // namespace vernier::internal
