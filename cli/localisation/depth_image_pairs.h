// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/namespaces.h"
#include "cli/program/session.h"
#include "stereo/corners/match_images.h"

namespace vernier::cli {

/// Images with their depth maps (as `right`), of two glob patterns: paired by the last number in
/// their names; where all names are times, as 1305031102.175304.png of TUM's RGB-D sequences, with
/// the depth map that is nearest in time, at most 20 ms away, if no other image is nearer to that.
/// Says how many images have none. Throws Error if there is no pair.
std::vector<ImageFiles> images_with_depths(const std::string& image,
                                           const std::string& depth,
                                           const Session& session);

}  // namespace vernier::cli
