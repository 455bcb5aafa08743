// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/image_systems/matcher_system.h"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/thread_clock.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
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
#include "sim/noise_free_view.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"
#include "sim/study/system_under_test.h"
#include "sim/visibility.h"
#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/matching/built_in_matchers.h"
#include "stereo/matching/external_matcher.h"
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

class MatcherSystem : public SystemUnderTest {
 public:
  explicit MatcherSystem(const SystemSetup& setup)
      : cell_(setup.cell),
        visibility_(setup.visibility),
        rig_(setup.rig.rig),
        places_(setup.places),
        geometry_(stereo::rectified_geometry(rig_)),
        scene_(image_scene(setup.visibility.world(),
                           scene_of(setup.cell.system, setup.cell.experiment.seed))),
        images_(images_of(setup.cell.system)),
        matcher_(matcher_of(setup.cell.system)) {
    check_sensor(images_.sensor);
  }

  TrialResult run(std::uint32_t trial) override {
    const Pose2D pose = places_->draw(cell_.experiment.seed, trial);
    TrialResult result = failed_trial(cell_.system, trial, {});
    result.truth = pose;
    const Pose T_left = T_left_world(pose, cell_.experiment.mount);
    const Pose T_right = rig_.T_camera_first[1] * T_left;
    if (!visibility_.sees(T_left.inverse().t, T_right.inverse().t)) {
      result.failure = "a surface stands between the two cameras";
      return result;
    }
    try {
      match(T_left, result);
    } catch (const Error& error) {
      result.failure = error.place() + ": " + error.fault();
    }
    return result;
  }

 private:
  void match(const Pose& T_left, TrialResult& result) const {
    const RectifiedView view = rectified_view(rig_, geometry_, T_left);
    const RenderedPair images = rendered_pair(scene_, rig_, view, T_left, images_,
                                              {cell_.experiment.seed, result.trial, 0});
    const PairTruth truth = pair_truth(scene_, rig_, view, 1);
    const stereo::RectifiedPair& pair = images.rectified.pair;
    const std::vector<EdgePoint> edges =
        stereo::canny_edges(pair.left, {.noise = images.rectified.left_noise});
    const std::vector<stereo::TruthAtEdge> at_edges =
        stereo::truth_at(stereo::stereo_truth(truth.left, &truth.right), edges);
    const ThreadClock clock;
    const std::vector<stereo::EdgeDisparity> found =
        matcher_.match(pair, edges, search_range(truth));
    result.wall_ms = clock.wall_ms();
    // A program's own time is not known: it counts by the wall, with what is done beside it.
    result.cpu_ms = cell_.system.command().empty() ? clock.cpu_ms() : result.wall_ms;
    score(stereo::evaluate(edges, found, at_edges, pair.left.width_px), result);
  }

  static void score(const MatcherScore& score, TrialResult& result) {
    const EdgeMetrics& all = score.all;
    if (all.edges == 0) {
      result.status = LocalisationStatus::too_few_lines;
      return;
    }
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    const bool has_inliers = all.inliers > 0;
    result.status = LocalisationStatus::answered;
    result.error = share_not_right(all);
    result.measured = {static_cast<double>(all.edges),
                       all.density,
                       all.matched > 0 ? all.bad_1 : unknown,
                       all.matched > 0 ? score.mismatch : unknown,
                       has_inliers ? all.rms_inlier_px : unknown,
                       has_inliers ? all.bias_inlier_px : unknown,
                       score.stated > 0 ? score.z_rms : unknown};
  }

  const StudyCell& cell_;
  const Visibility& visibility_;
  const Rig& rig_;
  std::shared_ptr<const QueryPlaces> places_;
  stereo::RectifiedGeometry geometry_;
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
      .measured = {"edges", "density", "bad_1", "mismatch", "rms_inlier_px", "bias_inlier_px",
                   "z_rms"},
      .sections = {"world", "camera"},
      .uses_protocol = true,
      .make = [](const SystemSetup& setup) { return std::make_unique<MatcherSystem>(setup); }};
}

}  // namespace vernier::sim::internal
