// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/depth_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/board/frame_numbering.h"
#include "calib/error.h"
#include "localise/views/camera_poses.h"
#include "localise/views/image_names.h"

namespace vernier::localise::internal {
namespace {

using Path = std::filesystem::path;
using Paths = std::vector<Path>;

bool is_named_by_time(const Path& file) {
  const std::string stem = file.stem().string();
  return stem.find('.') != std::string::npos && time_of_name(stem);
}

std::vector<double> times_of(const Paths& files) {
  std::vector<double> times;
  for (const Path& file : files) times.push_back(*time_of_name(file.stem().string()));
  return times;
}

/// The earliest of the nearest.
std::size_t nearest(const std::vector<double>& times, double time_s) {
  const auto order = [&](double a, double b) {
    return std::pair(std::abs(a - time_s), a) < std::pair(std::abs(b - time_s), b);
  };
  return static_cast<std::size_t>(std::min_element(times.begin(), times.end(), order) -
                                  times.begin());
}

/// Indices of files by the last number in their names; empty unless all have one of their own.
std::map<std::int64_t, std::size_t> numbered(const Paths& files) {
  std::map<std::int64_t, std::size_t> all;
  try {
    for (std::size_t i = 0; i < files.size(); ++i) {
      const std::int64_t number = vernier::internal::parse_image_name(files[i]).frame;
      if (!all.emplace(number, i).second) return {};
    }
  } catch (const Error&) {  // a name without a number
    return {};
  }
  return all;
}

/// The maps of equal names or numbers; empty where an image has none.
Paths by_name(const Paths& images, const Paths& maps, const std::string& place) {
  Paths found;
  for (const auto& map : files_of_images(maps, images, place)) {
    found.push_back(map ? maps[*map] : Path());
  }
  const auto of_maps = numbered(maps);
  for (const auto& [number, image] : numbered(images)) {
    const auto at = of_maps.find(number);
    if (found[image].empty() && at != of_maps.end()) found[image] = maps[at->second];
  }
  return found;
}

}  // namespace

bool are_named_by_time(const Paths& files) {
  return std::all_of(files.begin(), files.end(), is_named_by_time);
}

Paths depth_maps_by_time(const Paths& images, const Paths& maps) {
  constexpr double gap_s = 0.02;
  const std::vector<double> of_images = times_of(images), of_maps = times_of(maps);
  Paths found(images.size());
  for (std::size_t i = 0; i < images.size() && !maps.empty(); ++i) {
    const std::size_t map = nearest(of_maps, of_images[i]);
    if (std::abs(of_maps[map] - of_images[i]) > gap_s) continue;
    if (nearest(of_images, of_maps[map]) == i) found[i] = maps[map];
  }
  return found;
}

Paths depth_maps_of_images(const Paths& images, const Paths& maps, const std::string& place) {
  if (images.size() == 1 && maps.size() == 1) return maps;
  const bool by_time = are_named_by_time(images) && are_named_by_time(maps);
  Paths found = by_time ? depth_maps_by_time(images, maps) : by_name(images, maps, place);
  const auto without = std::count(found.begin(), found.end(), Path());
  if (without == 0) return found;
  if (!by_time && static_cast<std::size_t>(without) == images.size() &&
      images.size() == maps.size()) {
    return maps;
  }
  const auto first = std::find(found.begin(), found.end(), Path()) - found.begin();
  throw Error(
      place,
      fmt::format("has no map of {}{}", vernier::internal::in_quotes(images[first].string()),
                  without > 1
                      ? fmt::format(" and {} more of the {} images", without - 1, images.size())
                      : ""),
      "give the map of each image, of its name, number or time");
}

}  // namespace vernier::localise::internal
