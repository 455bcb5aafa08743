// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "stereo/rectification/vertical_field.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Why a pair with this vertical field, which nothing corrects, is not to be trusted, or empty:
/// from half a pixel on (rms over the image) errors of disparities are twice what they are in
/// aligned rows (docs/rectification.md). Fields of images that are not rectified are left out.
std::string row_doubt(const VerticalField& field);

}  // namespace vernier::cli
