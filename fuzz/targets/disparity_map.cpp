// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"
#include "stereo/disparity_file.h"

namespace vernier::fuzz {
namespace {

using stereo::DisparityMap;
using stereo::read_disparity;
using stereo::write_disparity;

void require_same_map(const DisparityMap& a, const DisparityMap& b) {
  require(a.width_px == b.width_px && a.height_px == b.height_px, "the size is kept");
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    require(same(a.values[i], b.values[i]), "disparities are kept");
  }
}

/// A map of a data set, or what a user's own matcher has answered: PFM, PNG, PGM or NumPy, told by
/// the content.
void run_disparity_map(std::string_view bytes) {
  const std::filesystem::path file = input_file(bytes, "map");
  accepted([&] { return read_disparity(file, {.scale = 256, .min_px = -0.5}); });
  const auto map = accepted([&] { return read_disparity(file); });
  if (!map) return;
  require(map->values.size() ==
              static_cast<std::size_t>(map->width_px) * static_cast<std::size_t>(map->height_px),
          "a map has a value for every pixel");
  for (const char* name : {"map.pfm", "map.npy"}) {
    const std::filesystem::path written = input_folder() / name;
    write_disparity(written, *map);
    require_same_map(*map, read_disparity(written));
  }
}

std::vector<std::string> disparity_map_seeds() {
  std::vector<std::string> seeds;
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  const DisparityMap map{4, 3, {1, 2.5F, unknown, 3, 0.25F, 64, 7, 8, unknown, 9.5F, 10, 11}};
  for (const char* name : {"seed.pfm", "seed.npy", "seed.png"}) {
    const std::filesystem::path file = input_folder() / name;
    write_disparity(file, map);
    seeds.push_back(file_bytes(file));
  }
  seeds.push_back("P5\n# by another tool\n3 2\n255\n" + std::string("\1\2\3\4\5\6"));
  return seeds;
}

const Registered registered_disparity_map{
    {"disparity_map", 1000, "numpy", run_disparity_map, disparity_map_seeds}};

}  // namespace
}  // namespace vernier::fuzz
