// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/localisation/place_poses.h"

#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

void run_place_poses(std::string_view bytes) {
  const auto poses = accepted([&] { return cli::read_place_poses(input_file(bytes, "p.csv")); });
  if (!poses) return;
  require(!poses->empty(), "what is accepted holds a pose");
  constexpr double most_m = 1e6, most_rad = 2.001 * std::numbers::pi;
  for (const auto& [image, pose] : *poses) {
    require(image.find(',') == std::string::npos, "a name is one field");
    require(std::abs(pose.x_m) <= most_m && std::abs(pose.y_m) <= most_m &&
                std::abs(pose.heading_rad) <= most_rad,
            "poses are within the limits");
  }
}

std::vector<std::string> place_poses_seeds() {
  const std::string header = "image,x_m,y_m,heading_deg\n";
  return {header, header + "left01.png,3,-2,90\nleft02.png,3.5,-2,-90.5\n\n",
          header + "left 1.png,1e6,-1e-6,360\r\n"};
}

const Registered registered_place_poses{
    {"place_poses", 2000, "columns", run_place_poses, place_poses_seeds}};

}  // namespace
}  // namespace vernier::fuzz
