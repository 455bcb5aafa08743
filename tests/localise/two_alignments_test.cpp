// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <type_traits>

#include "localise/verification/alignment.h"
#include "stereo/image/patch_alignment.h"

namespace vernier {
namespace {

// A view aligned with a node of a map and a patch aligned with another image are different things
// of one name: a unit may use both, and the linker must not take one for the other.
static_assert(!std::is_same_v<localise::internal::Alignment, stereo::internal::Alignment>);
static_assert(
    !std::is_same_v<localise::internal::AlignmentOptions, stereo::internal::AlignmentOptions>);

TEST(TwoAlignments, AreUsedInOneUnit) {
  const localise::internal::Alignment of_views = localise::internal::align({}, {});
  const stereo::internal::Alignment of_patches{{1, 2}, Eigen::Matrix2d::Identity(), 0.5};
  EXPECT_EQ(of_views.score, 0);
  EXPECT_EQ(of_patches.score, 0.5);
  EXPECT_EQ(stereo::internal::AlignmentOptions().half_px, 7);
  EXPECT_EQ(localise::internal::AlignmentOptions().max_shift_m, 1.5);
}

}  // namespace
}  // namespace vernier
