// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calib/board/board_pose.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {

/// Residual, as a fraction of the image's longer side, of a correct frame at an approximate start.
inline constexpr double sound_share = 0.006;

/// How to read the two images of a frame.
enum class PairReading {
  as_is,
  turned,    ///< one image's corners in reverse order: a half turn of the board
  exchanged  ///< each image is the other camera's
};

/// A frame seen by two cameras.
struct ViewPair {
  BoardView first, second;             ///< as cameras 0 and 1
  Pose T_first_board, T_second_board;  ///< each from its image alone
  double alone_px = 0;                 ///< the larger of the two residuals (rms per coordinate)
};

/// The frames common to two cameras of a rig, and their agreement on the pose between the two.
class PairConsensus {
 public:
  /// `shift` pairs the frame at index i of the first camera with i + shift of the second.
  PairConsensus(
      const BoardObservations& observations, const Rig& rig, int first, int second, int shift = 0);

  const std::vector<ViewPair>& pairs() const { return pairs_; }
  bool has_half_turn_ambiguity() const { return !half_turn_.empty(); }

  /// The two cameras with the pose T_second_first that most frames agree on under this reading; the
  /// pose and both focal lengths refined on the better half of the frames.
  Rig agreed_rig(PairReading reading) const;

  /// Residual (rms per coordinate, pixels) of a frame under this reading, with one board pose for
  /// both images.
  double together_px(std::size_t pair, PairReading reading, const Rig& rig) const;

  /// The same of the first image of one frame with the second image of another.
  double crossed_px(std::size_t first, std::size_t second, const Rig& rig) const;

  /// Whether the residual is at most that of a correct frame at an approximate start: four times
  /// that of each image alone, or 0.6 % of the image's longer side.
  bool fits(std::size_t pair, double together_px) const;
  bool fits(const ViewPair& pair, double together_px) const;

  /// Whether the residual is too large for an approximate start: more than 1.5 % of the image's
  /// longer side.
  bool is_gross_misfit(double together_px) const;

 private:
  struct Half {  ///< the best-fitting half of the frames, as a problem
    BoardObservations observations;
    BoardState state;
    double sum_px2 = 0;
  };
  ViewPair read(const ViewPair& pair, PairReading reading) const;
  BoardPoseFit together(std::size_t pair, PairReading reading, const Rig& rig) const;
  BoardPoseFit together(const ViewPair& pair, const Rig& rig) const;
  Half best_subset(PairReading reading, const Rig& rig) const;
  static std::optional<Rig> improved(const Half& half, const std::vector<int>& free);
  double longest_px() const;

  const BoardObservations& observations_;
  std::vector<Camera> cameras_;
  std::vector<ViewPair> pairs_;
  std::vector<int> half_turn_;  ///< corner that replaces each corner; empty without symmetry
  Pose T_board_turned_;
};

}  // namespace vernier::internal
