// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/localisation/place_poses.h"

#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "localise/place.h"

namespace vernier::cli {

std::map<std::string, Pose2D> read_place_poses(const std::filesystem::path& file) {
  constexpr std::string_view header = "image,x_m,y_m,heading_deg";
  constexpr double most_m = 1e6, most_deg = 360;
  std::map<std::string, Pose2D> poses;
  TextLines lines(file);
  std::string_view line;
  if (!lines.next(line) || line != header) {
    throw Error(file.string(), "does not begin with the line " + std::string(header), "add it");
  }
  while (lines.next(line)) {
    if (line.empty()) continue;
    const std::vector<std::string_view> fields = split_fields(line, ",");
    if (fields.size() != 4) {
      throw Error(lines.place(), "does not have four fields", "give " + std::string(header));
    }
    const std::string image(fields[0]);
    const double x = parse_real(fields[1], lines.place(), "x_m");
    const double y = parse_real(fields[2], lines.place(), "y_m");
    const double heading = parse_real(fields[3], lines.place(), "heading_deg");
    if (!(std::abs(x) <= most_m && std::abs(y) <= most_m && std::abs(heading) <= most_deg)) {
      throw Error(lines.place(), "is not finite, beyond 1,000 km or more than a turn",
                  "give metres and degrees");
    }
    if (!poses.emplace(image, Pose2D{x, y, heading * std::numbers::pi / 180}).second) {
      throw Error(lines.place(), "gives " + in_quotes(image) + " a second time", "remove one");
    }
  }
  if (poses.empty()) throw Error(file.string(), "holds no poses", "add a line for each pair");
  return poses;
}

}  // namespace vernier::cli
