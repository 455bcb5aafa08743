// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig.h"

namespace vernier::internal {

/// Why no camera can be like this: "left.f_px is not positive", "right.ax is not positive". Empty
/// if each focal length and each aspect factor is positive. Gaussian errors that are large against
/// these values give such rigs.
std::string unphysical(const Rig& rig);

/// Share of unphysical draws above which a Gaussian does not describe the rig's errors: a focal
/// length nearer to zero than 3.1 of its standard deviations.
inline constexpr double most_unphysical = 1e-3;

}  // namespace vernier::internal
