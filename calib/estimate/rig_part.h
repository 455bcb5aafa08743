// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

/// The rig of some of a rig's cameras, by their indices, in the frame of the first of them: every
/// pose is composed anew, T_b_a = T_b_first T_a_first⁻¹. Throws Error unless they are cameras of
/// the rig, each given once, and at least one.
Rig part_of(const Rig& rig, const std::vector<int>& kept);

/// The derivative of part_of() with both rigs in the tangent of calib/rig.h, parameters of the part
/// x parameters of the rig. Intrinsics are copied; with (w, τ) the left tangents of T_a_first and
/// T_b_first and R = R_b_a, those of T_b_a are
///
///     w_ba = w_b − R w_a        τ_ba = τ_b − R τ_a + [R t_a]x w_ba
Eigen::MatrixXd part_by_rig(const Rig& rig, const std::vector<int>& kept);

/// The same for an estimate: both covariances become J C Jᵀ with the J above, so the errors of the
/// cameras left out are marginalised, not fixed. The summary of the calibration stays as it is, of
/// the whole rig, but for names of held parameters and outliers that the part does not have. The
/// evidence is dropped, since it is of all cameras, unless all are kept in their order. Throws
/// Error as above.
RigEstimate part_of(const RigEstimate& estimate, const std::vector<int>& kept);

/// The pair of a rig's first camera and another, without the evidence, for functions of a pair.
/// Throws Error unless `other` is a camera of the rig and not its first.
RigEstimate pair_of(const RigEstimate& estimate, int other);

/// Throws Error (`place`) unless the rig has two cameras; for more the remedy is the command that
/// takes two of them out of `file`, or what else can be done.
void require_pair(const Rig& rig,
                  const std::string& place,
                  const std::string& file = "RIG",
                  const std::string& or_else = "");

}  // namespace vernier::internal
