// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "sim/sequence/expected_lines.h"
#include "sim/sequence/line_in_view.h"
#include "sim/sequence/measured_sequence.h"
#include "sim/sequence/sequence_file.h"
#include "sim/sequence/sequence_samples.h"
#include "tests/sim/sequence/made_sequence.h"
#include "tests/support/error_message.h"

namespace vernier::sim::internal {
namespace {

using Eigen::Vector3d;
using test::error_message;
using test::MadeErrors;
using test::MadeSequence;

TEST(LineInView, KeepsThePartInTheImageAndItsDepths) {
  const MadeSequence made({}, 1, 3);
  const PlacedCamera camera = placed_camera(made.camera(), Pose{});
  // from 1 m to 3 m, beyond the right border
  const auto line = line_in_view(camera, {0, 0, 1}, {3, 0.3, 3}, 4);
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->from_px.x(), 319.5, 1e-9);
  for (std::size_t i = 0; i < line->at_m.size(); ++i) {
    const Eigen::Vector2d px = camera.pixel(line->at_m[i]);
    EXPECT_LT((px - line->from_px - double(i) * line->along).norm(), 1e-6);
    EXPECT_LE(px.x(), 635 + 1e-9);
    // on the segment: x = 3 t, z = 1 + 2 t
    EXPECT_NEAR(line->at_m[i].z(), 1 + 2 * line->at_m[i].x() / 3, 1e-9);
  }
  EXPECT_GT(line->from_px.x() + line->length_px() * line->along.x(), 633);
  EXPECT_FALSE(line_in_view(camera, {0, 0, -1}, {1, 0, -2}, 4));  // behind
  EXPECT_FALSE(line_in_view(camera, {5, 0, 1}, {5, 1, 1}, 4));    // beside
}

TEST(LineInView, IsHiddenWhereTheDepthsDisagree) {
  const MadeSequence made({}, 1, 3);
  const PlacedCamera camera = placed_camera(made.camera(), Pose{});
  auto line = line_in_view(camera, {-0.5, 0, 2}, {0.5, 0, 2}, 4);
  ASSERT_TRUE(line);
  stereo::internal::DepthImage depth{640, 480, std::vector<float>(640 * 480, 2.0F)};
  for (int y = 0; y < 480; ++y) {
    for (int x = 320; x < 640; ++x) depth.depth_m[y * 640 + x] = x < 400 ? 1.5F : 0.0F;
  }
  keep_where_depths_agree(depth, 0.03, 0.02, *line);
  for (std::size_t i = 0; i < line->at_m.size(); ++i) {
    const double x = line->from_px.x() + double(i);
    EXPECT_EQ(line->shown[i], x < 319.5 ? 1 : 0) << x;  // nearer, then unknown
  }
}

TEST(Sequence, BlocksFollowTheWay) {
  std::vector<SequenceView> views(40);
  for (int v = 0; v < 40; ++v) views[v].T_world_camera.t = {0.5 * v, 0, 0};
  double block_m = 2;
  const std::vector<int> block = blocks_of_way(views, block_m);
  EXPECT_EQ(block[3], 0);
  EXPECT_EQ(block[4], 1);
  EXPECT_EQ(block[39], 9);
  block_m = 10;  // two blocks are too few
  const std::vector<int> equal = blocks_of_way(views, block_m);
  EXPECT_EQ(block_m, 0);
  EXPECT_EQ(equal.back(), 7);
}

TEST(Sequence, TheOrderOfSegmentsAndADepthMapThatIsNotAskedForChangeNothing) {
  MadeErrors errors;
  errors.lost = 0.1;
  MadeSequence made(errors, 3, 12);
  const auto samples = [&] {
    return sequence_samples(made.camera(), made.views(),
                            [&](std::size_t v) { return made.depth(v); });
  };
  const MeasuredSequence before = measure_sequence(samples(), made.views());
  for (SequenceView& view : made.views()) std::reverse(view.segments.begin(), view.segments.end());
  const MeasuredSequence after = measure_sequence(samples(), made.views());
  EXPECT_EQ(before.lines, after.lines);
  EXPECT_NEAR(before.all.loss.value, after.all.loss.value, 1e-3);
  EXPECT_NEAR(before.all.end_across_px.value, after.all.end_across_px.value, 1e-3);
}

TEST(Sequence, WhatASequenceCannotShowKeepsItsDefault) {
  MadeErrors errors;
  errors.lost = 0.2;
  errors.false_share = 0.2;
  const MadeSequence made(errors, 2, 30);
  const MeasuredSequence m = measure_sequence(
      sequence_samples(made.camera(), made.views(), [&](std::size_t v) { return made.depth(v); }),
      made.views());
  for (const SourceEntry& entry : source_entries(m)) {
    const bool measured = entry.key == "missed" || entry.key == "clutter" ||
                          entry.key == "edge_loss" || entry.key == "endpoint_sigma_px" ||
                          entry.key == "stereo_mismatch";
    EXPECT_EQ(entry.written, measured) << entry.key;
    EXPECT_FALSE(entry.note.empty());
    if (entry.key == "missed") {
      EXPECT_NEAR(entry.measured.value, 0.2, 0.04);
    }
    if (entry.key == "clutter") {  // per true edge
      EXPECT_NEAR(entry.measured.value, 0.25, 0.04);
    }
  }
  const std::string text = sources_toml(m);
  EXPECT_NE(text.find("\nedge_loss = "), std::string::npos);
  EXPECT_NE(text.find("\n# lateral_shift_px = 3: default kept"), std::string::npos);
}

TEST(Sequence, RefusesWhatItCannotUse) {
  const MadeSequence made({}, 1, 4);
  const auto of = [](const Camera& camera, std::span<const SequenceView> views) {
    return error_message([&] { sequence_samples(camera, views, {}); });
  };
  EXPECT_NE(of(made.camera(), std::span(made.views()).first(2)).find("three views"),
            std::string::npos);
  Camera bent = made.camera();
  bent.model = Radial1{};
  bent.parameters = Eigen::VectorXd::Zero(5);
  bent.parameters << 500, 1, 319.5, 239.5, -0.1;
  EXPECT_NE(of(bent, made.views()).find("distortion"), std::string::npos);
}

}  // namespace
}  // namespace vernier::sim::internal
