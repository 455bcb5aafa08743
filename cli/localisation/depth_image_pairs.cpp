// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/localisation/depth_image_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/board_detection.h"
#include "calib/error.h"
#include "cli/program/session.h"
#include "localise/views/camera_poses.h"
#include "localise/views/depth_maps.h"
#include "stereo/corners/match_images.h"

namespace vernier::cli {
namespace {

std::vector<ImageFiles> paired_by_time(std::vector<std::filesystem::path> images,
                                       const std::vector<std::filesystem::path>& maps) {
  const auto time = [](const auto& file) { return *time_of_name(file.stem().string()); };
  std::sort(images.begin(), images.end(),
            [&](const auto& a, const auto& b) { return time(a) < time(b); });
  const std::vector<std::filesystem::path> found = depth_maps_by_time(images, maps);
  std::vector<ImageFiles> pairs;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!found[i].empty()) pairs.push_back({static_cast<int>(i), images[i], found[i]});
  }
  return pairs;
}

}  // namespace

std::vector<ImageFiles> images_with_depths(const std::string& image,
                                           const std::string& depth,
                                           const Session& session) {
  const auto images = matching_files(image), depths = matching_files(depth);
  if (images.size() * depths.size() == 1 || !are_named_by_time(images) ||
      !are_named_by_time(depths)) {
    return paired_images(image, depth);
  }
  std::vector<ImageFiles> pairs = paired_by_time(images, depths);
  if (pairs.empty()) {
    throw Error(depth, "no depth map is within 20 ms of an image",
                "give depth maps of the same times");
  }
  if (pairs.size() < images.size()) {
    session.info(fmt::format("{} of {} images have no depth map within 20 ms and are left out",
                             images.size() - pairs.size(), images.size()));
  }
  return pairs;
}

}  // namespace vernier::cli
