// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "calib/rig.h"
#include "calib/statistics/random.h"
#include "sim/mount_error.h"
#include "sim/moved_furniture.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/uncertainty_source.h"
#include "sim/world.h"
#include "stereo/segment.h"
#include "tests/support/chi_squared.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim::internal;
using namespace vernier::internal;
using namespace vernier::sim;

namespace {

const NoiseFreeView& seen_view() { return test::office_look(); }

// Seed 3, 40 trials. Sum of squares of end-point errors over sigma² is chi-squared; two-sided
// false-alarm rate 1e-3.
TEST(SourceStatistics, EndpointErrorHasItsSigma) {
  SourceSettings settings = no_sources();
  settings.endpoint_sigma_px = 0.15;
  const Sensor noisy(test::nominal_rig().rig, settings),
      clean(test::nominal_rig().rig, no_sources());
  double sum = 0;
  int n = 0;
  for (std::uint32_t trial = 0; trial < 40; ++trial) {
    const auto a = noisy.sense(seen_view(), {.seed = 3, .trial = trial}),
               b = clean.sense(seen_view(), {.seed = 3, .trial = trial});
    for (std::size_t i = 0; i < a.segments.size(); ++i) {
      sum += (a.segments[i].left.a_px - b.segments[i].left.a_px).squaredNorm() / 0.0225;
      sum += (a.segments[i].right.b_px - b.segments[i].right.b_px).squaredNorm() / 0.0225;
      n += 4;
    }
  }
  EXPECT_GT(sum, test::chi_squared_quantile(n, 5e-4));
  EXPECT_LT(sum, test::chi_squared_quantile(n, 1 - 5e-4));
}

// Seed 3, 60 trials. Shares lost and mismatched against their binomial expectation; two-sided
// false-alarm rate 1e-3 each (normal approximation).
TEST(SourceStatistics, CornerSharesAreAsSet) {
  SourceSettings settings = no_sources();
  settings.corner_loss = 0.15;
  settings.corner_mismatch = 0.1;
  settings.corner_mismatch_px = 10;
  const Sensor sensor(test::nominal_rig().rig, settings);
  double total = 0, kept = 0, wrong = 0;
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    const auto sighting = sensor.sense(seen_view(), {.seed = 3, .trial = trial});
    total += static_cast<double>(seen_view().corners.size());
    kept += static_cast<double>(sighting.corners.size());
    for (const SensedCorner& c : sighting.corners) wrong += c.mismatched;
  }
  const double z = normal_quantile(1 - 5e-4);
  EXPECT_NEAR(kept / total, 0.85, z * std::sqrt(0.15 * 0.85 / total));
  EXPECT_NEAR(wrong / kept, 0.1, z * std::sqrt(0.1 * 0.9 / kept));
}

/// Both tails of a mean of n independent draws with this mean and variance, at a false-alarm rate
/// of 1e-3 (normal approximation).
void expect_mean(double sum, double n, double mean, double variance) {
  EXPECT_NEAR(sum / n, mean, normal_quantile(1 - 5e-4) * std::sqrt(variance / n));
}

/// Both tails of a variance of n normal draws, at a false-alarm rate of 1e-3.
void expect_variance(double squares, int n, double variance) {
  EXPECT_GT(squares / variance, test::chi_squared_quantile(n, 5e-4));
  EXPECT_LT(squares / variance, test::chi_squared_quantile(n, 1 - 5e-4));
}

// Seed 3, 1e5 trials: mean and variance of each of the three, and their correlations; ten checks of
// a two-sided false-alarm rate of 1e-3 each.
TEST(SourceStatistics, MountErrorsAreNormalAndIndependent) {
  SourceSettings settings = no_sources();
  settings.mount_height_m = 0.01;
  settings.mount_pitch_deg = 0.5;
  settings.mount_roll_deg = 1;
  constexpr int n = 100'000;
  const Eigen::Vector3d sigma(0.01, 0.5, 1);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  double far = 0;
  for (std::uint32_t trial = 0; trial < n; ++trial) {
    const TrueMount stands = draw_mount({1.2, 0}, settings, 3, trial);
    constexpr double degrees = 180 / std::numbers::pi;
    const Eigen::Vector3d z =
        Eigen::Vector3d(stands.mount.height_m - 1.2, degrees * stands.mount.pitch_rad,
                        degrees * stands.roll_rad)
            .cwiseQuotient(sigma);
    sum += z;
    products += z * z.transpose();
    far += z.x() > 1.959963984540054;
  }
  for (int i = 0; i < 3; ++i) {
    expect_mean(sum[i], n, 0, 1);
    expect_variance(products(i, i), n, 1);
    expect_mean(products(i, (i + 1) % 3), n, 0, 1);
  }
  expect_mean(far, n, 0.025, 0.025 * 0.975);
}

