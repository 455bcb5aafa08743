// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/uncertainty_source.h"
#include "sim/world.h"
#include "stereo/reconstruction/triangulate.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim::internal;
using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

/// A look at the office with corners, and sightings of it under given settings.
class Sources : public testing::Test {
 protected:
  static const NoiseFreeView& seen() { return test::office_look(); }
  static StereoObservation sense(const SourceSettings& settings, std::uint32_t trial = 0) {
    return Sensor(test::nominal_rig().rig, settings, 1e-6)
        .sense(seen(), {.seed = 7, .trial = trial});
  }
  static const StereoObservation& exact() {
    static const StereoObservation sighting = sense(no_sources());
    return sighting;
  }
  static Eigen::Vector2d normal(const ImageSegment& s) {
    const Eigen::Vector2d d = (s.b_px - s.a_px).normalized();
    return {-d.y(), d.x()};
  }
  /// Column and row of a right pixel in the rectified image, in pixels from its centre.
  static Eigen::Vector2d rectified_right(const Eigen::Vector2d& pixel) {
    const Camera& right = test::nominal_rig().rig.cameras[1];
    static const Rectification r = rectification(test::nominal_rig().rig);
    return right.f_px() * (r.R_rectified_right * unproject(right, pixel)).hnormalized();
  }
  /// Displacement of every end in every eye between two sightings, by the segments' features.
  static std::map<std::uint32_t, Eigen::Matrix<double, 8, 1>> moved(const StereoObservation& from,
                                                                    const StereoObservation& to) {
    std::map<std::uint32_t, Eigen::Matrix<double, 8, 1>> all;
    if (from.segments.size() != to.segments.size()) return all;
    for (std::size_t i = 0; i < to.segments.size(); ++i) {
      const StereoSegment &a = from.segments[i], &b = to.segments[i];
      all[b.feature] << b.left.a_px - a.left.a_px, b.left.b_px - a.left.b_px,
          b.right.a_px - a.right.a_px, b.right.b_px - a.right.b_px;
    }
    return all;
  }
};

/// Half the width of a binomial count's two-sided interval at a false-alarm rate of 1e-3.
double binomial_reach(double trials, double share) {
  return normal_quantile(1 - 5e-4) * std::sqrt(trials * share * (1 - share)) + 0.5;
}

/// Mean of the end points of each object's segments in the world.
std::vector<Eigen::Vector3d> centroids(const World& world) {
  std::vector<Eigen::Vector3d> sums(world.objects.size(), Eigen::Vector3d::Zero());
  std::vector<double> counts(world.objects.size(), 0);
  for (const WorldSegment& segment : world.segments) {
    sums[segment.object] += segment.a_m + segment.b_m;
    counts[segment.object] += 2;
  }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= std::max(1.0, counts[i]);
  return sums;
}

/// By how much each object edge seen from a place is shifted away from its object's centroid, by
/// the world's segments; edges through the centroid have no such side and are left out.
std::map<int, double> outward_shifts(const Sensor& sensor,
                                     const Sensor& exact,
                                     const Pose2D& place,
                                     std::uint32_t frame) {
  static const std::vector<Eigen::Vector3d> centre_m = centroids(test::small_office());
  const NoiseFreeView seen = look(test::small_office_visibility(), sensor.rig(), place);
  const Pose T_left = T_left_world(place, NoiseFreeViewOptions{}.mount);
  const StereoObservation shifted = sensor.sense(seen, {.seed = 7, .frame = frame}),
                          e = exact.sense(seen, {.seed = 7});
  std::map<int, double> outward;
  for (std::size_t i = 0; i < shifted.segments.size(); ++i) {
    const VisibleEdge& edge = e.true_edges[i];
    const Eigen::Vector3d n = edge.a_m.cross(edge.b_m).normalized();
    const double side = n.dot(T_left * centre_m[edge.object]);
    if (edge.object == 0 || std::abs(side) < 1e-6) continue;
    const ImageSegment &from = e.segments[i].left, &to = shifted.segments[i].left;
    const Eigen::Vector2d d = (from.b_px - from.a_px).normalized();
    const double shift = (to.a_px - from.a_px).dot(Eigen::Vector2d(-d.y(), d.x()));
    outward[edge.segment] = side > 0 ? -shift : shift;
  }
  return outward;
}

