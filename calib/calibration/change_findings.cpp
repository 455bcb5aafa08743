// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/change_findings.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/frame_scatter.h"
#include "calib/calibration/residual_diagnosis.h"
#include "calib/error.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {
namespace {

constexpr double least_split_share = 0.25, least_scatter_share = 0.5, least_bend_share = 0.5;
constexpr double least_f = 20;
// of what a change in every frame explains; where that is in the cost, few frames come near by
// chance
constexpr double one_change = 0.65, one_change_beside_motion = 0.95;

std::string camera_words(const Rig& rig, int camera) {
  return fmt::format("camera {} (\"{}\")", camera,
                     rig.cameras[static_cast<std::size_t>(camera)].name);
}

std::string part_words(const FrameScatter& change, const Rig& rig) {
  return (change.kept == Kept::pose ? "pose of " : "lens of ") + camera_words(rig, change.camera);
}

ResidualFinding split_finding(const FrameScatter& split, const Rig& rig) {
  return {
      split.share,
      fmt::format("the rig changed after frame {}: another {} from there on explains {:.0f} % of "
                  "the squared residuals (its images are off by {:.1f} px rms): a camera moved, a "
                  "lens was turned, zoomed or refocused, images were cropped, or the frames are "
                  "of two rigs; calibrate the frames before and after separately",
                  split.last_frame, part_words(split, rig), 100 * split.share, split.shift_px)};
}

ResidualFinding scatter_finding(const FrameScatter& scatter, const Rig& rig) {
  const std::string camera = camera_words(rig, scatter.camera);
  if (scatter.kept == Kept::lens) {
    return {scatter.share,
            fmt::format("the lens of {} is not the same in all frames: its focal length and centre "
                        "vary (by {:.1f} px rms; {:.0f} % of the squared residuals, most in frame "
                        "{}): switch off autofocus, zoom and image stabilisation",
                        camera, scatter.shift_px, 100 * scatter.share, scatter.worst_frame)};
  }
  return {scatter.share,
          fmt::format(
              "the images of a frame do not belong together: those of {} are off against the "
              "others' by {:.1f} px rms, another way in each frame ({:.0f} % of the squared "
              "residuals, most in frame {}): the cameras are not simultaneous while the board "
              "or the rig moves, or they moved relative to each other; hold the board still, "
              "trigger the cameras at once, fix them to each other, or estimate its motion with "
              "--motion",
              camera, scatter.shift_px, 100 * scatter.share, scatter.worst_frame)};
}

/// The changes that explain most, where they explain far more than chance does.
struct BestChanges {
  const FrameScatter* split = nullptr;
  const FrameScatter* scatter = nullptr;
};

BestChanges best_changes(const std::vector<FrameScatter>& all) {
  BestChanges found;
  for (const FrameScatter& s : all) {
    if (!(s.f_ratio >= least_f)) continue;
    const FrameScatter*& best = s.is_split ? found.split : found.scatter;
    if (!best || s.share > best->share) best = &s;
  }
  return found;
}

}  // namespace

std::optional<ResidualFinding> change_finding(const BoardObservations& observations,
                                              const BoardState& state,
                                              bool motion_is_estimated) {
  std::vector<FrameScatter> all;
  try {
    all = frame_scatter(observations, state);
  } catch (const Error&) {  // a view determines no pose: other checks name it
    return {};
  }
  const auto [split, scatter] = best_changes(all);
  if (split && split->share >= least_split_share) {
    const bool beside_motion = motion_is_estimated && split->kept == Kept::pose;
    const double enough = beside_motion ? one_change_beside_motion : one_change;
    if (!scatter || split->share >= enough * scatter->share)
      return split_finding(*split, state.rig);
  }
  if (!scatter || scatter->share < least_scatter_share) return {};
  if (motion_is_estimated && scatter->kept == Kept::pose) return {};
  return scatter_finding(*scatter, state.rig);
}

std::optional<PairChange> change_finding(const PairObservations& inliers, const Rig& rig) {
  const std::vector<FrameScatter> all = frame_scatter(inliers, rig);
  const auto [split, scatter] = best_changes(all);
  if (split && split->share >= least_split_share &&
      (!scatter || split->share >= one_change * scatter->share)) {
    return PairChange{
        split->shift_px,
        fmt::format("the rig changed after image pair {}: another {} from there on explains "
                    "{:.0f} % of the squared residuals (its matches are off by {:.1f} px rms): a "
                    "camera moved, a lens was turned, zoomed or refocused, images were cropped, or "
                    "the image pairs are of two rigs; calibrate those before and after separately",
                    split->last_frame, part_words(*split, rig), 100 * split->share,
                    split->shift_px)};
  }
  if (!scatter || scatter->share < least_scatter_share) return {};
  return PairChange{
      scatter->shift_px,
      fmt::format("the rig is not the same in all image pairs: another {} in each explains {:.0f} "
                  "% of the squared residuals (matches are off by {:.1f} px rms, most in image "
                  "pair {}): the cameras are not simultaneous while the rig or the scene moves, "
                  "they move relative to each other, or a lens changes; trigger the cameras at "
                  "once, fix them to each other, and switch off autofocus and stabilisation",
                  part_words(*scatter, rig), 100 * scatter->share, scatter->shift_px,
                  scatter->worst_frame)};
}

std::optional<ResidualFinding> bent_board_finding(const BoardObservations& observations,
                                                  const BoardState& state) {
  try {
    const ReducedNormalEquations equations = equations_with_warp(observations, state, 1);
    const auto p = equations.information.rows() - 2;
    const Eigen::VectorXd g = equations.scores.rowwise().sum().tail<2>();
    const Eigen::MatrixXd cross = equations.information.topRightCorner(p, 2);
    const Eigen::MatrixXd rig = equations.information.topLeftCorner(p, p);
    const Eigen::MatrixXd A = equations.information.bottomRightCorner(2, 2) -
                              cross.transpose() * solve_symmetric(rig, cross);
    const Eigen::VectorXd warp_m = -solve_symmetric(A, g);
    const double share = -g.dot(warp_m) / equations.chi2;
    if (!(share >= least_bend_share && share <= 1.05)) return {};
    return ResidualFinding{
        std::min(1.0, share),
        fmt::format(
            "{}a warp of {:.2g} mm in x and {:.2g} mm in y explains "
            "{:.0f} % of the squared residuals; use a stiff board, or estimate its shape with "
            "--board-shape",
            bent_board_doubt, 1e3 * warp_m.x(), 1e3 * warp_m.y(), 100 * std::min(1.0, share))};
  } catch (const Error&) {
    return {};
  }
}

}  // namespace vernier::internal
