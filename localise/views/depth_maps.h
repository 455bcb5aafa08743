// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vernier::localise::internal {

/// Whether files are named after times with a point, as 1305031102.175304.png of TUM's RGB-D
/// sequences.
bool are_named_by_time(const std::vector<std::filesystem::path>& files);

/// Of each image the file among `maps` that is nearest in time, at most 20 ms away (as TUM's
/// associate.py), if no other image is nearer to that; empty where there is none. All are named by
/// time.
std::vector<std::filesystem::path> depth_maps_by_time(
    const std::vector<std::filesystem::path>& images,
    const std::vector<std::filesystem::path>& maps);

/// The depth map of each image, wherever they stand in the list `maps`, which may hold others: by
/// time where all are named by it; else of the same name (files_of_images), or of the same last
/// number where all have one of their own. Only where no image finds its map so, and there are as
/// many, they belong together in order. Throws Error(`place`) naming an image that has none.
std::vector<std::filesystem::path> depth_maps_of_images(
    const std::vector<std::filesystem::path>& images,
    const std::vector<std::filesystem::path>& maps,
    const std::string& place);

}  // namespace vernier::localise::internal