TEST_F(Sources, LateralShiftMovesBothEyesAlikeAlongTheNormal) {
  SourceSettings settings = no_sources();
  settings.lateral_shift_px = 3;
  const StereoObservation shifted = sense(settings);
  ASSERT_EQ(shifted.segments.size(), exact().segments.size());
  for (std::size_t i = 0; i < shifted.segments.size(); ++i) {
    const StereoSegment &s = shifted.segments[i], &e = exact().segments[i];
    const Eigen::Vector2d left = s.left.a_px - e.left.a_px, right = s.right.a_px - e.right.a_px;
    EXPECT_LT((left - (s.left.b_px - e.left.b_px)).norm(), 1e-9);  // the whole edge
    const double size = left.dot(normal(e.left));
    EXPECT_NEAR(std::abs(size), left.norm(), 1e-9);
    EXPECT_GE(left.norm(), 1.5 - 1e-9);
    EXPECT_LE(left.norm(), 4.5 + 1e-9);
    EXPECT_NEAR(right.dot(normal(e.right)) / size, 1, 0.05);  // cameras that are nearly alike
  }
}

/// An edge displaced in space keeps its depth, whatever the cameras are: by triangulation of both
/// ends. Steep ones only, whose depth a pair tells, and no long ones, which lenses bend.
TEST_F(Sources, CommonLateralShiftsLeaveTheDepthAsItIs) {
  Rig longer = test::nominal_rig().rig, stretched = longer, fisheye = longer, rolled = longer;
  longer.cameras[1].parameters[0] *= 1.5;
  stretched.cameras[0].parameters[1] = 1.3;
  stretched.cameras[1].parameters[1] = 0.8;
  fisheye.cameras[0].model = Fisheye4{};
  fisheye.cameras[0].parameters.conservativeResize(8);
  fisheye.cameras[0].parameters.tail<4>() << -0.02, 0.005, 0, 0;
  const Eigen::Matrix3d roll = rotation_from_vector({0, 0, 0.4});
  rolled.T_camera_first[1] = {roll * rolled.T_camera_first[1].R, roll * rolled.T_camera_first[1].t};
  for (const Rig& rig : {longer, stretched, fisheye, rolled}) {
    SourceSettings settings = no_sources();
    const StereoObservation clean = Sensor(rig, settings, 1e-6).sense(seen(), {.seed = 7});
    settings.lateral_shift_px = 1;
    const StereoObservation shifted = Sensor(rig, settings, 1e-6).sense(seen(), {.seed = 7});
    ASSERT_EQ(shifted.segments.size(), clean.segments.size());
    int compared = 0;
    for (std::size_t i = 0; i < shifted.segments.size(); ++i) {
      const ImageSegment& line = clean.segments[i].left;
      const Eigen::Vector2d d = (line.b_px - line.a_px).cwiseAbs();
      if (d.y() < d.x() || line.length_px() > 150) continue;
      const SpaceSegment before = triangulate(rig, clean.segments[i]);
      const SpaceSegment after = triangulate(rig, shifted.segments[i]);
      if (!before.reliable || !after.reliable) continue;
      ++compared;
      EXPECT_NEAR(after.a_m.z() / before.a_m.z(), 1, 0.01) << i;
      EXPECT_NEAR(after.b_m.z() / before.b_m.z(), 1, 0.01) << i;
    }
    EXPECT_GT(compared, 10) << clean.segments.size();
  }
}

// Every edge of an object that two consecutive places see.
TEST_F(Sources, LateralShiftStaysWithTheSurface) {
  SourceSettings settings = no_sources();
  settings.lateral_shift_px = 3;
  const Rig& rig = test::nominal_rig().rig;
  const Sensor sensor(rig, settings), clean(rig, no_sources());
  const auto places = map_poses(test::small_office().route, 0.5);
  std::map<int, double> before;
  int both = 0, in = 0;
  for (std::uint32_t frame = 0; frame < places.size(); ++frame) {
    const auto now = outward_shifts(sensor, clean, places[frame], frame);
    for (const auto& [segment, shift] : now) {
      EXPECT_GE(std::abs(shift), 1.5 - 1e-9);
      EXPECT_LE(std::abs(shift), 4.5 + 1e-9);
      const auto last = before.find(segment);
      if (last == before.end()) continue;
      EXPECT_NEAR(last->second, shift, 1e-9) << "segment " << segment << " at place " << frame;
      ++both;
      in += shift < 0;
    }
    before = now;
  }
  EXPECT_GT(both, 500);
  EXPECT_GT(in, both / 10);
  EXPECT_LT(in, both - both / 10);
}

