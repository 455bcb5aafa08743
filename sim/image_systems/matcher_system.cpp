// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/image_systems/matcher_system.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/thread_clock.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/quantile.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/images/image_scene.h"
#include "sim/images/image_truth.h"
#include "sim/images/lighting.h"
#include "sim/images/render.h"
#include "sim/images/rendered_pair.h"
#include "sim/images/sensor_response.h"
#include "sim/images/surface_appearance.h"
#include "sim/images/told_truth.h"
#include "sim/noise_free_view.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"
#include "sim/study/system_under_test.h"
#include "sim/told_rigs.h"
#include "sim/visibility.h"
#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/matching/built_in_matchers.h"
#include "stereo/matching/external_matcher.h"
#include "stereo/matching/map_window.h"
#include "stereo/rectification.h"
#include "stereo/stereo_truth.h"

namespace vernier::sim::internal {

using namespace vernier::internal;
using localise::LocalisationStatus;
using localise::Pose2D;
using stereo::EdgeMetrics;
using stereo::EdgePoint;
using stereo::Matcher;
using stereo::MatcherScore;

namespace {

ImageSceneOptions scene_of(const SystemSettings& s, std::uint64_t seed) {
  ImageSceneOptions scene;
  scene.appearance.seed = seed;
  scene.appearance.texture_contrast = s.number("texture");
  scene.appearance.least_reflectance = s.number("least_reflectance");
  scene.appearance.largest_reflectance = s.number("largest_reflectance");
  scene.lighting.ambient = s.number("ambient");
  return scene;
}

PairOptions images_of(const SystemSettings& s) {
  PairOptions images;
  images.render.samples = s.whole("samples");
  images.sensor.point_spread_px = s.number("point_spread_px");
  images.sensor.vignetting = s.number("vignetting");
  images.sensor.exposure = s.number("exposure");
  images.sensor.full_well_e = s.number("full_well_e");
  images.sensor.read_noise_e = s.number("read_noise_e");
  return images;
}

Matcher matcher_of(const SystemSettings& s) {
  const std::string& name = s.text("matcher");
  if (name != "program") return stereo::internal::built_in_matcher(name);
  return with_errors_of("system.command", [&] {
    return stereo::internal::external_matcher(s.text("command"),
                                              {.time_limit_s = s.number("time_limit_s")});
  });
}

/// Share of the scored edges without a disparity within 1 px of the truth.
double share_not_right(const EdgeMetrics& edges) {
  const double right = edges.matched * (1 - edges.bad_1);
  return 1 - right / edges.edges;
}

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Pixel of the left image that an edge's disparity belongs to: its own or, at a discontinuity,
/// that of the 3 x 3 whose true disparity is next to it.
std::size_t pixel_of(const EdgePoint& edge,
                     const stereo::TruthAtEdge& at,
                     const stereo::DisparityMap& map,
                     float disparity_px) {
  const auto index = [&map](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width_px) +
           static_cast<std::size_t>(x);
  };
  const int column = stereo::internal::column_of(edge, map, "truth");
  std::size_t best = index(column, edge.y);
  if (!at.discontinuity) return best;
  const stereo::internal::MapWindow near(map, column, edge.y, 1);
  float least_px = std::numeric_limits<float>::infinity();
  for (int y = near.y0; y <= near.y1; ++y) {
    for (int x = near.x0; x <= near.x1; ++x) {
      const float off_px = std::abs(map(x, y) - disparity_px);
      if (!(off_px < least_px)) continue;
      least_px = off_px;
      best = index(x, y);
    }
  }
  return best;
}

/// Median of |z_true / z − 1| = |d z_true / (f B) − 1| over the edges that both cameras see and
/// whose disparity d is right to 1 px; f, B and z of the told rig. NaN if there are none.
double median_depth_error(const stereo::RectifiedGeometry& told,
                          const ToldTruth& truth,
                          const std::vector<EdgePoint>& edges,
                          const std::vector<stereo::TruthAtEdge>& at_edges,
                          const std::vector<stereo::EdgeDisparity>& found) {
  const stereo::DisparityMap& map = truth.stereo.disparity;
  std::vector<double> errors;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const stereo::TruthAtEdge& at = at_edges[i];
    const float d = found[i].disparity_px;
    if (!at.known || at.occluded || !found[i].matched()) continue;
    const std::size_t pixel = pixel_of(edges[i], at, map, d);
    if (!(std::abs(map.values[pixel] - d) <= 1)) continue;
    const double z_true = truth.depth_m[pixel];
    errors.push_back(std::abs(d / told.disparity_px(z_true) - 1));
  }
  return errors.empty() ? unknown : quantile(std::move(errors), 0.5, QuantileKind::linear);
}

