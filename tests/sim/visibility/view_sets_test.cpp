// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility/view_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "calib/error.h"
#include "localise/place.h"
#include "sim/buildings/office.h"
#include "sim/noise_free_view.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "sim/world_file.h"
#include "tests/support/error_message.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::sim::internal;
using localise::Pose2D;

namespace {

const Camera& camera() { return test::nominal_rig().rig.cameras[0]; }
constexpr localise::CameraMount mount{1.2, 0};

/// The small office with sets every half metre, in eight directions.
const World& office_with_sets() {
  static const World world = [] {
    World office = test::small_office();
    office.view_sets = view_sets(test::small_office_visibility(), camera(), mount,
                                 map_poses(office.route, 0.5, 8));
    return office;
  }();
  return world;
}

TEST(ViewSets, AtTheirReferenceHoldWhatIsSeenAndNoPartOfItIsHidden) {
  const World& world = office_with_sets();
  const Visibility by_sets(world, VisibilityMethod::view_sets);
  VisibilityOptions any_length;
  any_length.min_length_px = 0;
  for (std::size_t i = 0; i < world.view_sets.size(); i += 7) {
    const ViewSet& set = world.view_sets[i];
    const Pose T = T_left_world(set.at, mount);
    const auto runs = by_sets.visible_intervals(camera(), T, any_length);
    const auto exact = test::small_office_visibility().visible_intervals(camera(), T);
    std::vector<int> seen;
    for (const VisibleInterval& run : runs) {
      if (seen.empty() || seen.back() != run.segment) seen.push_back(run.segment);
    }
    EXPECT_EQ(seen, set.segments);
    // What is exactly seen lies within the whole of the same edge.
    for (const VisibleInterval& run : exact) {
      EXPECT_TRUE(std::any_of(runs.begin(), runs.end(), [&](const VisibleInterval& whole) {
        return whole.segment == run.segment && whole.t0 <= run.t0 + 1e-9 &&
               whole.t1 >= run.t1 - 1e-9;
      }));
    }
  }
}

TEST(ViewSets, TheNearestInPlaceAndHeadingIsTaken) {
  const std::vector<ViewSet> sets{{{0, 0, 0}, {0}}, {{0.6, 0, 0}, {1}}, {{0, 0, 0.7}, {2}}};
  const auto chosen = [&](const Pose2D& pose) {
    const ViewSet* set = nearest_set(sets, pose);
    return set ? set->segments[0] : -1;
  };
  EXPECT_EQ(chosen({0.1, 0.1, 0.1}), 0);
  EXPECT_EQ(chosen({0.5, 0, 0}), 1);
  EXPECT_EQ(chosen({0, 0, 0.6}), 2);
  EXPECT_EQ(chosen({0, 0, 0.6 - 2 * std::numbers::pi}), 2);
  EXPECT_EQ(chosen({0, 1.1, 0}), -1);
  EXPECT_EQ(chosen({0, 0, 2}), -1);
}

TEST(ViewSets, AgreeLessTheFurtherTheyAreApart) {
  const std::vector<Pose2D> poses = [] {
    std::vector<Pose2D> all;
    for (int i = 0; i < 40; ++i) {
      const RoutePoint at = route_point(test::small_office().route, 0.3 + 0.2 * i);
      all.push_back({at.pose.x_m, at.pose.y_m + 0.1, at.pose.heading_rad + 0.15});
    }
    return all;
  }();
  const SetAgreement fine = set_agreement(office_with_sets(), camera(), mount, poses);
  EXPECT_GT(fine.precision, 0.5);
  EXPECT_LT(fine.precision, 1);  // sets know no partial occlusion
  EXPECT_GT(fine.recall, 0.7);
  EXPECT_LT(fine.recall, 1);
  World coarse = test::small_office();
  coarse.view_sets =
      view_sets(test::small_office_visibility(), camera(), mount, map_poses(coarse.route, 2, 4));
  const SetAgreement less = set_agreement(coarse, camera(), mount, poses);
  EXPECT_LT(less.recall, fine.recall);
  // At their own references all that is seen is in the sets.
  std::vector<Pose2D> references;
  for (const ViewSet& set : office_with_sets().view_sets) references.push_back(set.at);
  EXPECT_NEAR(set_agreement(office_with_sets(), camera(), mount, references).recall, 1, 1e-9);
}

// The right eye of a pair may be out of reach of the left one's reference.
TEST(ViewSets, OfAPairAreThoseOfTheLeftEye) {
  World world = test::small_office();
  const Pose2D reference = office_with_sets().view_sets[8].at;
  world.view_sets = {office_with_sets().view_sets[8]};
  const Visibility by_sets(world, VisibilityMethod::view_sets);
  const double c = std::cos(reference.heading_rad), s = std::sin(reference.heading_rad);
  std::size_t seen_far = 0;
  for (const double aside : {0.0, 0.5, 0.85, 0.95}) {  // to the right, where the right eye is
    const Pose2D pose{reference.x_m + aside * s, reference.y_m - aside * c, reference.heading_rad};
    const NoiseFreeView seen = look(by_sets, test::nominal_rig().rig, pose);
    EXPECT_GT(seen.edges.size(), 20u) << aside;
    seen_far = seen.edges.size();
  }
  EXPECT_GT(seen_far, 20u);
  const Pose2D beyond{reference.x_m + 1.05 * s, reference.y_m - 1.05 * c, reference.heading_rad};
  EXPECT_TRUE(look(by_sets, test::nominal_rig().rig, beyond).edges.empty());
}

TEST(ViewSets, AreWrittenAndRead) {
  WorldDescription office = make_office(2, {.size_m = {6, 8, 2.5}});
  office.view_sets = {{{1.5, -2.25, 0.5}, {0, 3, 7}}, {{1, 2, 0}, {}}};
  const std::string text = format_world(office);
  const WorldDescription read = parse_world(text, "text");
  EXPECT_EQ(format_world(read), text);
  ASSERT_EQ(read.view_sets.size(), 2u);
  EXPECT_EQ(read.view_sets[0].segments, (std::vector<int>{0, 3, 7}));
  EXPECT_EQ(read.view_sets[0].at.y_m, -2.25);
  EXPECT_NEAR(read.view_sets[0].at.heading_rad, 0.5, 1e-6);
}

TEST(ViewSets, BadOnesAreNamed) {
  const std::string head =
      "format = \"vernier/world\"\nversion = 1\n[loose]\nsegments = [\n"
      "[0, 0, 0, 1, 0, 0],\n]\n[[view_dependency]]\nat_m = [0, 0]\n";
  const auto said = [&](const std::string& rest) {
    return test::error_message([&] { build_world(parse_world(head + rest, "w.toml")); });
  };
  EXPECT_EQ(said("heading_deg = 0\nsegments = [0]\n"), "");
  EXPECT_NE(said("heading_deg = 0\nsegments = [1]\n").find("is not one of the world's 1"),
            std::string::npos);
  EXPECT_NE(said("heading_deg = 0\nsegments = [\n0, 0]\n").find("w.toml:11"), std::string::npos);
  EXPECT_NE(said("segments = [0]\n").find("heading_deg"), std::string::npos);
  EXPECT_NE(said("heading_deg = 0\nradius = 1\nsegments = []\n").find("radius"), std::string::npos);
  EXPECT_NE(test::error_message([&] {
              const Visibility none(test::small_office(), VisibilityMethod::view_sets);
            }).find("has no view sets"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
