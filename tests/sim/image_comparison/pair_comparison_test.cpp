// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/image_comparison/pair_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/image_comparison/compared_sources.h"
#include "sim/image_comparison/comparison_figures.h"
#include "sim/image_comparison/edge_sample.h"
#include "sim/image_comparison/explained_points.h"
#include "sim/images/image_scene.h"
#include "sim/images/image_truth.h"
#include "sim/images/rendered_pair.h"
#include "sim/images/true_edges.h"
#include "sim/noise_free_view.h"
#include "sim/visibility.h"
#include "stereo/matcher.h"
#include "stereo/rectification.h"
#include "tests/support/painted_room.h"
#include "tests/support/small_office.h"

namespace vernier::test {
namespace {

using Eigen::Vector2d;
using stereo::EdgeDisparity;
using stereo::ImageSegment;
using stereo::Matcher;

/// A room with a panel and a board that stand clear of each other, plain, and its true edges.
struct Panels {
  World world = panel_room();
  Rig rig = nominal_rig().rig;
  Pose T_left = T_left_world({0, 0, 0}, {});
  RectifiedView view = rectified_view(rig, stereo::rectified_geometry(rig), T_left);
  RenderedPair pair;
  TrueEdges truth;

  Panels() {
    ImageSceneOptions options;
    options.appearance.texture_contrast = 0;
    options.appearance.seed = 4;
    const ImageScene scene = image_scene(world, options);
    pair = rendered_pair(scene, rig, rig, view.geometry, T_left, {}, {});
    truth = true_edges(Visibility(world), scene.segments, view);
  }
};

const Panels& panels() {
  static const Panels made;
  return made;
}

bool is_step(const EdgeSample& edge) {
  return (edge.appearance == EdgeAppearance::border ||
          edge.appearance == EdgeAppearance::outline) &&
         edge.contrast > 25;
}

/// A matcher that knows the truth, apart from what `change` adds at a point of the edges.
Matcher knowing(const TrueEdges& truth,
                const std::function<double(const TrueEdge&, double t)>& change) {
  Matcher matcher;
  matcher.name = "knowing";
  matcher.of_edges = true;
  matcher.match = [&truth, change](const stereo::RectifiedPair&,
                                   const std::vector<stereo::EdgePoint>& points,
                                   const stereo::DisparityRange&) {
    std::vector<EdgeDisparity> found(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      double nearest = 4;
      for (const TrueEdge& edge : truth.both) {
        const Vector2d from = points[i].pixel_px.cast<double>() - edge.left_px.a_px;
        const Vector2d along = edge.left_px.b_px - edge.left_px.a_px;
        const double t = along.dot(from) / along.squaredNorm();
        const double off = std::abs(normal_of(edge.left_px).dot(from));
        if (t < 0 || t > 1 || off > nearest) continue;
        nearest = off;
        found[i].disparity_px =
            static_cast<float>(edge.disparity_px[0] +
                               t * (edge.disparity_px[1] - edge.disparity_px[0]) + change(edge, t));
      }
    }
    return found;
  };
  return matcher;
}

ComparedEdges compare(const TrueEdges& truth, const std::vector<Matcher>& matchers = {}) {
  ComparedEdges compared;
  add_pair(panels().pair, truth, {0, 80}, matchers, compared);
  return compared;
}

ImageSegment moved(const ImageSegment& s, const Vector2d& by) { return {s.a_px + by, s.b_px + by}; }

TEST(PairComparison, ClearStepsAreFoundWhereTheyAre) {
  const ComparedEdges compared = compare(panels().truth);
  const EdgeFigures steps = edge_figures(compared, is_step);
  ASSERT_GE(steps.edges, 5);
  EXPECT_LT(steps.pair_loss, 0.08);
  EXPECT_EQ(steps.lost_whole, 0);
  EXPECT_LT(steps.median_shift_px, 0.05);
  EXPECT_LT(steps.common_px, 0.1);
  EXPECT_LT(steps.independent_px, 0.1);
  EXPECT_GT(steps.corners.found, 0.8);
  EXPECT_LT(steps.corners.across_px, 0.1);
}

TEST(PairComparison, FaintStepsAreLost) {
  const ComparedEdges compared = compare(panels().truth);
  const EdgeFigures faint =
      edge_figures(compared, [](const EdgeSample& edge) { return edge.contrast < 5; });
  ASSERT_GE(faint.edges, 1);
  EXPECT_EQ(faint.pair_loss, 1);
}

TEST(PairComparison, TruthMovedInBothEyesIsACommonShift) {
  for (const double by : {-1.3, 0.8}) {
    TrueEdges truth = panels().truth;
    std::vector<Vector2d> of_line(truth.of_eye[0].size(), Vector2d(0, 0));
    // Along each edge's own normal in the left image; the same move in the right one.
    for (TrueEdge& edge : truth.both) {
      const Vector2d shift = -by * normal_of(edge.left_px);
      edge.left_px = moved(edge.left_px, shift);
      for (std::size_t eye = 0; eye < 2; ++eye) {
        ImageSegment& line = truth.of_eye[eye][static_cast<std::size_t>(edge.of_eye[eye])];
        line = moved(line, shift);
      }
    }
    const EdgeFigures steps = edge_figures(compare(truth), is_step);
    EXPECT_NEAR(steps.common_px * std::sqrt(13.0 / 12), std::abs(by), 0.08);
    EXPECT_LT(steps.independent_px, 0.15);
  }
}

TEST(PairComparison, TruthMovedInOneEyeIsAnIndependentShift) {
  TrueEdges truth = panels().truth;
  constexpr double by = 0.9;
  for (const TrueEdge& edge : truth.both) {
    ImageSegment& line = truth.of_eye[1][static_cast<std::size_t>(edge.of_eye[1])];
    line = moved(line, by * normal_of(line));
  }
  const EdgeFigures steps = edge_figures(compare(truth), is_step);
  EXPECT_NEAR(steps.independent_px * std::sqrt(13.0 / 6), by, 0.05);
  EXPECT_LT(steps.common_px, 0.15);
}

TEST(PairComparison, EdgesThatAreNotThereAreLost) {
  TrueEdges truth = panels().truth;
  const std::size_t real = truth.both.size();
  // Across plain wall, where nothing is.
  TrueEdge ghost = truth.both[0];
  ghost.left_px = {{500, 60}, {560, 75}};
  ghost.disparity_px = {20, 20};
  for (std::size_t eye = 0; eye < 2; ++eye) {
    ghost.of_eye[eye] = static_cast<int>(truth.of_eye[eye].size());
    truth.of_eye[eye].push_back(eye == 0 ? ghost.left_px : ghost.right_px());
  }
  truth.both.push_back(ghost);
  const ComparedEdges compared = compare(truth);
  ASSERT_EQ(compared.edges.size(), real + 1);
  const EdgeSample& lost = compared.edges.back();
  EXPECT_EQ(lost.left_found_px, 0);
  EXPECT_EQ(lost.both_found_px, 0);
  EXPECT_EQ(lost.gaps, 1);
  EXPECT_NEAR(lost.longest_gap_px, ghost.left_px.length_px(), 1e-9);
  EXPECT_TRUE(std::isnan(lost.shift_px[0]));
}

TEST(PairComparison, WhatTheTruthLeavesOutIsFalse) {
  const ComparedEdges whole = compare(panels().truth);
  TrueEdges truth = panels().truth;
  // The longest step that is found.
  std::size_t longest = 0;
  for (std::size_t i = 0; i < truth.both.size(); ++i) {
    if (is_step(whole.edges[i]) &&
        (!is_step(whole.edges[longest]) ||
         whole.edges[i].left_found_px > whole.edges[longest].left_found_px)) {
      longest = i;
    }
  }
  const double length = whole.edges[longest].left_found_px;
  const auto line = static_cast<std::size_t>(truth.both[longest].of_eye[0]);
  truth.of_eye[0][line] = {{-50, -50}, {-60, -50}};
  const ComparedEdges compared = compare(truth);
  double before = 0, after = 0;
  for (const double x : whole.false_px[0]) before += x;
  for (const double x : compared.false_px[0]) after += x;
  EXPECT_NEAR(after - before, length, 0.1 * length);
  EXPECT_EQ(compared.detected_px, whole.detected_px);
}

TEST(PairComparison, CountsTheLinesThatAMatcherGetsWrong) {
  const TrueEdges& truth = panels().truth;
  int wrong_of = -1;
  const Matcher right = knowing(truth, [](const TrueEdge&, double) { return 0.0; });
  const Matcher near = knowing(truth, [](const TrueEdge&, double) { return 2.9; });
  const Matcher far = knowing(
      truth, [&](const TrueEdge& edge, double) { return edge.segment == wrong_of ? -7.5 : 0.0; });
  ComparedEdges compared = compare(truth, {right, near});
  for (const EdgeSample& edge : compared.edges) {
    for (const MatchedEdge& match : edge.matches) EXPECT_FALSE(match.is_wrong());
    if (edge.matches[0].asked) {
      EXPECT_LT(std::abs(edge.matches[0].error_px), 0.3);
    }
  }
  int tried = 0;
  for (std::size_t i = 0; i < truth.both.size(); ++i) {
    if (!compared.edges[i].matches[0].matched || compared.edges[i].neighbour_px < 10) continue;
    wrong_of = truth.both[i].segment;
    const ComparedEdges again = compare(truth, {far});
    const EdgeFigures all = edge_figures(again, [](const EdgeSample&) { return true; });
    EXPECT_EQ(all.matchers[0].wrong, 1);
    EXPECT_NEAR(all.matchers[0].wrong_px, 7.5, 0.3);
    ++tried;
  }
  EXPECT_GE(tried, 3);
}

TEST(PairComparison, EndsAreMeasuredFromTheTrueOnes) {
  TrueEdges truth = panels().truth;
  const EdgeFigures before = edge_figures(compare(truth), is_step);
  // Every true edge 1.5 px longer at both ends: segments now end short of it.
  for (TrueEdge& edge : truth.both) {
    const Vector2d along = (edge.left_px.b_px - edge.left_px.a_px).normalized();
    edge.left_px = {edge.left_px.a_px - 1.5 * along, edge.left_px.b_px + 1.5 * along};
  }
  const EdgeFigures after = edge_figures(compare(truth), is_step);
  EXPECT_NEAR(after.corners.along_mean_px - before.corners.along_mean_px, -1.5, 0.4);
  EXPECT_NEAR(after.corners.across_px, before.corners.across_px, 0.05);
}

TEST(ExplainedPoints, NearestLineTakesAPointAndCoincidentOnesShareIt) {
  stereo::internal::ImageEdges edges;
  edges.width_px = edges.height_px = 100;
  for (int y = 20; y < 60; ++y) {
    stereo::EdgePoint p;
    p.x = 30;
    p.y = y;
    p.pixel_px = {30.2F, static_cast<float>(y)};
    p.normal = {1, 0};
    edges.points.push_back(p);
  }
  const std::vector<ImageSegment> lines{{{30, 10}, {30, 90}},
                                        {{30.5, 10}, {30.5, 90}},
                                        {{32.5, 10}, {32.5, 90}},
                                        {{10, 40}, {90, 40}},
                                        {{34, 10}, {34, 90}}};
  const ExplainedPoints explained = explained_points(edges, lines);
  EXPECT_EQ(explained.of_line[0].size(), 40U);
  EXPECT_EQ(explained.of_line[1].size(), 40U);
  EXPECT_TRUE(explained.of_line[2].empty());
  EXPECT_TRUE(explained.of_line[3].empty());
  EXPECT_TRUE(explained.of_line[4].empty());
  EXPECT_EQ(explained.explained, std::vector<char>(40, 1));
  for (const PointOnLine& p : explained.of_line[0]) {
    EXPECT_NEAR(p.across_px, -0.2, 1e-5);
    EXPECT_NEAR(p.along_px, edges.points[static_cast<std::size_t>(p.point)].y - 10, 1e-5);
  }
}

TEST(ComparedSources, WritesAFileWithWhatWasMeasured) {
  ComparedEdges compared =
      compare(panels().truth, {knowing(panels().truth, [](auto&&...) { return 0.0; })});
  const std::vector<EdgeSample> once = compared.edges;
  for (int pair = 1; pair < 8; ++pair) {
    for (EdgeSample edge : once) {
      edge.pair = pair;
      compared.edges.push_back(edge);
    }
    compared.false_px.push_back({20, 30});
    compared.detected_px.push_back(1000);
  }
  const std::vector<ComparedSource> sources = compared_sources(compared, 0);
  const std::string toml = compared_sources_toml(sources, "a test");
  for (const char* line :
       {"clutter = ", "edge_loss = ", "lateral_shift_px = ", "lateral_shift_mode = \"common\"",
        "endpoint_sigma_px = ", "stereo_mismatch = 0 ", "# stereo_mismatch_px: not measured"}) {
    EXPECT_NE(toml.find(line), std::string::npos) << line << "\n" << toml;
  }
  for (const ComparedSource& s : sources) {
    if (s.key == "clutter") {
      const double n = static_cast<double>(compared.edges.size());
      EXPECT_NEAR(s.shown.value, (14 + double(compared.false_px[0].size())) / n, 1e-12);
    }
  }
}

}  // namespace
}  // namespace vernier::test
