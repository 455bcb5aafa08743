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
/// name, with or without its ending, and may have folders before it. They count where they must:
/// where two names or two images have one file name, an image's path and its name agree as far as
/// the shorter of them goes. Throws Error(`place`) where one name stands for two images, or two
/// names stand for one.
std::vector<std::optional<std::size_t>> names_of_images(
    const std::vector<std::string>& names,
    const std::vector<std::filesystem::path>& images,
    const std::string& place);

/// The same where every image needs one: throws Error(`place`) for an image that has no pose there.
std::vector<std::size_t> pose_names_of_images(const std::vector<std::string>& names,
                                              const std::vector<std::filesystem::path>& images,
                                              const std::string& place);

/// Of each image the index of the file that has its name but for the ending; of several, the one
/// of whose folders, counted from the end, most are those of the image. Nothing where there is none
/// or two are as near. Throws Error(`place`) where one file belongs to two images.
std::vector<std::optional<std::size_t>> files_of_images(
    const std::vector<std::filesystem::path>& files,
    const std::vector<std::filesystem::path>& images,
    const std::string& place);

/// Whether two names are the same but for their folders and endings.
bool need_folders(const std::vector<std::string>& names);

/// Names by which images can be told apart: their file names, all with as many of their folders as
/// that takes.
std::vector<std::string> distinct_names(const std::vector<std::filesystem::path>& images);

}  // namespace vernier::localise::internal
