// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig.h"

namespace vernier::sim::internal {

/// Why no rig can be like this: a parameter that is not finite, a focal length or an aspect factor
/// that is not positive, a centre that is further from its image than the image is long. Empty if
/// none is so. An error that is large against a calibration, such as psi_c = 300, gives such rigs.
std::string impossible(const Rig& rig);

}  // namespace vernier::sim::internal