// Seeds from 3 on, more than 1e5 objects that may move: share, distance, direction and turn against
// their uniform distributions; eight checks of a two-sided false-alarm rate of 1e-3 each.
TEST(SourceStatistics, FurnitureMovesAsStated) {
  World world;  // posts on the floor, no fixtures
  constexpr std::size_t posts = 1000;
  world.objects.resize(posts + 1);
  for (std::size_t i = 1; i <= posts; ++i) {
    const auto object = static_cast<std::int32_t>(i);
    world.objects[i].template_name = "post";
    world.segments.push_back({{0, 0, 0}, {0, 0, 1}, object});
  }
  constexpr double share = 0.3;
  double may = 0, moved = 0, far_m = 0, squares = 0, east = 0, north = 0, turn = 0,
         turn_squares = 0;
  for (std::uint64_t seed = 3; seed < 103; ++seed) {
    const World after = with_moved_furniture(world, share, seed);
    for (std::size_t i = 0; i < posts; ++i) {
      ++may;
      const Eigen::Vector3d step = after.segments[i].a_m;
      if (step.norm() == 0) continue;
      ++moved;
      const double d = step.norm(), by = after.objects[i + 1].yaw_rad;
      EXPECT_GE(d, 0.3);
      EXPECT_LE(d, 1);
      far_m += d;
      squares += d * d;
      east += step.x() / d;
      north += step.y() / d;
      turn += by;
      turn_squares += by * by;
    }
  }
  EXPECT_GE(may, 1e5);
  expect_mean(moved, may, share, share * (1 - share));
  expect_mean(far_m, moved, 0.65, 0.49 / 12);
  expect_mean(squares, moved, 1.39 / 3, 0.0703);  // E[d²] and its variance for U(0.3, 1)
  expect_mean(east, moved, 0, 0.5);
  expect_mean(north, moved, 0, 0.5);
  expect_mean(turn, moved, 0, 0.64 / 3);
  expect_mean(turn_squares, moved, 0.64 / 3, 0.4096 * 4 / 45);
}

// Seed 3, at least 1e5 false edges of one view: their number, where and how long they are, in which
// direction; eight checks of a two-sided false-alarm rate of 1e-3 each. Draws are repeated where
// an eye would not see all of the edge, so a rig with a narrow base and short edges is used, for
// which this happens to few.
TEST(SourceStatistics, ClutterIsAsStated) {
  SourceSettings settings = no_sources();
  settings.clutter = 1.37;
  const Rig& rig = test::nominal_rig().rig;
  const Sensor sensor(rig, settings);
  const auto visible = static_cast<double>(seen_view().edges.size());
  double frames = 0, count = 0, squares = 0, half_way = 0, in_middle = 0, deep = 0;
  std::vector<double> depths;
  for (const VisibleEdge& edge : seen_view().edges)
    depths.push_back(0.5 * (edge.a_m.z() + edge.b_m.z()));
  std::vector<double> sorted = depths;
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted[sorted.size() / 2];
  double deeper = 0;
  for (const double depth : depths) deeper += depth > median + 1e-9;
  const double whole = std::floor(1.37 * visible), part = 1.37 * visible - whole;
  while (count < 1e5) {
    const StereoObservation sighting =
        sensor.sense(seen_view(), {.seed = 3, .trial = static_cast<std::uint32_t>(frames)});
    double here = 0;
    for (std::size_t i = 0; i < sighting.segments.size(); ++i) {
      if (!sighting.true_edges[i].is_false()) continue;
      ++here;
      const stereo::ImageSegment& s = sighting.segments[i].left;
      const Eigen::Vector2d d = s.b_px - s.a_px, middle = 0.5 * (s.a_px + s.b_px);
      squares += d.norm();
      half_way += d.x() > 0;
      in_middle += std::abs(middle.y() / rig.cameras[0].size_px[1] - 0.5) < 0.2;
      deep += sighting.true_edges[i].a_m.z() > median + 1e-9;
    }
    EXPECT_GE(here, whole);
    EXPECT_LE(here, whole + 1);
    count += here;
    ++frames;
  }
  expect_mean(count, frames, whole + part, part * (1 - part));
  expect_mean(deep, count, deeper / visible, 0.25);
  expect_mean(half_way, count, 0.5, 0.25);  // directions and their mirror images
  // Edges near the border are drawn again, the longer the more often: bounds, not equations.
  EXPECT_LT(squares / count, 55);
  EXPECT_GT(squares / count, 45);
  EXPECT_GT(in_middle / count, 0.4);
  EXPECT_LT(in_middle / count, 0.5);
}

}  // namespace
}  // namespace vernier
