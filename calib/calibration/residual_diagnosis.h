// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/rig_estimate.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// One thing found where residuals are larger than corner noise.
struct ResidualFinding {
  double share = 0;  ///< of Σ r² that it accounts for, in [0, 1]
  std::string text;  ///< what it is, with numbers, and what to do
};

struct ResidualDiagnosisOptions {
  std::vector<CornerOutlier> outliers;  ///< corners already left out
  int images_without_board = 0;         ///< images in which no board was found
  double min_share = 0.2;               ///< findings that account for less are not worth a word
};

/// Where the misfit of a solved calibration sits, the finding that accounts for most first:
///
///  - the lens: the same views solved with opencv5, opencv8 and fisheye4 (share 1 − Σr²/Σr₀²), with
///    the mean residual along the radius at the image's edge, which shows a wrong radial model;
///  - the board: solved with its warp free (calib/board/board_warp.h);
///  - time: two images of a frame that fit alone but not with one pose of the board;
///  - images, and cameras, that leave much more than the others;
///  - pixels or squares that are not square, images without a board, whole images left out.
///
/// Meant for calibrations whose rms is above a pixel: it solves again several times. `problem` is
/// that of the solution. Never throws for what the data are: a trial that fails is no finding.
std::vector<ResidualFinding> diagnose_residuals(const BoardObservations& observations,
                                                const BoardState& state,
                                                const ReprojectionProblem& problem,
                                                const ResidualDiagnosisOptions& options = {});

}  // namespace vernier::internal
