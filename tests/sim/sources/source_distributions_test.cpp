// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// What each source of the memo did over at least 1e5 draws against its definition in
// docs/simulation.md, with the defaults. Mount, moved furniture and clutter: see
// sources_statistical_test.cpp. Seed 5. Whole distributions are compared by Kolmogorov and Smirnov,
// shares in both tails by the normal approximation; 18 checks with a false-alarm rate of 1e-4 each.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::sim;
using namespace vernier::stereo;
using Eigen::Vector2d;

namespace {

constexpr std::size_t wanted = 100'000;
constexpr double false_alarm = 1e-4;

void expect_distribution(const std::vector<double>& sample,
                         const std::function<double(double)>& cdf) {
  EXPECT_GE(sample.size(), wanted);
  EXPECT_GT(kolmogorov_smirnov_p(sample, cdf), false_alarm);
}

std::function<double(double)> uniform(double low, double high) {
  return [=](double x) { return std::clamp((x - low) / (high - low), 0.0, 1.0); };
}

std::function<double(double)> normal(double sigma) {
  return [=](double x) { return 0.5 * std::erfc(-x / (sigma * std::numbers::sqrt2)); };
}

void expect_share(double count, double n, double share) {
  EXPECT_GE(n, wanted);
  const double z = normal_quantile(1 - false_alarm / 2);
  EXPECT_NEAR(count, n * share, z * std::sqrt(n * share * (1 - share)));
}

/// One source on, with its default size.
SourceSettings only(double SourceSettings::*source) {
  SourceSettings settings = no_sources();
  settings.*source = SourceSettings{}.*source;
  return settings;
}

const NoiseFreeView& seen() { return test::office_look(); }
const Rig& rig() { return test::nominal_rig().rig; }

StereoObservation sensed(const SourceSettings& settings, std::uint32_t trial) {
  return Sensor(rig(), settings).sense(seen(), {.seed = 5, .trial = trial});
}

const StereoObservation& exact() {
  static const StereoObservation clean = sensed(no_sources(), 0);
  return clean;
}

TEST(SourceDistributions, LateralShift) {
  const SourceSettings settings = only(&SourceSettings::lateral_shift_px);
  std::vector<double> sizes;
  double to_the_left = 0, signs = 0;
  for (std::uint32_t trial = 0; sizes.size() < wanted || signs < wanted; ++trial) {
    const StereoObservation shifted = sensed(settings, trial);
    ASSERT_EQ(shifted.segments.size(), exact().segments.size());
    // Parts of an edge share their shift, and edges of an object their sign: each counts once.
    std::set<int> edges, objects;
    for (std::size_t i = 0; i < shifted.segments.size(); ++i) {
      const VisibleEdge& edge = exact().true_edges[i];
      const ImageSegment &from = exact().segments[i].left, &to = shifted.segments[i].left;
      const Vector2d along = (from.b_px - from.a_px).normalized(), moved = to.a_px - from.a_px;
      const bool is_new = edges.insert(edge.segment).second;
      if (is_new) sizes.push_back(moved.norm());
      if (edge.object == 0 ? !is_new : !objects.insert(edge.object).second) continue;
      ++signs;
      to_the_left += along.x() * moved.y() - along.y() * moved.x() > 0;
    }
  }
  expect_distribution(sizes, uniform(1.5, 4.5));
  expect_share(to_the_left, signs, 0.5);
}

// One gap of 11.25 % of the length in the image, from -11.25 % to 100 % and pushed inside: a
// uniform place, and a probability of 0.1125 / 1.1125 at either end.
TEST(SourceDistributions, EdgeLoss) {
  const SourceSettings settings = only(&SourceSettings::edge_loss);
  constexpr double share = 0.1125, at_an_end = share / (1 + share);
  // Fractions of the image line are those of x / z.
  const auto image = [](const Eigen::Vector3d& x) -> Vector2d { return x.head<2>() / x.z(); };
  std::map<std::uint32_t, const VisibleEdge*> whole;
  for (const VisibleEdge& edge : seen().edges) whole[edge.feature] = &edge;
  std::vector<double> inside;
  double low = 0, high = 0, edges = 0;
  for (std::uint32_t trial = 0; inside.size() < wanted; ++trial) {
    const StereoObservation left_over = sensed(settings, trial);
    std::map<std::uint32_t, std::vector<std::pair<double, double>>> pieces;
    for (std::size_t i = 0; i < left_over.segments.size(); ++i) {
      const VisibleEdge& part = left_over.true_edges[i];
      const Vector2d a = image(whole[part.feature]->a_m), d = image(whole[part.feature]->b_m) - a;
      pieces[part.feature].emplace_back((image(part.a_m) - a).dot(d) / d.squaredNorm(),
                                        (image(part.b_m) - a).dot(d) / d.squaredNorm());
    }
    for (const auto& [feature, parts] : pieces) {
      // Pieces shorter than 10 px are not detected: in long edges one is left all the same.
      const VisibleEdge& edge = *whole[feature];
      const double length =
          (project(rig().cameras[0], edge.a_m) - project(rig().cameras[0], edge.b_m)).norm();
      if (length < 60) continue;
      const double start = parts[0].first < 1e-9 ? parts[0].second : parts[0].first - share;
      double lost = 1;
      for (const auto& [from, to] : parts) lost -= to - from;
      if (parts.size() == 2) {
        EXPECT_NEAR(lost, share, 1e-9);
      }
      ++edges;
      if (start < 1e-9) {
        ++low;
      } else if (start > 1 - share - 1e-9) {
        ++high;
      } else {
        inside.push_back(start);
      }
    }
  }
  expect_distribution(inside, uniform(0, 1 - share));
  expect_share(low, edges, at_an_end);
  expect_share(high, edges, at_an_end);
}

TEST(SourceDistributions, EndpointError) {
  const SourceSettings settings = only(&SourceSettings::endpoint_sigma_px);
  std::vector<double> along, across, radii;
  for (std::uint32_t trial = 0; along.size() < wanted; ++trial) {
    const StereoObservation noisy = sensed(settings, trial);
    ASSERT_EQ(noisy.segments.size(), exact().segments.size());
    for (std::size_t i = 0; i < noisy.segments.size(); ++i) {
      const StereoSegment &n = noisy.segments[i], &e = exact().segments[i];
      for (const Vector2d& d :
           {Vector2d(n.left.a_px - e.left.a_px), Vector2d(n.right.b_px - e.right.b_px)}) {
        along.push_back(d.x());
        across.push_back(d.y());
        radii.push_back(d.squaredNorm() / (2 * 0.15 * 0.15));
      }
    }
  }
  expect_distribution(along, normal(0.15));
  expect_distribution(across, normal(0.15));
  expect_distribution(radii, [](double x) { return 1 - std::exp(-x); });  // isotropic
}

TEST(SourceDistributions, StereoMismatch) {
  SourceSettings settings = only(&SourceSettings::stereo_mismatch);
  const Rectification rectified = rectification(rig());
  const auto column = [&](const Vector2d& pixel) {
    const Eigen::Vector3d ray = rectified.R_rectified_right * unproject(rig().cameras[1], pixel);
    return rig().cameras[1].f_px() * ray.x() / ray.z();
  };
  double wrong = 0, lines = 0;
  std::vector<double> slips;
  for (std::uint32_t trial = 0; slips.size() < wanted; ++trial) {
    if (lines >= 2 * wanted) settings.stereo_mismatch = 1;  // the share is known by then
    const StereoObservation sighting = sensed(settings, trial);
    ASSERT_EQ(sighting.segments.size(), exact().segments.size());
    for (std::size_t i = 0; i < sighting.segments.size(); ++i) {
      const Vector2d &now = sighting.segments[i].right.a_px, &then = exact().segments[i].right.a_px;
      if (settings.stereo_mismatch < 1) {
        ++lines;
        wrong += now != then;
      }
      if (now != then) slips.push_back(column(now) - column(then));
    }
  }
  expect_share(wrong, lines, 0.01);
  expect_distribution(slips, uniform(-20, 20));
}

TEST(SourceDistributions, Corners) {
  SourceSettings settings = no_sources();
  settings.corner_loss = SourceSettings{}.corner_loss;
  settings.corner_mismatch = 0.5;  // of 1 %, too few places would be drawn
  settings.corner_sigma_px = 0;
  double pairs = 0, kept = 0, wrong = 0;
  std::vector<double> squared_radii, angles;
  for (std::uint32_t trial = 0; squared_radii.size() < wanted; ++trial) {
    const StereoObservation sighting = sensed(settings, trial);
    pairs += static_cast<double>(seen().corners.size());
    kept += static_cast<double>(sighting.corners.size());
    for (const SensedCorner& corner : sighting.corners) {
      if (!corner.mismatched) continue;
      ++wrong;
      const Eigen::Vector3d in_right = rig().T_camera_first[1] * corner.truth.at_m;
      const Vector2d d = corner.pixel_px[1] - project(rig().cameras[1], in_right);
      squared_radii.push_back(d.squaredNorm());
      angles.push_back(std::atan2(d.y(), d.x()));
    }
  }
  expect_share(kept, pairs, 1 - 0.15);
  expect_share(wrong, kept, 0.5);
  expect_distribution(squared_radii, uniform(0, 100));  // uniform in the disc
  expect_distribution(angles, uniform(-std::numbers::pi, std::numbers::pi));
}

TEST(SourceDistributions, CornerNoise) {
  const SourceSettings settings = only(&SourceSettings::corner_sigma_px);
  std::vector<double> left, right;
  for (std::uint32_t trial = 0; left.size() < wanted; ++trial) {
    for (const SensedCorner& corner : sensed(settings, trial).corners) {
      const Eigen::Vector3d in_right = rig().T_camera_first[1] * corner.truth.at_m;
      left.push_back((corner.pixel_px[0] - project(rig().cameras[0], corner.truth.at_m)).x());
      right.push_back((corner.pixel_px[1] - project(rig().cameras[1], in_right)).y());
    }
  }
  expect_distribution(left, normal(0.15));
  expect_distribution(right, normal(0.15));
}

// The defaults are the memo's (Tina Memo 2017-001).
TEST(SourceDistributions, DefaultsAreTheMemos) {
  const SourceSettings defaults;
  EXPECT_EQ(defaults.lateral_shift_px, 3);
  EXPECT_EQ(defaults.edge_loss, 0.1125);
  EXPECT_EQ(defaults.endpoint_sigma_px, 0.15);
  EXPECT_EQ(defaults.epipolar_reject_deg, 5);
  EXPECT_EQ(defaults.stereo_mismatch, 0.01);
  EXPECT_EQ(defaults.stereo_mismatch_px, 20);
  EXPECT_EQ(defaults.corner_loss, 0.15);
  EXPECT_EQ(defaults.corner_mismatch, 0.01);
  EXPECT_EQ(defaults.corner_mismatch_px, 10);
  EXPECT_EQ(defaults.calibration, 1);
  for (const double SourceSettings::*off :
       {&SourceSettings::moved, &SourceSettings::mount_height_m, &SourceSettings::mount_pitch_deg,
        &SourceSettings::mount_roll_deg, &SourceSettings::clutter, &SourceSettings::merge_px,
        &SourceSettings::unseen, &SourceSettings::missed}) {
    EXPECT_EQ(defaults.*off, 0);
  }
}

}  // namespace
}  // namespace vernier