/// RMS over the left pixels that the right camera sees too; NaN if there are none.
double rms_row_error(const ToldTruth& truth) {
  double squares = 0;
  int count = 0;
  for (std::size_t i = 0; i < truth.vertical_px.size(); ++i) {
    const double off_px = truth.vertical_px[i];
    if (truth.stereo.occluded[i] != 0 || !std::isfinite(off_px)) continue;
    squares += off_px * off_px;
    ++count;
  }
  constexpr double rounding_px = 1e-9;  // of an exact rig
  if (count == 0) return unknown;
  const double rms_px = std::sqrt(squares / count);
  return rms_px < rounding_px ? 0 : rms_px;
}

class MatcherSystem : public SystemUnderTest {
 public:
  explicit MatcherSystem(const SystemSetup& setup)
      : cell_(setup.cell),
        visibility_(setup.visibility),
        rig_(setup.rig.rig),
        told_(rigs_told(setup)),
        places_(setup.places),
        scene_(image_scene(setup.visibility.world(),
                           scene_of(setup.cell.system, setup.cell.experiment.seed))),
        images_(images_of(setup.cell.system)),
        matcher_(matcher_of(setup.cell.system)) {
    check_sensor(images_.sensor);
  }

  TrialResult run(std::uint32_t trial) override {
    const Pose2D pose = places_->draw(cell_.experiment.seed, trial);
    const ToldRig told = told_ ? told_->told(trial) : ToldRig{rig_, {}};
    TrialResult result = failed_trial(cell_.system, trial, told.failure);
    result.truth = pose;
    if (!told.failure.empty()) return result;
    const Pose T_left = T_left_world(pose, cell_.experiment.mount);
    const Pose T_right = rig_.T_camera_first[1] * T_left;
    if (!visibility_.sees(T_left.inverse().t, T_right.inverse().t)) {
      result.failure = "a surface stands between the two cameras";
      return result;
    }
    try {
      match(T_left, told.rig, result);
    } catch (const Error& error) {
      result.failure = error.place() + ": " + error.fault();
    }
    return result;
  }

 private:
  void match(const Pose& T_left, const Rig& told, TrialResult& result) const {
    const stereo::RectifiedGeometry geometry = stereo::rectified_geometry(told);
    const RenderedPair images = rendered_pair(scene_, rig_, told, geometry, T_left, images_,
                                              {cell_.experiment.seed, result.trial, 0});
    const ToldTruth truth = told_truth(scene_, rig_, told, geometry, T_left, 1);
    const stereo::RectifiedPair& pair = images.rectified.pair;
    const std::vector<EdgePoint> edges =
        stereo::canny_edges(pair.left, {.noise = pair.left_noise.per_pixel()});
    const std::vector<stereo::TruthAtEdge> at_edges = stereo::truth_at(truth.stereo, edges);
    const std::vector<stereo::EdgeDisparity> found =
        timed_match(pair, edges, search_range(truth.stereo.disparity), result);
    score(stereo::evaluate(edges, found, at_edges, pair.left.width_px),
          median_depth_error(geometry, truth, edges, at_edges, found), rms_row_error(truth),
          result);
  }

  /// Notes the times of a matcher that throws, too.
  std::vector<stereo::EdgeDisparity> timed_match(const stereo::RectifiedPair& pair,
                                                 const std::vector<EdgePoint>& edges,
                                                 const stereo::DisparityRange& range,
                                                 TrialResult& result) const {
    struct Timer {
      bool is_program;
      TrialResult& result;
      ThreadClock clock = {};
      ~Timer() {
        result.wall_ms = clock.wall_ms();
        // A program's own time is not known: it counts by the wall, with what is done beside it.
        result.cpu_ms = is_program ? result.wall_ms : clock.cpu_ms();
      }
    };
    const Timer timer{!cell_.system.command().empty(), result};
    return matcher_.match(pair, edges, range);
  }

