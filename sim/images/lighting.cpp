// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/lighting.h"

#include <algorithm>
#include <cmath>

#include "calib/error.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using Eigen::Vector3d;

void check_lighting(const LightingOptions& o) {
  if (!(o.ambient >= 0 && o.ambient <= 10) || !(o.lamp_reach_m >= 0.1 && o.lamp_reach_m <= 1000)) {
    throw Error("lighting",
                "the ambient light is not in [0, 10], or a lamp's reach not in [0.1, 1000] m",
                "use 0.35 and 6 m, say");
  }
  if (o.ambient == 0 && !o.lamps) {
    throw Error("lighting", "there is no light", "leave the lamps on, or use ambient light");
  }
}

std::vector<Vector3d> lamps_of(const World& world, const LightingOptions& options) {
  constexpr double below_m = 0.1, spacing_m = 3, most = 400;
  std::vector<Vector3d> lamps;
  if (!options.lamps) return lamps;
  for (const WorldObject& object : world.objects) {
    if (object.template_name == "ceiling_light")
      lamps.push_back(object.centre_m - Vector3d(0, 0, below_m));
  }
  if (!lamps.empty() || world.segments.empty()) return lamps;
  const WorldExtent whole = extent(world);
  const Vector3d size = whole.high_m - whole.low_m;
  const double step = std::max(spacing_m, std::sqrt(size.x() * size.y() / most));
  const auto steps = [&](double length) {
    return std::clamp(static_cast<int>(length / step), 1, static_cast<int>(most));
  };
  const int columns = steps(size.x()),
            rows = std::min(steps(size.y()), static_cast<int>(most) / columns + 1);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      lamps.emplace_back(whole.low_m.x() + (i + 0.5) * size.x() / columns,
                         whole.low_m.y() + (j + 0.5) * size.y() / rows, whole.high_m.z() - below_m);
    }
  }
  return lamps;
}

double ambient_light(const Vector3d& normal, const LightingOptions& options) {
  return options.ambient * (1 + 0.3 * normal.dot(Vector3d(0.48, 0.6, 0.64)));
}

double lamp_light(const Vector3d& x,
                  const Vector3d& normal,
                  const Vector3d& lamp,
                  const LightingOptions& options) {
  const Vector3d to = lamp - x;
  const double d2 = to.squaredNorm(), reach2 = options.lamp_reach_m * options.lamp_reach_m;
  const double towards = normal.dot(to);
  if (towards <= 0 || to.z() <= 0 || d2 >= reach2) return 0;
  const double fade = 1 - d2 / reach2;
  return towards * to.z() / d2 * fade * fade / (1 + d2 / 4);
}

}  // namespace vernier::sim::internal
