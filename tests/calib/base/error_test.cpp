// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/error.h"

#include <gtest/gtest.h>

#include <string>
#include <type_traits>
#include <utility>

namespace vernier {
namespace {

TEST(Error, GivesPlaceFaultAndRemedyApart) {
  const Error error("rig.json: cameras[0]", "f_px is missing", "give it");
  EXPECT_STREQ(error.what(), "rig.json: cameras[0]: f_px is missing; give it");
  EXPECT_EQ(error.place(), "rig.json: cameras[0]");
  EXPECT_EQ(error.fault(), "f_px is missing");
  EXPECT_EQ(error.remedy(), "give it");
}

TEST(Error, NeedsNoRemedy) {
  const Error error("rig.json", "is empty", "");
  EXPECT_STREQ(error.what(), "rig.json: is empty");
  EXPECT_EQ(error.remedy(), "");
}

TEST(Error, IsCopiedWithoutThrowing) {
  EXPECT_TRUE(std::is_nothrow_copy_constructible_v<Error>);
  EXPECT_TRUE(std::is_nothrow_copy_assignable_v<Error>);
  Error first("a", "b", "c");
  const Error second(std::move(first));
  EXPECT_EQ(first.fault(), "b");  // moved from: an Error is copied
  EXPECT_EQ(second.fault(), "b");
}

}  // namespace
}  // namespace vernier
