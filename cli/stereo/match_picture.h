// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "stereo/corners/match_images.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Draws both images of a pair, the right one below the left, with a dot at each matched
/// corner and a line from the left corner to the position of the right image's pixel in the left
/// one, coloured from red (shortest) to blue (longest). The content of a PNG file.
std::string match_picture(const ImageMatching& matching);

}  // namespace vernier::cli
