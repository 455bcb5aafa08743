// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sources/source_losses.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "calib/rig_estimate.h"
#include "datasets/shipped.h"
#include "localise/place.h"
#include "sim/buildings/office.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim::internal {
namespace {

double length(const std::vector<SpaceEdge>& edges) {
  double sum = 0;
  for (const auto& [a, b] : edges) sum += (b - a).norm();
  return sum;
}

class SourceLossesTest : public ::testing::Test {
 protected:
  const World world = build_world(make_office(7));
  const Visibility visibility{world};
  const Rig rig = datasets::nominal().rig;
  const NoiseFreeView view = look(visibility, rig, route_point(world.route, 9.0).pose);
  double whole() const {
    double sum = 0;
    for (const VisibleEdge& edge : view.edges) sum += (edge.b_m - edge.a_m).norm();
    return sum;
  }
};

// Property: what is told and what the sources took are together what was seen.
TEST_F(SourceLossesTest, AddUpToWhatIsSeen) {
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    const SensedEdges sensed = source_losses(Sensor(rig, {}), view, {.seed = 3, .trial = trial});
    double lost = 0;
    for (const SourceLosses& source : sensed.sources) lost += length(source.lost);
    EXPECT_GT(lost, 0);
    EXPECT_NEAR(length(sensed.told) + lost, whole(), 1e-6 * whole());
  }
}

// They are those that the sensor gets with the same draw.
TEST_F(SourceLossesTest, AreThoseOfTheSensor) {
  const Sensor sensor(rig, {});
  const SensingDraw draw{.seed = 5, .trial = 8};
  const StereoObservation seen = sensor.sense(view, draw);
  const SensedEdges sensed = source_losses(sensor, view, draw);
  ASSERT_EQ(sensed.told.size(), seen.true_edges.size());
  for (std::size_t i = 0; i < seen.true_edges.size(); ++i) {
    EXPECT_EQ(sensed.told[i].first, seen.true_edges[i].a_m);
    EXPECT_EQ(sensed.told[i].second, seen.true_edges[i].b_m);
  }
}

TEST_F(SourceLossesTest, AreNoneWithoutSources) {
  const SensedEdges sensed = source_losses(Sensor(rig, no_sources()), view, {});
  EXPECT_TRUE(sensed.sources.empty());
  EXPECT_EQ(sensed.told.size(), view.edges.size());
}

// A share of wrong partners shows as edges that are displaced.
TEST_F(SourceLossesTest, NameWhatIsDisplaced) {
  SourceSettings settings = no_sources();
  settings.stereo_mismatch = 1;
  const SensedEdges sensed = source_losses(Sensor(rig, settings), view, {});
  ASSERT_EQ(sensed.sources.size(), 1u);
  EXPECT_EQ(sensed.sources[0].source, "stereo_mismatch");
  EXPECT_GT(sensed.sources[0].displaced.size(), 0.7 * static_cast<double>(view.edges.size()));
  EXPECT_TRUE(sensed.sources[0].lost.empty());
}

}  // namespace
}  // namespace vernier::sim::internal
