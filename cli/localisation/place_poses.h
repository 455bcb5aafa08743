// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "cli/program/namespaces.h"
#include "localise/place.h"

namespace vernier::cli {

/// Poses of pairs of images by the name of the left one: lines `image,x_m,y_m,heading_deg` below a
/// header of these names. Throws Error naming file and line.
std::map<std::string, Pose2D> read_place_poses(const std::filesystem::path& file);

}  // namespace vernier::cli
