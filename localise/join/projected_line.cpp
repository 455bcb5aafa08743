// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/camera.h"
#include "calib/pose.h"
#include "localise/joined_lines.h"

namespace vernier::localise {

namespace {

using Eigen::Vector3d;

/// The first and last of the samples that are seen, of the longest run without a break.
struct Run {
  int first = 0, last = -1;
};

Run longest_run(const std::vector<bool>& seen) {
  Run best, now;
  for (int i = 0; i < static_cast<int>(seen.size()); ++i) {
    if (!seen[i]) continue;
    if (i == 0 || !seen[i - 1]) now.first = i;
    now.last = i;
    if (now.last - now.first > best.last - best.first) best = now;
  }
  return best;
}

}  // namespace

std::optional<ProjectedLine> projected_line(const JoinedLine& line,
                                            const Camera& camera,
                                            const Pose& T_camera_world,
                                            double near_m) {
  const Vector3d a = T_camera_world * line.a_m, b = T_camera_world * line.b_m;
  // the part beyond near_m, whatever the lens
  double t0 = 0, t1 = 1;
  if (a.z() < near_m && b.z() < near_m) return {};
  const double crossing = (near_m - a.z()) / (b.z() - a.z());
  if (a.z() < near_m) t0 = crossing;
  if (b.z() < near_m) t1 = crossing;
  const auto point = [&](double t) -> Vector3d { return a + t * (b - a); };
  const auto is_seen = [&](double t) {
    const Vector3d p = point(t);
    constexpr double widest = 8;  // of x / z: beyond, a distortion's polynomial may fold back
    if (p.head<2>().norm() > widest * p.z()) return false;
    return in_image(camera, project(camera, p));
  };
  constexpr int samples = 256;
  const auto at = [&](int i) { return t0 + (t1 - t0) * i / samples; };
  std::vector<bool> seen(samples + 1);
  for (int i = 0; i <= samples; ++i) seen[i] = is_seen(at(i));
  const Run run = longest_run(seen);
  if (run.last <= run.first) return {};
  const auto border = [&](double in, double out) {
    constexpr int halvings = 30;
    for (int i = 0; i < halvings; ++i) (is_seen(0.5 * (in + out)) ? in : out) = 0.5 * (in + out);
    return in;
  };
  ProjectedLine seen_part;
  seen_part.t0 = run.first > 0 ? border(at(run.first), at(run.first - 1)) : at(0);
  seen_part.t1 = run.last < samples ? border(at(run.last), at(run.last + 1)) : at(samples);
  seen_part.image_px = {project(camera, point(seen_part.t0)), project(camera, point(seen_part.t1))};
  return seen_part;
}

}  // namespace vernier::localise
