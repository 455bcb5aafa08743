// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Replaces calib/mrcal/mrcal_problem.cpp if libmrcal was not found.
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/error.h"
#include "calib/mrcal/mrcal_problem.h"

namespace vernier::internal {

struct MrcalProblem::Layout {
  Eigen::VectorXd state;
  std::vector<int> frame_rows;
};

MrcalProblem::MrcalProblem(const BoardObservations&, const BoardState&) {
  throw Error("mrcal", "this build has no libmrcal",
              "install Debian's libmrcal-dev and build again");
}

MrcalProblem::~MrcalProblem() = default;

// No object of the class exists, so none of these is called.
Eigen::VectorXd& MrcalProblem::state() { return layout_->state; }
int MrcalProblem::rig_states() const { return 0; }
const std::vector<int>& MrcalProblem::frame_rows() const { return layout_->frame_rows; }
Eigen::VectorXd MrcalProblem::packing_scales() const { return {}; }
void MrcalProblem::optimise() {}
MrcalEvaluation MrcalProblem::evaluate() const { return {}; }
BoardState MrcalProblem::board_state(const BoardState& like) const { return like; }

bool mrcal_available() { return false; }
const char* mrcal_version() { return ""; }

}  // namespace vernier::internal