  static void score(const MatcherScore& score,
                    double depth_error,
                    double row_error_px,
                    TrialResult& result) {
    const EdgeMetrics& all = score.all;
    if (all.edges == 0) {
      result.status = LocalisationStatus::too_few_lines;
      result.failure = "no edge of the left image is seen by both cameras";
      return;
    }
    const bool has_inliers = all.inliers > 0;
    result.status = LocalisationStatus::answered;
    result.error = share_not_right(all);
    result.measured = {static_cast<double>(all.edges),
                       all.density,
                       all.matched > 0 ? all.bad_1 : unknown,
                       all.matched > 0 ? score.mismatch : unknown,
                       has_inliers ? all.rms_inlier_px : unknown,
                       has_inliers ? all.bias_inlier_px : unknown,
                       score.stated > 0 ? score.z_rms : unknown,
                       depth_error,
                       row_error_px};
  }

  const StudyCell& cell_;
  const Visibility& visibility_;
  const Rig& rig_;
  std::shared_ptr<const ToldRigs> told_;
  std::shared_ptr<const QueryPlaces> places_;
  ImageScene scene_;
  PairOptions images_;
  Matcher matcher_;
};

}  // namespace

SystemKind matcher_kind() {
  using Type = SystemOption::Type;
  const SurfaceAppearanceOptions look;
  const LightingOptions light;
  const SensorOptions sensor;
  const RenderOptions render;
  const auto usual = [](auto value) { return fmt::format("{}", value); };
  std::vector<std::string> matchers = stereo::internal::built_in_matchers();
  matchers.push_back("program");
  return {
      .name = "matcher",
      .noun = "a matcher",
      .error_name = "share_not_right",
      .error_title = "share of edges not right",
      .unit = "",
      .success_error = 0.2,
      .largest_error = 1,
      .options =
          {{.name = "matcher", .type = Type::word, .usual = "edge", .words = matchers},
           {.name = "command", .type = Type::command, .only_with = {"matcher", "program"}},
           {.name = "time_limit_s",
            .usual = "60",
            .low = 1e-3,
            .high = 86400,
            .only_with = {"matcher", "program"}},
           {.name = "samples",
            .type = Type::whole,
            .usual = usual(render.samples),
            .low = 1,
            .high = 16},
           {.name = "texture", .usual = usual(look.texture_contrast), .low = 0, .high = 0.3},
           {.name = "least_reflectance",
            .usual = usual(look.least_reflectance),
            .low = 0.01,
            .high = 1},
           {.name = "largest_reflectance",
            .usual = usual(look.largest_reflectance),
            .low = 0.01,
            .high = 1},
           {.name = "ambient", .usual = usual(light.ambient), .low = 0, .high = 100},
           {.name = "point_spread_px",
            .usual = usual(sensor.point_spread_px),
            .low = 0,
            .high = 10},
           {.name = "vignetting", .usual = usual(sensor.vignetting), .low = 0, .high = 1},
           {.name = "exposure", .usual = usual(sensor.exposure), .low = 0, .high = 1000},
           {.name = "full_well_e", .usual = usual(sensor.full_well_e), .low = 10, .high = 1e7},
           {.name = "read_noise_e", .usual = usual(sensor.read_noise_e), .low = 0, .high = 1e6}},
      .measured = {{"edges", "edges of the left image that both cameras see"},
                   {"density", "share of these that are matched"},
                   {"bad_1", "share of the matched that is more than 1 px off"},
                   {"mismatch",
                    "share of all matched edges that is more than 3 px off, those that one camera "
                    "sees included"},
                   {"rms_inlier_px", "RMS of disparity errors up to 1 px, px"},
                   {"bias_inlier_px", "mean of disparity errors up to 1 px, px"},
                   {"z_rms",
                    "RMS of errors up to 1 px over stated standard deviations, on smooth surfaces; "
                    "expected: 1"},
                   {"depth_error", "median of |true depth / depth - 1| of what is right to 1 px"},
                   {"row_error_px", "RMS of how many rows apart the images of a point are, px"}},
      .sections = {"world", "camera", "sources", "calibration"},
      .sources = SourcesUsed::calibration,
      .uses_protocol = true,
      .tells_rigs = true,
      .uses_opencv = true,
      .version = 1,
      .make = [](const SystemSetup& setup) { return std::make_unique<MatcherSystem>(setup); }};
}

}  // namespace vernier::sim::internal
