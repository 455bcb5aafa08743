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

/// One cause found for residuals larger than corner noise.
struct ResidualFinding {
  double share = 0;  ///< fraction of Σ r² that it explains, in [0, 1]
  std::string text;  ///< cause, figures and remedy
  /// Another lens model explains nearly all: frames and boards need not be wrong.
  bool is_lens_alone = false;
};

struct ResidualDiagnosisOptions {
  std::vector<CornerOutlier> outliers;  ///< corners already excluded
  int images_without_board = 0;         ///< images in which no board was found
  double min_share = 0.2;               ///< findings that explain less are dropped
};

/// Locates the misfit of a solved calibration, largest cause first:
///
///  - the lens: the same views solved with opencv5, opencv8 and fisheye4 (fraction 1 − Σr²/Σr₀²,
///    both over the corners within the field of the model), with the mean residual along the radius
///    at the image's edge, which shows a wrong radial model;
///  - the board: solved with free warp (calib/board/board_warp.h);
///  - one change of a camera or lens during the session (calib/calibration/change_findings.h);
///  - time: two images of a frame that fit alone but not with one pose of the board;
///  - images, and cameras, with residuals much larger than the others';
///  - pixels or squares that are not square, images without a board, images excluded as a whole.
///
/// For calibrations with an rms above a pixel, since it solves several times. `problem` is that of
/// the solution. Does not throw because of the data: a trial that fails gives no finding.
std::vector<ResidualFinding> diagnose_residuals(const BoardObservations& observations,
                                                const BoardState& state,
                                                const ReprojectionProblem& problem,
                                                const ResidualDiagnosisOptions& options = {});

}  // namespace vernier::internal