TEST_F(Sources, IndependentShiftsDifferBetweenEyes) {
  SourceSettings settings = no_sources();
  settings.lateral_shift_px = 3;
  settings.lateral_shift_mode = ShiftMode::independent;
  const StereoObservation shifted = sense(settings);
  int differ = 0;
  for (std::size_t i = 0; i < shifted.segments.size(); ++i) {
    const double left = (shifted.segments[i].left.a_px - exact().segments[i].left.a_px).norm();
    const double right = (shifted.segments[i].right.a_px - exact().segments[i].right.a_px).norm();
    differ += std::abs(left - right) > 0.01;
  }
  EXPECT_GT(differ, static_cast<int>(0.9 * static_cast<double>(shifted.segments.size())));
}

TEST_F(Sources, EdgeLossTakesExactlyItsShareAndKeepsTheRestOnTheEdge) {
  SourceSettings settings = no_sources();
  settings.edge_loss = 0.2;
  const StereoObservation left_over = sense(settings);
  std::map<std::uint32_t, double> kept;
  for (const StereoSegment& s : left_over.segments) {
    kept[s.feature / 2] += s.left.length_px();
  }
  // With little distortion lengths along chord and curve agree to a few parts in 1e4.
  for (const StereoSegment& e : exact().segments) {
    ASSERT_TRUE(kept.contains(e.feature / 2));
    EXPECT_NEAR(kept[e.feature / 2] / e.left.length_px(), 0.8, 5e-3);
  }
}

TEST_F(Sources, EdgeLossLeavesPiecesWhoseEndsLieOnTheEdge) {
  SourceSettings settings = no_sources();
  settings.edge_loss = 0.2;
  const Rig& rig = test::nominal_rig().rig;
  std::map<std::uint32_t, VisibleEdge> truth;
  for (const VisibleEdge& edge : seen().edges) truth[edge.feature] = edge;
  const StereoObservation left_over = sense(settings);
  EXPECT_GT(left_over.segments.size(), seen().edges.size());
  for (const StereoSegment& s : left_over.segments) {
    const VisibleEdge& edge = truth.at(s.feature / 2);
    for (int eye = 0; eye < 2; ++eye) {
      const Eigen::Vector3d a = (rig.T_camera_first[eye] * edge.a_m).normalized();
      const Eigen::Vector3d b = (rig.T_camera_first[eye] * edge.b_m).normalized();
      const Eigen::Vector3d n = a.cross(b).normalized();
      const ImageSegment& piece = eye == 0 ? s.left : s.right;
      for (const Eigen::Vector2d& end : {piece.a_px, piece.b_px}) {
        const Eigen::Vector3d ray = unproject(rig.cameras[eye], end).normalized();
        EXPECT_LT(std::abs(n.dot(ray)), 1e-9);
        EXPECT_GT(n.dot(a.cross(ray)), -1e-9);
        EXPECT_GT(n.dot(ray.cross(b)), -1e-9);
      }
    }
  }
}

TEST_F(Sources, EndpointErrorMovesEndsOnly) {
  SourceSettings settings = no_sources();
  settings.endpoint_sigma_px = 0.15;
  const StereoObservation noisy = sense(settings);
  ASSERT_EQ(noisy.segments.size(), exact().segments.size());
  double sum = 0;
  for (std::size_t i = 0; i < noisy.segments.size(); ++i) {
    const Eigen::Vector2d e = noisy.segments[i].left.a_px - exact().segments[i].left.a_px;
    EXPECT_LT(e.norm(), 1.0);
    sum += e.squaredNorm();
    EXPECT_NE(e, noisy.segments[i].right.a_px - exact().segments[i].right.a_px);
  }
  EXPECT_GT(sum, 0);
}

// Of a lens whose image ends at 90 degrees, noise moves ends of lines there beyond it: they are
// lost to stereo, and nothing fails.
TEST_F(Sources, EndsBeyondTheFieldOfAWideLensAreLost) {
  Rig wide = test::nominal_rig().rig;
  for (Camera& camera : wide.cameras) {
    camera.model = Fisheye4{};
    camera.parameters.resize(8);
    camera.parameters << 180, 1, 319.5, 239.5, 0, 0, 0, 0;
  }
  SourceSettings settings;
  settings.endpoint_sigma_px = 3;
  settings.stereo_mismatch = 0.5;
  const Sensor sensor(wide, settings, 1e-6);
  int beyond = 0;
  for (const Pose2D& pose : map_poses(test::small_office().route, 1)) {
    const NoiseFreeView view = look(test::small_office_visibility(), wide, pose);
    for (std::uint32_t trial = 0; trial < 5; ++trial) {
      const StereoObservation seen = sensor.sense(view, {.seed = 8, .trial = trial});
      for (const ImageSegment& s : seen.left_only) {
        beyond +=
            !try_unproject(wide.cameras[0], s.a_px) || !try_unproject(wide.cameras[0], s.b_px);
      }
      for (const StereoSegment& s : seen.segments) {
        EXPECT_TRUE(try_unproject(wide.cameras[0], s.left.a_px));
        EXPECT_TRUE(try_unproject(wide.cameras[0], s.left.b_px));
      }
    }
  }
  EXPECT_GT(beyond, 0);
}

