// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace vernier::localise::internal {

/// Of each image the index of the name that stands for it, or nothing. A name is the image's file
/// name, with or without its ending, and where images in several folders have one file name, with
/// as many folders before it as tell them apart: of equal file names, the one stands for an image
/// of whose path, counted from the end, most parts are equal. Throws Error(`place`) where one name
/// stands for two images, or two names equally well for one.
std::vector<std::optional<std::size_t>> names_of_images(
    const std::vector<std::string>& names,
    const std::vector<std::filesystem::path>& images,
    const std::string& place);

/// Names by which images can be told apart: their file names, all with as many of their folders as
/// that takes.
std::vector<std::string> distinct_names(const std::vector<std::filesystem::path>& images);

}  // namespace vernier::localise::internal
