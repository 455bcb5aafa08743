// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/render_options.h"

#include <CLI/CLI.hpp>
#include <cstddef>
#include <numbers>

#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/images/lighting.h"
#include "sim/images/render.h"
#include "sim/images/sensor_response.h"
#include "sim/images/surface_appearance.h"
#include "sim/noise_free_view.h"
#include "sim/study/standing_place.h"
#include "sim/visibility.h"

namespace vernier::cli {
namespace {

void add_appearance_options(CLI::App& verb, RenderArguments& a) {
  SurfaceAppearanceOptions& look = a.scene.appearance;
  verb.add_option("--least-reflectance", look.least_reflectance, "of surfaces, uniform from this …")
      ->capture_default_str();
  verb.add_option("--largest-reflectance", look.largest_reflectance, "… to this")
      ->capture_default_str();
  verb.add_option("--texture", look.texture_contrast,
                  "RMS of a surface's texture, relative to its reflectance (0: plain)")
      ->capture_default_str();
  verb.add_option("--texture-scale-m", look.texture_scale_m, "longest wavelength of textures")
      ->capture_default_str();
  verb.add_option("--least-step", look.least_step,
                  "relative step of what is painted on a surface, uniform from this …")
      ->capture_default_str();
  verb.add_option("--largest-step", look.largest_step, "… to this")->capture_default_str();
  verb.add_option("--line-width-m", look.line_width_m, "width of lines that border nothing")
      ->capture_default_str();
  verb.add_option("--ambient", a.scene.lighting.ambient, "light from everywhere")
      ->capture_default_str();
  verb.add_flag("--no-lamps", a.no_lamps, "ambient light only");
  verb.add_flag("--shadows", a.pair.render.shadows, "trace the shadows of lamps (slower)");
}

void add_sensor_options(CLI::App& verb, RenderArguments& a) {
  SensorOptions& sensor = a.pair.sensor;
  verb.add_option("--samples", a.pair.render.samples, "rays per side of a pixel")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  verb.add_option("--point-spread-px", sensor.point_spread_px,
                  "standard deviation of the lens's point spread")
      ->capture_default_str();
  verb.add_option("--vignetting", sensor.vignetting, "0: none; 1: cos^4 of the angle to the axis")
      ->capture_default_str();
  verb.add_option("--exposure", sensor.exposure,
                  "share of the full well per radiance of 1 (0: automatic)")
      ->capture_default_str();
  verb.add_option("--full-well-e", sensor.full_well_e, "electrons at grey level 255")
      ->capture_default_str();
  verb.add_option("--read-noise-e", sensor.read_noise_e, "standard deviation, electrons")
      ->capture_default_str();
  verb.add_option("--gamma", sensor.gamma, "grey = 255 (electrons / full well)^(1 / gamma)")
      ->capture_default_str();
  verb.add_flag("--no-noise", a.no_noise, "neither photon nor read noise");
}

Pose2D pose_of(const std::string& text) {
  const std::vector<double> at = parse_numbers(text, 3, "--pose");
  return {at[0], at[1], at[2] * std::numbers::pi / 180};
}

}  // namespace

void add_render_options(CLI::App& verb, RenderArguments& a) {
  verb.add_option("--world", a.world, "world file or shipped name")->capture_default_str();
  verb.add_option("--rig", a.rig, "rig file or shipped name")->capture_default_str();
  auto* pose =
      verb.add_option("--pose", a.poses, "x,y,heading_deg (metres; heading from +x; repeatable)");
  auto* count = verb.add_option("--poses", a.pose_count,
                                "number of poses along the world's route: a study's first queries")
                    ->check(CLI::Range(1, 1000))
                    ->excludes(pose);
  verb.add_option("--protocol", a.protocol, "of these: near_path, path, anywhere or free")
      ->needs(count)
      ->capture_default_str();
  verb.add_option("--height-m", a.height_m, "camera height, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb.add_option("--pitch-deg", a.pitch_deg, "camera pitch, degrees; positive is down")
      ->check(CLI::Range(-89.0, 89.0))
      ->capture_default_str();
  verb.add_option("--seed", a.seed, "random seed of appearance, noise and poses")
      ->capture_default_str();
  add_appearance_options(verb, a);
  add_sensor_options(verb, a);
  verb.add_option("--threads", a.pair.render.threads, "number of threads (0: all)")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

Pose left_camera(const RenderArguments& a, const Pose2D& pose) {
  return T_left_world(pose, {a.height_m, a.pitch_deg * std::numbers::pi / 180});
}

RenderPoses poses_of(const RenderArguments& a, const Visibility& visibility, const Rig& rig) {
  const auto eyes_are_apart = [&](const Pose2D& pose) {
    const Pose T_left = left_camera(a, pose);
    const Pose T_right = rig.T_camera_first[1] * T_left;
    return !visibility.sees(T_left.inverse().t, T_right.inverse().t);
  };
  RenderPoses at;
  for (const std::string& text : a.poses) {
    const Pose2D pose = pose_of(text);
    std::string fault = standing_fault(visibility, pose, a.height_m);
    if (fault.empty() && eyes_are_apart(pose)) fault = "has a surface between the two cameras";
    if (!fault.empty()) {
      throw Error(
          "--pose " + text, fault,
          "give a free position, or another --height-m (vernier world info prints the size)");
    }
    at.poses.push_back(pose);
    at.trials.push_back(-1);
  }
  if (a.pose_count == 0) return at;
  const QueryPlaces places(visibility, query_protocol(a.protocol), a.height_m);
  const int most = 10 * a.pose_count + 100;
  for (int trial = 0; static_cast<int>(at.poses.size()) < a.pose_count; ++trial) {
    if (trial == most) {
      throw Error(a.world, "has a surface between the two cameras at almost every pose",
                  "use a rig with a shorter baseline, or give poses with --pose");
    }
    const Pose2D pose = places.draw(a.seed, static_cast<std::uint32_t>(trial));
    if (eyes_are_apart(pose)) {
      ++at.left_out;
      continue;
    }
    at.poses.push_back(pose);
    at.trials.push_back(trial);
  }
  return at;
}

Json settings_json(const RenderArguments& a) {
  const SurfaceAppearanceOptions& look = a.scene.appearance;
  const SensorOptions& sensor = a.pair.sensor;
  return {{"world", a.world},
          {"rig", a.rig},
          {"seed", a.seed},
          {"height_m", a.height_m},
          {"pitch_deg", a.pitch_deg},
          {"appearance",
           {{"least_reflectance", look.least_reflectance},
            {"largest_reflectance", look.largest_reflectance},
            {"texture", look.texture_contrast},
            {"texture_scale_m", look.texture_scale_m},
            {"least_step", look.least_step},
            {"largest_step", look.largest_step},
            {"line_width_m", look.line_width_m}}},
          {"light",
           {{"ambient", a.scene.lighting.ambient},
            {"lamps", !a.no_lamps},
            {"shadows", a.pair.render.shadows}}},
          {"sensor",
           {{"samples", a.pair.render.samples},
            {"point_spread_px", sensor.point_spread_px},
            {"vignetting", sensor.vignetting},
            {"full_well_e", sensor.full_well_e},
            {"read_noise_e", sensor.read_noise_e},
            {"gamma", sensor.gamma},
            {"noise", !a.no_noise}}}};
}

}  // namespace vernier::cli
