// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "stereo/corners/match_images.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// RandomStream both images of a pair, the right one below the left, with a dot at each matched
/// corner and a line from the left corner to where the right image's pixel lies in the left one:
/// its colour is the direction from red (little motion) to blue (the most). PNG.
void write_match_picture(const ImageMatching& matching, const std::filesystem::path& file);

}  // namespace vernier::cli
