// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/rig.h"

namespace vernier {

/// A parameter of the rig that is not estimated. A component of a rotation is held as that
/// component of the rotation vector.
struct HeldParameter {
  std::string name;  ///< such as "left.ax" (see parameter_names)
  /// Nothing: ax 1, the centre in the middle of the image, no distortion; a focal length or a part
  /// of a pose where the start has it.
  std::optional<double> value;
};

/// One flag a parameter of the rig. Throws Error for a name that the rig does not have, for a
/// parameter held twice and for values that no camera has (f_px or ax not above 0, not finite).
std::vector<bool> held_mask(const Rig& rig, const std::vector<HeldParameter>& held);

/// The rig with the held parameters at their values, or at what stands for none (above).
Rig with_held_values(const Rig& rig, const std::vector<HeldParameter>& held);

/// The directions of the rig's tangent that are left free, parameters x free parameters: unit
/// vectors for intrinsics and positions; for a rotation the columns of J_l(r) (calib/pose.h) that
/// belong to the free components of its rotation vector r.
Eigen::MatrixXd free_directions(const Rig& rig, const std::vector<bool>& held);

/// Names of the parameters that are not held.
std::vector<std::string> free_names(const Rig& rig, const std::vector<bool>& held);

}  // namespace vernier