TEST_F(Sources, EpipolarRejectionDropsFlatLinesOnly) {
  SourceSettings settings = no_sources();
  settings.epipolar_reject_deg = 5;
  const StereoObservation steep = sense(settings);
  std::set<std::uint32_t> kept;
  for (const StereoSegment& s : steep.segments) kept.insert(s.feature);
  const Rig& rig = test::nominal_rig().rig;
  const Rectification r = rectification(rig);
  for (const StereoSegment& e : exact().segments) {
    EXPECT_EQ(kept.contains(e.feature),
              epipolar_angle_rad(rig, r, e.left) >= 5 * 0.017453292519943295);
  }
  EXPECT_LT(steep.segments.size(), exact().segments.size());
  // One eye still sees the others, where they are.
  ASSERT_EQ(steep.segments.size() + steep.left_only.size(), exact().segments.size());
  EXPECT_TRUE(exact().left_only.empty());
  std::size_t flat = 0;
  for (const StereoSegment& e : exact().segments) {
    if (kept.contains(e.feature)) continue;
    EXPECT_EQ(steep.left_only[flat].a_px, e.left.a_px);
    EXPECT_EQ(steep.left_only[flat].b_px, e.left.b_px);
    ++flat;
  }
}

// Seed 7. Slips are uniform: half to either side and three quarters beyond 5 px, two-sided
// false-alarm rate 1e-3 each (normal approximation).
TEST_F(Sources, StereoMismatchMovesTheRightLineAlongItsEpipolarLine) {
  SourceSettings settings = no_sources();
  settings.stereo_mismatch = 1;
  settings.stereo_mismatch_px = 20;
  const StereoObservation wrong = sense(settings);
  ASSERT_EQ(wrong.segments.size(), exact().segments.size());
  const auto n = static_cast<double>(wrong.segments.size());
  double to_the_right = 0, far = 0;
  for (std::size_t i = 0; i < wrong.segments.size(); ++i) {
    const StereoSegment &w = wrong.segments[i], &e = exact().segments[i];
    EXPECT_EQ(w.left.a_px, e.left.a_px);
    EXPECT_EQ(w.left.b_px, e.left.b_px);
    const Eigen::Vector2d a = rectified_right(w.right.a_px) - rectified_right(e.right.a_px);
    const Eigen::Vector2d b = rectified_right(w.right.b_px) - rectified_right(e.right.b_px);
    EXPECT_LT((a - b).norm(), 1e-6);  // the whole line
    EXPECT_NEAR(a.y(), 0, 1e-6);
    EXPECT_NE(w.right.a_px, e.right.a_px);
    EXPECT_LE(std::abs(a.x()), 20 + 1e-6);
    to_the_right += a.x() > 0;
    far += std::abs(a.x()) > 5;
  }
  EXPECT_NEAR(to_the_right, 0.5 * n, binomial_reach(n, 0.5));
  EXPECT_NEAR(far, 0.75 * n, binomial_reach(n, 0.75));
}

// Seed 7, two-sided false-alarm rate 1e-3 (normal approximation).
TEST_F(Sources, StereoMismatchMovesItsShareOfLines) {
  SourceSettings settings = no_sources();
  settings.stereo_mismatch = 0.5;
  settings.stereo_mismatch_px = 20;
  double wrong = 0, n = 0;
  for (std::uint32_t trial = 0; trial < 10; ++trial) {
    for (const auto& [feature, d] : moved(exact(), sense(settings, trial))) {
      wrong += d.norm() > 0;
      ++n;
    }
  }
  EXPECT_NEAR(wrong, 0.5 * n, binomial_reach(n, 0.5));
  EXPECT_GE(n, 10.0 * static_cast<double>(exact().segments.size()));
}

