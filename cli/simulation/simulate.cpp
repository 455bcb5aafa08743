// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/error_place.h"
#include "calib/error.h"
#include "calib/formats/rig_json.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/simulation/floor_poses.h"
#include "cli/simulation/observation_json.h"
#include "cli/simulation/sighting_picture.h"
#include "cli/simulation/simulate_views.h"
#include "cli/simulation/source_options.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/mount_error.h"
#include "sim/moved_furniture.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/study/reconstruct.h"
#include "sim/study/settings_reader.h"
#include "sim/study/standing_place.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "sim/world_file.h"
#include "stereo/segment.h"

namespace vernier::cli {
namespace {

struct SimulateArguments {
  std::string world = "workshop", rig = "nominal", pose, picture, visibility = "exact";
  double height_m = 1.2, pitch_deg = 0;
  std::uint64_t seed = 1;
  std::uint32_t trial = 0;
  SourceOptions sources;
  SimulatedViewOptions views;
};

/// A camera stands above the floor; the origin of a file of poses may lie anywhere.
void check_height(const SimulateArguments& options) {
  const std::string text = fmt::format("{:g}", options.height_m);
  const std::string fault = options.pose.empty() ? finite(text) : finite_and_positive(text);
  if (!fault.empty()) throw Error("--height-m", fault, "give the height of the camera");
}

void check(const SimulateArguments& options, const CLI::App& verb) {
  check_height(options);
  if (options.pose.empty() == options.views.at.poses.empty()) {
    throw Error("simulate", "needs --pose or --poses, one of both",
                "give one pose to look from, or a file of poses");
  }
  if (options.pose.empty()) {
    up_axis(options.views.at.up);
    constexpr std::array of_one{"--picture", "--pitch-deg"};
    refuse_options(verb, of_one, "a file of poses is given, --poses");
    if (options.views.output.empty()) {
      throw Error("--poses " + options.views.at.poses, "is given without --features",
                  "name the file of views to write");
    }
  } else {
    constexpr std::array of_views{"--features", "--segments", "--up", "--depth-sigma-per-m2"};
    refuse_options(verb, of_views, "no file of poses is given, --poses");
  }
}

/// Views of a camera with depth maps, from a file of poses.
void run_views(const SimulateArguments& options, Session& session) {
  SourceSettings initial;
  initial.calibration = 0;
  initial.epipolar_reject_deg = 0;  // depths are known along rows too
  const SourceSettings sources = sources_of(options.sources, initial);
  if (sources.calibration > 0) {
    throw Error("source calibration", "is given for a camera with depth maps, which has no pair",
                "leave it out; --depth-sigma-per-m2 is the error of its depths");
  }
  const std::filesystem::path file = find_world(options.world);
  World world = with_errors_of(file.string(), [&] { return build_world(read_world(file)); });
  if (sources.moved > 0) world = with_moved_furniture(world, sources.moved, options.seed);
  const Visibility visibility = with_errors_of(options.world, [&] {
    return Visibility(world, options.visibility == "exact" ? VisibilityMethod::exact
                                                           : VisibilityMethod::view_sets);
  });
  SimulatedViewOptions views = options.views;
  for (const std::string* output : {&views.output, &views.segments}) {
    if (!output->empty()) check_output_is_not_input({options.sources.file}, *output);
  }
  views.at.height_m = options.height_m;
  simulate_views(visibility, file, options.rig, sources,
                 {.seed = options.seed, .trial = options.trial}, views, session);
}

void run(const SimulateArguments& options, const CLI::App& verb, Session& session) {
  check(options, verb);
  if (options.pose.empty()) return run_views(options, session);
  const std::string ending = std::filesystem::path(options.picture).extension().string();
  const bool is_png = ending == ".png";
  if (!options.picture.empty() && !is_png && ending != ".svg") {
    throw Error("--picture " + options.picture, "is neither an SVG nor a PNG file",
                "end its name in .svg or .png");
  }
  const std::vector<double> at = parse_numbers(options.pose, 3, "--pose");
  SourceSettings initial;
  initial.calibration = 0;
  const SourceSettings sources = sources_of(options.sources, initial);
  const std::filesystem::path file = find_world(options.world);
  World world = with_errors_of(file.string(), [&] { return build_world(read_world(file)); });
  if (sources.moved > 0) world = with_moved_furniture(world, sources.moved, options.seed);
  const ReadRig rig = read_named_rig(options.rig, session);
  constexpr double degree = std::numbers::pi / 180;
  const Pose2D pose{at[0], at[1], at[2] * degree};

  if (options.visibility == "view_sets" && sources.moved > 0) {
    throw Error("--visibility view_sets", "is given beside a source that moves furniture",
                "leave one out");
  }
  const Visibility visibility = with_errors_of(options.world, [&] {
    return Visibility(world, options.visibility == "exact" ? VisibilityMethod::exact
                                                           : VisibilityMethod::view_sets);
  });
  if (const std::string fault = standing_fault(visibility, pose, options.height_m);
      !fault.empty()) {
    throw Error("--pose " + options.pose, fault,
                "give a free position, or another --height-m (vernier world info prints the size)");
  }
  if (sources.calibration > 0) required_covariance(rig.estimate, options.rig);
  ExperimentSettings settings;
  settings.sources = sources;
  settings.sources.moved = 0;  // moved already
  settings.sources.command.clear();
  settings.seed = options.seed;
  const Rig estimator_rig = with_errors_of(options.rig, [&] {
    return LocalisationExperiment(visibility, rig.estimate, nullptr, settings)
        .estimator_rig(options.trial);
  });
  NoiseFreeViewOptions looking = look_from(draw_mount(
      {options.height_m, options.pitch_deg * degree}, sources, options.seed, options.trial));
  looking.with_corners = true;
  const NoiseFreeView seen = with_errors_of(
      options.rig, [&] { return look(visibility, rig.estimate.rig, pose, looking); });
  const Sensor sensor(rig.estimate.rig, sources);
  const StereoObservation sighting =
      sensor.sense(seen, {.seed = options.seed, .trial = options.trial});
  if (!sighting.failure.empty()) {
    throw Error("--source command", sighting.failure, "correct the program (docs/own-source.md)");
  }
  Json json = sighting_json(rig.estimate.rig, seen, sighting);
  json["calibration"] = sources.calibration;
  using vernier::internal::rig_json::cameras_json;
  json["rig"] = {{"true", cameras_json(rig.estimate.rig)}, {"told", cameras_json(estimator_rig)}};
  const std::vector<SpaceSegment> space = reconstruct(estimator_rig, sighting, settings);
  json["space"] = space_json(space);
  if (!options.picture.empty()) {
    const SightingPicture picture(rig.estimate.rig, seen, sighting, space);
    write_atomically(options.picture, is_png ? picture.png() : picture.svg());
  }
  const std::string estimator_text =
      sources.calibration > 0
          ? fmt::format("the estimator uses a rig sampled with psi_c = {:g}\n", sources.calibration)
          : "the estimator uses the true rig\n";
  session.result(json, fmt::format("at ({:.2f}, {:.2f}) m heading {:.1f} deg: {} edges visible in "
                                   "both cameras, {} sensed; {} corners, {} sensed\n{}"
                                   "use --json for the full list\n",
                                   at[0], at[1], at[2], seen.edges.size(), sighting.segments.size(),
                                   seen.corners.size(), sighting.corners.size(), estimator_text));
}

}  // namespace

void add_simulate(CLI::App& app, Session& session) {
  auto o = std::make_shared<SimulateArguments>();
  CLI::App* verb =
      add_verb(app, session, "simulate",
               "simulate the features that a rig observes at a pose, with all error sources",
               "vernier simulate --world workshop --rig nominal --pose 10,7.5,0 "
               "--seed 1 --json");
  verb->add_option("--world", o->world, "world file or shipped name")->capture_default_str();
  verb->add_option("--visibility", o->visibility,
                   "exact, or view_sets: what the world's [[view_dependency]] names")
      ->check(CLI::IsMember({"exact", "view_sets"}))
      ->capture_default_str();
  verb->add_option("--rig", o->rig, "rig file or shipped name")->capture_default_str();
  verb->add_option("--pose", o->pose, "x,y,heading_deg (metres; heading from +x)");
  verb->add_option("--poses", o->views.at.poses,
                   "file of poses instead: views of a camera with depth maps, the rig's first");
  verb->add_option("--features", o->views.output,
                   "with --poses: file of views to write, for map make and localise");
  verb->add_option("--segments", o->views.segments,
                   "with --poses: also all segments with the covariance of both ends, as lines has "
                   "them");
  verb->add_option("--up", o->views.at.up,
                   "axis of the poses' world that points up: x, y, z, -x, -y or -z")
      ->capture_default_str();
  verb->add_option("--depth-sigma-per-m2", o->views.depth_per_m2,
                   "with --poses: error of a depth that an edge's pixels share, of its square, 1/m")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  verb->add_option("--height-m", o->height_m,
                   "camera height, metres; with --poses: of their origin above the floor, "
                   "to which their own heights are added (0 for those of drive --truth)")
      ->capture_default_str();
  verb->add_option("--pitch-deg", o->pitch_deg, "camera pitch, degrees; positive is down")
      ->check(CLI::Range(-89.0, 89.0))
      ->capture_default_str();
  add_source_options(*verb, o->sources);
  verb->add_option(
      "--picture", o->picture,
      "SVG or PNG of both images: edges as they are, as sensed, as the estimator places "
      "them");
  verb->add_option("--seed", o->seed, "random seed")->capture_default_str();
  verb->add_option("--trial", o->trial, "number of the random draw for this seed")
      ->capture_default_str();
  check_files_written(*verb, {"--features", "--segments", "--picture"});
  verb->callback(
      [o, verb, &session] { session.action = [=, &session] { run(*o, *verb, session); }; });
}

}  // namespace vernier::cli
