// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/localisation/depth_image_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "calib/board_detection.h"
#include "calib/error.h"
#include "cli/program/session.h"
#include "localise/views/camera_poses.h"
#include "stereo/corners/match_images.h"

namespace vernier::cli {
namespace {

std::vector<ImageFiles> paired_by_time(const std::vector<std::filesystem::path>& images,
                                       const std::vector<std::filesystem::path>& depths) {
  constexpr double gap_s = 0.02;  // as TUM's associate.py
  const auto times_of = [](const std::vector<std::filesystem::path>& files) {
    std::vector<std::pair<double, std::filesystem::path>> times;
    for (const auto& file : files) times.emplace_back(*time_of_name(file.stem().string()), file);
    std::sort(times.begin(), times.end());
    return times;
  };
  const auto of_images = times_of(images), of_depths = times_of(depths);
  const auto nearest = [](const auto& times, double time_s) {
    return std::min_element(times.begin(), times.end(), [&](const auto& a, const auto& b) {
      return std::abs(a.first - time_s) < std::abs(b.first - time_s);
    });
  };
  std::vector<ImageFiles> pairs;
  for (auto image = of_images.begin(); image != of_images.end(); ++image) {
    const auto depth = nearest(of_depths, image->first);
    if (std::abs(depth->first - image->first) > gap_s) continue;
    if (nearest(of_images, depth->first) != image) continue;
    pairs.push_back({static_cast<int>(image - of_images.begin()), image->second, depth->second});
  }
  return pairs;
}

}  // namespace

std::vector<ImageFiles> images_with_depths(const std::string& image,
                                           const std::string& depth,
                                           const Session& session) {
  const auto images = matching_files(image), depths = matching_files(depth);
  const auto is_time = [](const std::filesystem::path& file) {
    const std::string stem = file.stem().string();
    return stem.find('.') != std::string::npos && time_of_name(stem);
  };
  const auto are_times = [&](const auto& files) {
    return std::all_of(files.begin(), files.end(), is_time);
  };
  if (images.size() * depths.size() == 1 || !are_times(images) || !are_times(depths)) {
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
