// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "calib/statistics/random.h"
#include "sim/images/materials.h"
#include "sim/images/surface_appearance.h"
#include "sim/images/texture.h"
#include "sim/images/wire_paint.h"
#include "tests/support/painted_room.h"
#include "tests/support/small_office.h"

namespace vernier::test {
namespace {

using vernier::internal::RandomStream;

double rms(const Texture& texture, double blur_m) {
  double sum2 = 0;
  int count = 0;
  for (double y = 0; y < 4; y += 0.037) {
    for (double x = 0; x < 4; x += 0.041, ++count) sum2 += std::pow(texture.at(x, y, blur_m), 2);
  }
  return std::sqrt(sum2 / count);
}

TEST(Texture, HasUnitRmsAndLosesItToBlur) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    RandomStream draws({.seed = seed});
    const Texture texture(0.2, draws);
    EXPECT_NEAR(rms(texture, 0), 1, 0.05);
    // The longest waves, of 0.16 to 0.25 m, have 16/21 of the power.
    const double half = rms(texture, 0.03);
    EXPECT_LT(half, 0.85);
    EXPECT_GT(half, 0.3);
    EXPECT_LT(rms(texture, 0.3), 1e-6);
  }
}

TEST(Texture, BlursAsAGaussianDoes) {
  RandomStream draws({.seed = 3});
  const Texture texture(0.2, draws);
  constexpr double s = 0.02, step = 0.2;
  for (const double x : {0.1, 1.7, 33.0}) {
    double sum = 0, whole = 0;
    for (double i = -5; i <= 5; i += step) {
      for (double j = -5; j <= 5; j += step) {
        const double w = std::exp(-(i * i + j * j) / 2);
        sum += w * texture.at(x + s * i, 0.4 + s * j, 0);
        whole += w;
      }
    }
    EXPECT_NEAR(texture.at(x, 0.4, s), sum / whole, 2e-4);
  }
}

TEST(WirePaint, FindsBordersOutlinesLinesAndBars) {
  const World world = panel_room();
  const WirePaint paint = wire_paint(world, {});
  std::array<int, appearance_count> counts{};
  for (const EdgeAppearance a : paint.of_segment) ++counts[static_cast<std::size_t>(a)];
  EXPECT_EQ(counts, (std::array<int, 4>{8, 4, 1, 1}));
  ASSERT_EQ(paint.figures.size(), 2U);
  ASSERT_EQ(paint.bars.size(), 1U);
  EXPECT_EQ(world.segments[static_cast<std::size_t>(paint.bars[0].segment)].a_m,
            Eigen::Vector3d(2.5, 1, 0.5));
}

TEST(WirePaint, LeavesDoorwaysOpen) {
  // A doorway's outline closes, but what it encloses has no surface behind.
  for (const PaintedFigure& figure : wire_paint(small_office(), {}).figures) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& x : figure.polygon_m) box.extend(x);
    EXPECT_LT(std::max(box.sizes().x(), box.sizes().y()) * box.sizes().z(), 2.2);
  }
}

TEST(Materials, AreThoseOfTheTemplateWithATextureOfTheObject) {
  World world = small_office();
  const Materials all = materials(world, {});
  std::map<std::pair<std::string, int>, double> known;
  std::map<int, int> seen;
  int repeated = 0;
  for (std::size_t i = 0; i < world.surfaces.size(); ++i) {
    const int object = world.surfaces[i].object;
    const std::string& name = world.objects[static_cast<std::size_t>(object)].template_name;
    if (name.empty()) continue;
    const double r = all.list[static_cast<std::size_t>(all.of_surface[i])].reflectance;
    EXPECT_GE(r, 0.25);
    EXPECT_LE(r, 0.85);
    const auto [at, is_new] = known.emplace(std::pair{name, seen[object]++}, r);
    if (is_new) continue;
    EXPECT_EQ(r, at->second);
    ++repeated;
  }
  EXPECT_GT(repeated, 100);
}

TEST(Materials, SwitchingTextureOffLeavesReflectances) {
  SurfaceAppearanceOptions plain;
  plain.texture_contrast = 0;
  const Materials a = materials(small_office(), {}), b = materials(small_office(), plain);
  ASSERT_EQ(a.list.size(), b.list.size());
  for (std::size_t i = 0; i < a.list.size(); ++i) {
    EXPECT_EQ(a.list[i].reflectance, b.list[i].reflectance);
  }
}

}  // namespace
}  // namespace vernier::test
