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

/// Residual, as a share of the image's longer side, that a sound frame may leave at a rough start.
inline constexpr double sound_share = 0.006;

/// How the two images of a frame may have to be read to fit the others.
enum class PairReading {
  as_is,
  turned,    ///< one image's corners numbered from the other end: a half turn of the board
  exchanged  ///< each image is the other camera's
};

/// A frame as two cameras saw it.
struct ViewPair {
  BoardView first, second;             ///< as cameras 0 and 1
  Pose T_first_board, T_second_board;  ///< each by its image alone
  double alone_px = 0;                 ///< the larger residual (rms a coordinate) of the two
};

/// The frames that two cameras of a rig share and how well they agree on the pose between the two.
class PairConsensus {
 public:
  /// `shift` pairs the frame at position i of the first camera with i + shift of the second.
  PairConsensus(
      const BoardObservations& observations, const Rig& rig, int first, int second, int shift = 0);

  const std::vector<ViewPair>& pairs() const { return pairs_; }
  bool has_half_turn_ambiguity() const { return !half_turn_.empty(); }

  /// The two cameras with the pose T_second_first that most frames agree on when every frame is
  /// read so; the pose and both focal lengths improved on the better half of the frames.
  Rig agreed_rig(PairReading reading) const;

  /// Residual (rms a coordinate, pixels) of a frame, read so, with one board pose for both images.
  double together_px(std::size_t pair, PairReading reading, const Rig& rig) const;

  /// Whether that is no more than a sound frame leaves with a rough start: four times what each
  /// image leaves alone, or 0.6 % of the image's longer side.
  bool fits(std::size_t pair, double together_px) const;

  /// Whether no rough start can excuse it: more than 1.5 % of the image's longer side.
  bool is_gross_misfit(double together_px) const;

 private:
  struct Half {  ///< the frames that fit best, as a problem of their own
    BoardObservations observations;
    BoardState state;
    double sum_px2 = 0;
  };
  ViewPair read(const ViewPair& pair, PairReading reading) const;
  BoardPoseFit together(std::size_t pair, PairReading reading, const Rig& rig) const;
  Half best_subset(PairReading reading, const Rig& rig) const;
  static std::optional<Rig> improved(const Half& half, const std::vector<int>& free);
  double longest_px() const;

  const BoardObservations& observations_;
  std::vector<Camera> cameras_;
  std::vector<ViewPair> pairs_;
  std::vector<int> half_turn_;  ///< corner that takes a corner's place; empty without symmetry
  Pose T_board_turned_;
};

}  // namespace vernier::internal
