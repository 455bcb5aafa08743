// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/segments_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "localise/join/place_segments.h"
#include "localise/place.h"
#include "tests/support/error_message.h"

namespace vernier::localise::internal {
namespace {

SegmentsOfImage example() {
  SegmentsOfImage image{"00003.png", {}};
  ImageSegmentInSpace s{{{10.25, 20}, {300, 21.5}}, {{-1, 0.1, 3}, {1, 0.125, 3.5}, {}}, false};
  s.in_space.covariance_m2.setConstant(1.25e-5);
  s.in_space.covariance_m2.diagonal().setConstant(3e-4);
  image.segments = {s, s};
  image.segments[1].reliable = true;
  return image;
}

std::filesystem::path written(const std::string& text) {
  const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
  const auto file = std::filesystem::path(testing::TempDir()) / ("segments_" + name + ".jsonl");
  std::ofstream(file) << text;
  return file;
}

TEST(SegmentsFile, IsReadAsItWasWritten) {
  const SegmentsOfImage image = example();
  const auto read = read_segments(written(segments_line(image) + segments_line({"b.png", {}})));
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].image, image.image);
  ASSERT_EQ(read[0].segments.size(), 2U);
  EXPECT_EQ(read[0].segments[0].in_space.a_m, image.segments[0].in_space.a_m);
  EXPECT_EQ(read[0].segments[0].in_space.covariance_m2, image.segments[0].in_space.covariance_m2);
  EXPECT_EQ(read[0].segments[0].image_px.b_px, image.segments[0].image_px.b_px);
  EXPECT_FALSE(read[0].segments[0].reliable);
  EXPECT_TRUE(read[0].segments[1].reliable);
  EXPECT_TRUE(read[1].segments.empty());
}

TEST(SegmentsFile, NamesLineAndFault) {
  const std::string good = segments_line(example());
  const auto fault = [&](const std::string& from, const std::string& to) {
    std::string line = good;
    line.replace(line.find(from), from.size(), to);
    return test::error_message([&] { read_segments(written(good + line)); });
  };
  EXPECT_NE(fault("[-1.0,0.1,3.0]", "[-1.0,0.1]").find(":2"), std::string::npos);
  EXPECT_NE(fault("[-1.0,0.1,3.0]", "[-1.0,0.1,3e4]").find("1,000 m"), std::string::npos);
  EXPECT_NE(fault("[-1.0,0.1,3.0]", "[1.0,0.125,3.5]").find("no length"), std::string::npos);
  const std::string same = fault("10.25,20.0", "300.0,21.5");
  EXPECT_NE(same.find(":2: segments[0].image_px: its ends are the same pixel"), std::string::npos)
      << same;
  const std::string indefinite = fault("0.0003", "1e-09");  // beside covariances of 1.25e-05
  EXPECT_NE(indefinite.find(":2: segments[0].covariance_m2: is not positive semidefinite"),
            std::string::npos)
      << indefinite;
  EXPECT_NE(fault("0.0003", "-0.0003").find("variance"), std::string::npos);
  EXPECT_NE(fault("[0.0003,1.25e-05", "[0.0003,1.25e-04").find("symmetric"), std::string::npos);
  EXPECT_NE(fault("[0.0003,1.25e-05,", "[0.0003,").find("covariance_m2"), std::string::npos);
  EXPECT_NE(fault("10.25,", "").find("image_px"), std::string::npos);
  EXPECT_NE(fault("false", "0").find("reliable"), std::string::npos);
  EXPECT_NE(test::error_message([&] { read_segments(written("\n")); }).find("holds no segments"),
            std::string::npos);
}

TEST(PlaceSegments, HaveTheStatedErrorAlongTheRay) {
  PlaceView view;
  view.mount.height_m = 1;
  view.lines = {{{2, 0, 1}, {2, 0, 2}, LineKind::vertical, 0.05},
                {{2, 0, 1}, {2, 1, 1}, LineKind::level, 0.05}};
  const SegmentsOfView made = segments_of_place(view, {3, 0, 0});
  ASSERT_EQ(made.segments.size(), 2U);
  for (const SightedSegment& s : made.segments) {
    EXPECT_NEAR(s.covariance_m2(0, 0), 0.05 * 0.05, 3e-5);
    EXPECT_NEAR(s.covariance_m2(1, 1), 0.005 * 0.005, 1e-9);
  }
  // both ends of an upright line err alike
  EXPECT_GT(made.segments[0].covariance_m2(0, 3), 0.8 * 0.05 * 0.05);
  EXPECT_EQ(made.segments[1].covariance_m2(0, 3), 0);
  EXPECT_NO_THROW(join_lines(std::vector{made, made}));
}

}  // namespace
}  // namespace vernier::localise::internal
