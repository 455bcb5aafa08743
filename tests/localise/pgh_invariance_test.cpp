// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// What the types of histograms ignore, and what they tell apart, over random sets of lines.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "calib/statistics/random.h"
#include "localise/pgh.h"
#include "localise/place.h"
#include "stereo/segment.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::stereo;

namespace {

constexpr PghType types[] = {PghType::mirror, PghType::rotation, PghType::directed};
constexpr PghBlur blurs[] = {PghBlur::fixed, PghBlur::per_entry};

using LinesOfImage = std::vector<ImageSegment>;
using Room = std::vector<PlaceLine>;

LinesOfImage random_lines_in_image(std::uint64_t seed) {
  LinesOfImage lines;
  for (int i = 0; i < 25; ++i) {
    RandomStream d({.seed = seed, .feature = static_cast<std::uint32_t>(i)});
    const Eigen::Vector2d a{d.uniform(0, 640), d.uniform(0, 480)};
    lines.push_back({a, a + Eigen::Vector2d{d.uniform(-90, 90), d.uniform(-90, 90)}});
  }
  return lines;
}

template <class Move>
LinesOfImage each_end(LinesOfImage lines, Move move) {
  for (ImageSegment& line : lines) line = {move(line.a_px), move(line.b_px)};
  return lines;
}

template <class Move>
Room each_end(Room room, Move move) {
  for (PlaceLine& line : room) {
    line.a_m = move(line.a_m);
    line.b_m = move(line.b_m);
  }
  return room;
}

LinesOfImage moved(const LinesOfImage& lines, std::uint64_t seed) {
  RandomStream d({.seed = seed});
  const Eigen::Rotation2Dd R(d.uniform(-3, 3));
  const Eigen::Vector2d t{d.uniform(-200, 200), d.uniform(-200, 200)};
  return each_end(lines, [&](const Eigen::Vector2d& x) -> Eigen::Vector2d { return R * x + t; });
}

LinesOfImage reflected(const LinesOfImage& lines) {
  return each_end(lines, [](const Eigen::Vector2d& x) { return Eigen::Vector2d(-x.x(), x.y()); });
}

LinesOfImage with_every_second_reversed(LinesOfImage lines) {
  for (std::size_t i = 0; i < lines.size(); i += 2) std::swap(lines[i].a_px, lines[i].b_px);
  return lines;
}

/// Reflected at the plane through the robot along its heading.
Room reflected(const Room& room) {
  return each_end(room, [](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return {x.x(), -x.y(), x.z()};
  });
}

Room with_every_second_reversed(Room room) {
  for (std::size_t i = 0; i < room.size(); i += 2) std::swap(room[i].a_m, room[i].b_m);
  return room;
}

/// Largest difference of two sets of histograms, 1 if they differ in size.
double difference(const Pgh& p, const Pgh& q) {
  if (p.rows.rows() != q.rows.rows() || p.rows.cols() != q.rows.cols()) return 1;
  return (p.rows - q.rows).cwiseAbs().maxCoeff();
}

/// Mean coefficient of lines with themselves.
double likeness(const Pgh& p, const Pgh& q) {
  return p.rows.cwiseProduct(q.rows).rowwise().sum().mean();
}

constexpr double same = 2e-4;    // roots of masses: 4e-8 of a histogram
constexpr double differs = 0.9;  // coefficient below

template <class Check>
void for_all_options(PghOptions options, Check check) {
  for (const PghType type : types) {
    for (const PghBlur blur : blurs) {
      options.type = type;
      options.blur = blur;
      SCOPED_TRACE(testing::Message() << "type " << int(type) << " blur " << int(blur));
      for (std::uint64_t seed = 1; seed <= 5; ++seed) check(options, seed);
    }
  }
}

TEST(PghInvariance, ImageTypesIgnoreWhatTheyClaim) {
  for_all_options(image_pgh_options(), [](const PghOptions& o, std::uint64_t seed) {
    const LinesOfImage lines = random_lines_in_image(seed);
    const Pgh p = image_histograms(lines, o);
    EXPECT_LT(difference(p, image_histograms(moved(lines, seed), o)), same);

    const Pgh mirrored = image_histograms(reflected(lines), o);
    if (o.type == PghType::mirror) {
      EXPECT_LT(difference(p, mirrored), same);
    } else {
      EXPECT_LT(likeness(p, mirrored), differs);
    }
    const Pgh reversed = image_histograms(with_every_second_reversed(lines), o);
    if (o.type == PghType::directed) {
      EXPECT_LT(likeness(p, reversed), differs);
    } else {
      EXPECT_LT(difference(p, reversed), same);
    }
  });
}

/// A turn of the robot and a small shift, so that no line is seen from its other side.
TEST(PghInvariance, FloorAndSpaceTypesIgnoreWhatTheyClaim) {
  for (const auto histograms : {ground_histograms, spatial_histograms}) {
    SCOPED_TRACE(histograms == ground_histograms ? "ground" : "space");
    for_all_options({}, [&](const PghOptions& o, std::uint64_t seed) {
      const Room room = test::random_room(seed);
      const Pgh p = histograms(room, o);
      EXPECT_LT(difference(p, histograms(test::seen_from(room, {0, 0, 0.8}), o)), same);
      if (o.type != PghType::directed) {
        const Pgh shifted = histograms(test::seen_from(room, {0.3, -0.2, 2.5}), o);
        EXPECT_LT(difference(p, shifted), same);
      }
      const Pgh mirrored = histograms(reflected(room), o);
      if (o.type == PghType::mirror) {
        EXPECT_LT(difference(p, mirrored), same);
      } else {
        EXPECT_GT(difference(p, mirrored), 100 * same);
        EXPECT_LT(likeness(p, mirrored), 0.97);
      }
      // Directions do not come from the order of the ends.
      EXPECT_LT(difference(p, histograms(with_every_second_reversed(room), o)), same);
    });
  }
}

/// A line that the robot sees from its other side points the other way.
TEST(PghInvariance, DirectedLinesAreSeenFromASide) {
  const PlaceLine near{{2, -1, 0.5}, {2, 1, 0.5}, LineKind::level};
  const PlaceLine far{{4, -1, 0.5}, {4.5, 1, 0.5}, LineKind::level};
  const Room room{near, far};
  const Room from_between = test::seen_from(room, {3, 0, 0});
  for (const auto histograms : {ground_histograms, spatial_histograms}) {
    const PghOptions mirror, directed{.type = PghType::directed};
    EXPECT_LT(difference(histograms(room, mirror), histograms(from_between, mirror)), same);
    EXPECT_LT(likeness(histograms(room, directed), histograms(from_between, directed)), 0.1);
  }
}

/// Folding the histograms of a type gives those of the next coarser one.
TEST(PghInvariance, EachTypeIsAFoldOfTheNext) {
  const LinesOfImage lines = random_lines_in_image(7);
  PghOptions o = image_pgh_options();
  o.type = PghType::directed;
  const Pgh directed = image_histograms(lines, o);
  o.type = PghType::rotation;
  const Pgh rotation = image_histograms(lines, o);
  o.type = PghType::mirror;
  const Pgh mirror = image_histograms(lines, o);
  const HistogramRows of_directed = plain_histograms(directed),
                      of_rotation = plain_histograms(rotation);
  HistogramRows to_rotation = HistogramRows::Zero(of_rotation.rows(), of_rotation.cols());
  HistogramRows to_mirror = HistogramRows::Zero(mirror.rows.rows(), mirror.rows.cols());
  const int n = o.angle_bins, m = o.distance_bins;
  for (int a = 0; a < 4 * n; ++a) {
    for (int d = 0; d < 2 * m; ++d) {
      const int distance = d < m ? m - 1 - d : d - m;
      to_rotation.col(rotation.axes.column(0, a % (2 * n), distance)) +=
          of_directed.col(directed.axes.column(0, a, d));
    }
  }
  for (int a = 0; a < 2 * n; ++a) {
    for (int d = 0; d < m; ++d) {
      to_mirror.col(mirror.axes.column(0, a < n ? a : 2 * n - 1 - a, d)) +=
          of_rotation.col(rotation.axes.column(0, a, d));
    }
  }
  // What is cut off as negligible differs by 1e-4 of an entry.
  EXPECT_LT((to_rotation - of_rotation).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((to_mirror - plain_histograms(mirror)).cwiseAbs().maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace vernier
