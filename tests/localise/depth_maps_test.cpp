// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/depth_maps.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/error_message.h"

namespace vernier::localise::internal {
namespace {

using test::error_message;
using Paths = std::vector<std::filesystem::path>;

TEST(DepthMaps, AreOfTheNameOrTheNumberWhereverTheyStand) {
  const Paths images{"img10.png", "img9.png", "img2.png"};
  EXPECT_EQ(depth_maps_of_images(images, {"d/img10.pgm", "d/img2.pgm", "d/img9.pgm"}, "here"),
            (Paths{"d/img10.pgm", "d/img9.pgm", "d/img2.pgm"}));
  EXPECT_EQ(depth_maps_of_images(images, {"d/0002.png", "d/0009.png", "d/0010.png"}, "here"),
            (Paths{"d/0010.png", "d/0009.png", "d/0002.png"}));
  // the same name goes before the same number
  EXPECT_EQ(depth_maps_of_images({"b1.png", "a2.png"}, {"c2.png", "a2.png", "b1.png"}, "here"),
            (Paths{"b1.png", "a2.png"}));
}

TEST(DepthMaps, MayBeMoreThanTheImages) {
  const Paths maps{"0001.png", "0002.png", "0003.png", "0004.png"};
  EXPECT_EQ(depth_maps_of_images({"rgb4.png", "rgb2.png"}, maps, "here"),
            (Paths{"0004.png", "0002.png"}));
}

TEST(DepthMaps, AreOfTheNearestTimeWithinTwentyMilliseconds) {
  const Paths images{"1305031102.20.png", "1305031102.10.png"};
  const Paths maps{"1305031102.115.png", "1305031102.108.png", "1305031102.219.png"};
  EXPECT_EQ(depth_maps_of_images(images, maps, "here"),
            (Paths{"1305031102.219.png", "1305031102.108.png"}));
  // 21 ms away; and one that belongs to another image, which is nearer
  for (const char* map : {"1305031102.221.png", "1305031102.101.png"}) {
    EXPECT_EQ(depth_maps_by_time(images, {map})[0], "") << map;
  }
  EXPECT_NE(error_message([&] {
              depth_maps_of_images(images, {"1305031102.10.png", "1305031102.30.png"}, "--depth d");
            }).find("--depth d: has no map of \"1305031102.20.png\""),
            std::string::npos);
}

TEST(DepthMaps, AreInOrderOnlyWhereNoNameSaysOtherwise) {
  EXPECT_EQ(depth_maps_of_images({"left.png", "right.png"}, {"a.png", "b.png"}, "here"),
            (Paths{"a.png", "b.png"}));
  EXPECT_EQ(
      depth_maps_of_images({"f1_640.png", "f2_640.png"}, {"d1_480.png", "d2_480.png"}, "here"),
      (Paths{"d1_480.png", "d2_480.png"}));
  // one of two is there: the other is not the rest
  EXPECT_NE(error_message([] {
              depth_maps_of_images({"a1.png", "a2.png"}, {"b2.png", "b3.png"}, "here");
            }).find("here: has no map of \"a1.png\"; give"),
            std::string::npos);
  EXPECT_NE(error_message([] {
              depth_maps_of_images({"a1.png", "a2.png", "a3.png"}, {"b2.png"}, "here");
            }).find("has no map of \"a1.png\" and 1 more of the 3 images"),
            std::string::npos);
  EXPECT_NE(error_message([] { depth_maps_of_images({"a.png"}, {}, "here"); }), "");
}

}  // namespace
}  // namespace vernier::localise::internal