TEST_F(Sources, CornerSourcesTouchCornersOnly) {
  SourceSettings settings = no_sources();
  settings.corner_loss = 0.5;
  settings.corner_mismatch = 0.5;
  settings.corner_mismatch_px = 10;
  const StereoObservation sighting = sense(settings);
  for (std::size_t i = 0; i < sighting.segments.size(); ++i) {
    EXPECT_EQ(sighting.segments[i].right.b_px, exact().segments[i].right.b_px);
  }
  EXPECT_LT(sighting.corners.size(), exact().corners.size());
  std::map<std::uint32_t, const SensedCorner*> truth;
  for (const SensedCorner& c : exact().corners) truth[c.truth.feature] = &c;
  for (const SensedCorner& c : sighting.corners) {
    const SensedCorner& e = *truth.at(c.truth.feature);
    EXPECT_EQ(c.pixel_px[0], e.pixel_px[0]);
    const double moved = (c.pixel_px[1] - e.pixel_px[1]).norm();
    EXPECT_LE(moved, 10);
    EXPECT_EQ(c.mismatched, moved > 0);
  }
}

TEST_F(Sources, SwitchingOneOnLeavesTheDrawsOfOthers) {
  SourceSettings with = no_sources(), without = no_sources();
  with.endpoint_sigma_px = without.endpoint_sigma_px = 0.15;
  with.corner_loss = 0.3;
  with.stereo_mismatch = 0.5;
  const StereoObservation a = sense(with), b = sense(without);
  ASSERT_EQ(a.segments.size(), b.segments.size());
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    EXPECT_EQ(a.segments[i].left.a_px, b.segments[i].left.a_px);
    EXPECT_EQ(a.segments[i].left.b_px, b.segments[i].left.b_px);
  }
}

TEST_F(Sources, EndpointErrorIsTheSameWhateverActsBeforeIt) {
  SourceSettings bare = no_sources();
  bare.endpoint_sigma_px = 0.15;
  const auto alone = moved(exact(), sense(bare));
  ASSERT_EQ(alone.size(), exact().segments.size());
  for (const auto before : {&SourceSettings::edge_loss, &SourceSettings::lateral_shift_px}) {
    SourceSettings settings = no_sources();
    settings.*before = 0.2;
    const StereoObservation noise_free = sense(settings);
    settings.endpoint_sigma_px = 0.15;
    std::size_t compared = 0;
    for (const auto& [feature, d] : moved(noise_free, sense(settings))) {
      if (feature % 2 != 0) continue;  // a second piece is not there without loss
      EXPECT_LT((d - alone.at(feature)).norm(), 1e-9);
      ++compared;
    }
    EXPECT_GT(compared, alone.size() / 2);
  }
}

TEST_F(Sources, LargerSharesOfMismatchTakeASupersetAndTheSameSlips) {
  SourceSettings little = no_sources(), much = no_sources();
  little.stereo_mismatch = 0.1;
  much.stereo_mismatch = 0.4;
  little.stereo_mismatch_px = much.stereo_mismatch_px = 20;
  const auto a = moved(exact(), sense(little)), b = moved(exact(), sense(much));
  int few = 0, many = 0;
  for (const auto& [feature, d] : a) {
    few += d.norm() > 0;
    many += b.at(feature).norm() > 0;
    if (d.norm() > 0) {
      EXPECT_EQ(d, b.at(feature));
    }
  }
  EXPECT_GT(few, 0);
  EXPECT_GT(many, few);
}

TEST_F(Sources, LargerSharesTakeASuperset) {
  SourceSettings little = no_sources(), much = no_sources();
  little.corner_loss = 0.1;
  much.corner_loss = 0.4;
  std::set<std::uint32_t> kept_of_little;
  for (const SensedCorner& c : sense(little).corners) kept_of_little.insert(c.truth.feature);
  const auto kept_of_much = sense(much).corners;
  EXPECT_LT(kept_of_much.size(), kept_of_little.size());
  for (const SensedCorner& c : kept_of_much) {
    EXPECT_TRUE(kept_of_little.contains(c.truth.feature));
  }
}

TEST_F(Sources, TheSamePlaceGivesTheSameBitsAndAnotherTrialOthers) {
  const StereoObservation a = sense({}, 4), b = sense({}, 4), c = sense({}, 5);
  ASSERT_EQ(a.segments.size(), b.segments.size());
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    EXPECT_EQ(a.segments[i].left.a_px, b.segments[i].left.a_px);
    EXPECT_EQ(a.segments[i].right.b_px, b.segments[i].right.b_px);
  }
  EXPECT_NE(a.segments[0].left.a_px, c.segments[0].left.a_px);
}

TEST_F(Sources, OutOfRangeIsNamed) {
  SourceSettings settings;
  settings.edge_loss = 1.5;
  try {
    Sensor(test::nominal_rig().rig, settings);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "sources: sources.edge_loss = 1.5 is out of range; use 0 to 0.95");
  }
}

}  // namespace
}  // namespace vernier
