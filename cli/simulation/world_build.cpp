// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/world_build.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/output_files.h"
#include "calib/base/shown_text.h"
#include "calib/board_detection.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/simulation/build_input.h"
#include "cli/simulation/floor_poses.h"
#include "cli/simulation/plan_picture.h"
#include "localise/join/point_scales.h"
#include "localise/joined_lines.h"
#include "localise/views/depth_maps.h"
#include "sim/built/built_world.h"
#include "sim/built/depth_cloud.h"
#include "sim/built/planar_patches.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "sim/world_file.h"
#include "stereo/image/depth_image.h"

namespace vernier::cli {
namespace {

struct BuildArguments {
  BuildInput input;
  std::string depth, output, lines, plan, name;
  double depth_unit_m = 0.001, upright_deg = 2;
  JoinOptions join;
  DepthCloudOptions cloud;
  BuiltWorldOptions how;
};

/// Surfaces of the depth maps among `files`, each of which belongs to an image of the views.
std::vector<Patch> patches_of(const BuildArguments& options,
                              const std::vector<std::filesystem::path>& files,
                              const SeenViews& seen,
                              Session& session) {
  const std::vector<std::filesystem::path> maps =
      depth_maps_of_images(seen.images, files, "--depth " + options.depth);
  const ReadRig rig = read_named_rig(options.input.rig, session, {maps.front().string()});
  DepthCloud cloud(options.cloud);
  Progress progress(session, "depth maps");
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const DepthImage depth = read_depth_image(maps[i], options.depth_unit_m);
    with_errors_of(maps[i].string(), [&] {
      cloud.add(depth, rig.estimate.rig.cameras.at(0), seen.T_floor_camera[i]);
      return 0;
    });
    progress.update(static_cast<int>(i + 1), static_cast<int>(maps.size()));
  }
  return planar_patches(cloud);
}

/// The lines of the world's segments, as measured, with their covariance, as a table.
std::string lines_csv(const JoinedLines& joined, const BuiltWorld& built) {
  std::string text = "segment,views,sightings,chi2,a_x_m,a_y_m,a_z_m,b_x_m,b_y_m,b_z_m";
  constexpr std::array names{"ax", "ay", "az", "bx", "by", "bz"};
  for (int i = 0; i < 6; ++i) {
    for (int k = i; k < 6; ++k) text += fmt::format(",{}_{}_m2", names[i], names[k]);
  }
  text += ",upright\n";
  for (std::size_t s = 0; s < built.of_lines.size(); ++s) {
    const JoinedLine& line = joined.lines[built.of_lines[s]];
    text += fmt::format("{},{},{},{:.4g}", s, line.views, line.sightings.size(), line.chi2);
    for (const Eigen::Vector3d* end : {&line.a_m, &line.b_m}) {
      for (int k = 0; k < 3; ++k) text += fmt::format(",{:.6f}", (*end)[k]);
    }
    for (int i = 0; i < 6; ++i) {
      for (int k = i; k < 6; ++k) text += fmt::format(",{:.6g}", line.covariance_m2(i, k));
    }
    const auto& [a_m, b_m] = built.world.loose.segments_m[s];
    text += a_m.head<2>() == b_m.head<2>() ? ",1\n" : ",0\n";
  }
  return text;
}

/// The share of the sightings whose middle the world's surfaces hide from the view that had it.
double hidden_share(const World& world,
                    const JoinedLines& joined,
                    const BuiltWorld& built,
                    const SeenViews& seen) {
  const Visibility visibility(world);
  std::size_t hidden = 0, all = 0;
  for (const int i : built.of_lines) {
    const JoinedLine& line = joined.lines[i];
    const double length_m = (line.b_m - line.a_m).norm();
    for (const LineSighting& s : line.sightings) {
      const double middle = 0.5 * (std::max(0.0, s.low_m) + std::min(length_m, s.high_m));
      const Eigen::Vector3d at = line.a_m + middle / length_m * (line.b_m - line.a_m);
      hidden += visibility.sees(seen.T_floor_camera[s.view].t, at) ? 0 : 1;
      ++all;
    }
  }
  return all > 0 ? static_cast<double>(hidden) / static_cast<double>(all) : 0;
}

void check(const BuildArguments& options, const CLI::App& verb) {
  if (options.input.segments.empty() == options.input.features.empty()) {
    throw Error("world build", "needs --segments or --features, one of both",
                "give what vernier lines --segments wrote, or views of known pose");
  }
  constexpr std::array of_segments{"--poses", "--up", "--height-m", "--depth"};
  if (options.input.segments.empty())
    refuse_options(verb, of_segments, "--features has poses of its own");
  if (!options.input.segments.empty() && options.input.at.poses.empty()) {
    throw Error("--segments " + options.input.segments, "is given without --poses",
                "say where the camera was");
  }
  up_axis(options.input.at.up);
  constexpr std::array of_depth{"--depth-unit-m", "--max-depth-m", "--recede-m"};
  if (options.depth.empty()) refuse_options(verb, of_depth, "no depth maps are given, --depth");
  if (!options.depth.empty() && options.input.rig.empty()) {
    throw Error("--depth " + options.depth, "is given without --rig", "give its pinhole camera");
  }
  if (options.depth.empty() && !options.input.segments.empty() && !options.input.rig.empty()) {
    throw Error("--rig " + options.input.rig, "has no effect without --depth", "leave it out");
  }
}

void check_outputs(const BuildArguments& options, const std::vector<std::filesystem::path>& maps) {
  std::vector<std::filesystem::path> inputs(maps);
  for (const std::string* input :
       {&options.input.segments, &options.input.features, &options.input.at.poses}) {
    if (!input->empty()) inputs.emplace_back(*input);
  }
  if (!options.input.rig.empty()) {
    for (auto& file : files_of_named_rig(options.input.rig)) inputs.push_back(std::move(file));
  }
  for (const std::string* output : {&options.output, &options.lines, &options.plan}) {
    if (!output->empty()) check_output_is_not_input(inputs, *output);
  }
}

/// Views of a wrong pose see each other's lines elsewhere.
void doubt_poses(const SeenViews& seen, const JoinedLines& joined, Session& session) {
  constexpr double least_again = 0.35;
  std::vector<double> down;
  for (const Pose& T : seen.T_floor_camera) down.push_back(-T.R(2, 1));
  if (const std::string doubt = tilt_doubt(down); !doubt.empty()) {
    session.add_trust_warning(doubt);
  }
  const auto again = std::count_if(joined.lines.begin(), joined.lines.end(),
                                   [](const JoinedLine& line) { return line.views > 1; });
  const double share = static_cast<double>(again) / std::max<double>(1, joined.lines.size());
  if (share < least_again) {
    session.add_trust_warning(
        fmt::format("a second view saw {:.0f} % of the lines only: check that the poses are camera "
                    "to world, in "
                    "metres, and belong to the images",
                    100 * share));
  }
}

/// Whether a scale is off by more than `least`, and by more than its scatter explains.
bool is_off(bool told, double value, double sigma, double least) {
  constexpr double sigmas = 5;
  return told && std::abs(value) > std::max(least, sigmas * sigma);
}
bool depth_is_off(const PointScales& s, double least) {
  return is_off(s.tells_depth(), s.depth, s.depth_sigma, least);
}
bool across_is_off(const PointScales& s, double least) {
  return is_off(s.tells_across(), s.across, s.across_sigma, least);
}

/// Lines that are seen from near and from far tell a wrong scale of depths, and a wrong focal
/// length: what is off by several standard deviations is found by joining again.
std::optional<PointScales> tested_scales(const SeenViews& seen,
                                         const JoinedLines& joined,
                                         const JoinOptions& how,
                                         Session& session) {
  // what good views have (a walk with a real sensor: 0.0004 and 0.0016), with something to spare
  constexpr double least_depth = 0.0015, least_across = 0.004;
  const std::optional<PointScales> first = point_scales(seen.views, joined, how);
  if (!first || (!depth_is_off(*first, least_depth) && !across_is_off(*first, least_across))) {
    return first;
  }
  session.info(
      "the lines of the views do not fit each other: looking for the scale of their points");
  return joined_point_scales(seen.views, *first, how);
}

void doubt_scales(const std::optional<PointScales>& scales, Session& session) {
  // beyond what a few views of a real walk show of themselves, 0.3 and 1.0 %
  constexpr double least_depth = 0.01, least_across = 0.015;
  if (!scales) return;
  if (depth_is_off(*scales, least_depth)) {
    session.add_trust_warning(fmt::format(
        "by what the views see of each other's lines, points are {:.1f} % too {}: check the scale "
        "of the depth maps or of the rig's baseline, that the poses are in metres, and that their "
        "scale does not drift",
        100 * std::abs(scales->depth), scales->depth > 0 ? "near" : "far"));
  }
  if (across_is_off(*scales, least_across)) {
    session.add_trust_warning(fmt::format(
        "by what the views see of each other's lines, the focal length seems {:.1f} % too {}: "
        "check it, and that images and depth maps are aligned",
        100 * std::abs(scales->across), scales->across > 0 ? "long" : "short"));
  }
}

/// Null where the views, or their motion, do not tell.
Json scales_json(const std::optional<PointScales>& scales) {
  if (!scales) return nullptr;
  const auto if_told = [](bool told, double value) { return told ? Json(value) : Json(); };
  return {{"depth", if_told(scales->tells_depth(), scales->depth)},
          {"depth_sigma", if_told(scales->tells_depth(), scales->depth_sigma)},
          {"across", if_told(scales->tells_across(), scales->across)},
          {"across_sigma", if_told(scales->tells_across(), scales->across_sigma)},
          {"joined_again", scales->joined_again}};
}

void report(const BuildArguments& options,
            const SeenViews& seen,
            const BuiltWorld& built,
            const World& world,
            double hidden,
            const std::optional<PointScales>& scales,
            Session& session) {
  const BuiltWorldReport& r = built.report;
  constexpr double most_off_m = 0.05, most_hidden = 0.2;
  if (hidden > most_hidden) {
    session.add_trust_warning(
        fmt::format("surfaces hide {:.0f} % of what the views saw: check that depth maps belong to "
                    "the images, and --depth-unit-m",
                    100 * hidden));
  }
  if (r.floor_m && std::abs(*r.floor_m) > most_off_m) {
    session.add_trust_warning(
        fmt::format("the depth maps show the floor at a height of {:.2f} m, not 0: give --height-m "
                    "{:.2f}",
                    *r.floor_m, options.input.at.height_m - *r.floor_m));
  }
  if (r.lines == 0) {
    session.add_trust_warning(fmt::format("no line was seen by {}: check the poses, and --up",
                                          counted(options.how.min_sightings, "view")));
  }
  const double route_m = route_length_m(world.route);
  Json json{{"file", options.output},    {"views", seen.views.size()},
            {"segments", seen.segments}, {"joined", r.joined},
            {"lines", r.lines},          {"upright", r.upright},
            {"surfaces", r.surfaces},    {"surfaces_on_the_way", r.on_the_way},
            {"hidden_share", hidden},    {"floor_m", r.floor_m ? Json(*r.floor_m) : Json()},
            {"route_m", route_m}};
  json["point_scales"] = scales_json(scales);
  json["doubts"] = session.trust_warnings();
  session.result(
      json,
      fmt::format("{}, {} segments: {} lines joined, {} of them seen by {} "
                  "at least, of which {} are upright as far as is known\n{} "
                  "surfaces ({} more left out where the "
                  "cameras passed), which hide {:.1f} % of what the views saw; "
                  "route of {:.1f} m\nwritten to {}\n",
                  counted(static_cast<std::int64_t>(seen.views.size()), "view"), seen.segments,
                  r.joined, r.lines, counted(options.how.min_sightings, "view"), r.upright,
                  r.surfaces, r.on_the_way, 100 * hidden, route_m, options.output));
}

void run(const BuildArguments& options, const CLI::App& verb, Session& session) {
  check(options, verb);
  std::vector<std::filesystem::path> maps;
  if (!options.depth.empty()) maps = matching_files(options.depth);
  check_outputs(options, maps);
  const SeenViews seen = seen_views(options.input, session);
  const std::vector<Patch> patches =
      maps.empty() ? std::vector<Patch>{} : patches_of(options, maps, seen, session);
  const std::string& source =
      options.input.features.empty() ? options.input.segments : options.input.features;
  const JoinedLines joined =
      with_errors_of(source, [&] { return join_lines(seen.views, options.join); });
  BuiltWorldOptions how = options.how;
  how.upright_rad = options.upright_deg * std::numbers::pi / 180;
  BuiltWorld built = built_world(joined, patches, seen.T_floor_camera, how);
  built.world.name =
      options.name.empty() ? std::filesystem::path(source).stem().string() : options.name;
  const World world = build_world(built.world);
  const double hidden = hidden_share(world, joined, built, seen);
  OutputFiles outputs;
  outputs.add(options.output, format_world(built.world));
  if (!options.lines.empty()) outputs.add(options.lines, lines_csv(joined, built));
  if (!options.plan.empty()) outputs.add(options.plan, plan_svg(world));
  outputs.commit();
  if (world.surfaces.empty()) {
    session.warn(options.output + ": has no surfaces; without them nothing hides anything");
  }
  doubt_poses(seen, joined, session);
  const std::optional<PointScales> scales = tested_scales(seen, joined, options.join, session);
  doubt_scales(scales, session);
  report(options, seen, built, world, hidden, scales, session);
}

}  // namespace

void add_world_build(CLI::App& world, Session& session) {
  auto o = std::make_shared<BuildArguments>();
  CLI::App* verb = add_verb(world, session, "build",
                            "build a world from real views: their lines joined, and surfaces",
                            "vernier world build --segments walk.segments.jsonl --poses poses.csv "
                            "--up y --height-m 1.6 \\\n      --depth 'depth/*.png' --rig K.txt -o "
                            "walk.world.toml --lines walk.lines.csv");
  verb->add_option("--segments", o->input.segments,
                   "segments in space, as vernier lines writes them");
  verb->add_option("--features", o->input.features, "views of known pose, instead; lines only");
  verb->add_option("--poses", o->input.at.poses,
                   "where the camera was: TUM, KITTI, matrices by image, or a COLMAP model");
  verb->add_option("--up", o->input.at.up,
                   "axis of the poses' world that points up: x, y, z, -x, -y, -z")
      ->capture_default_str();
  verb->add_option("--height-m", o->input.at.height_m,
                   "of the poses' origin above the floor, metres")
      ->check(CLI::Range(-1000.0, 1000.0))
      ->capture_default_str();
  verb->add_option("--depth", o->depth,
                   "depth maps of the same images, PNG of 16 bits (quoted pattern), for surfaces");
  verb->add_option("--rig", o->input.rig,
                   "their pinhole camera; with --features: of views of segments");
  verb->add_option("--depth-unit-m", o->depth_unit_m, "unit of the depth maps, metres")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  verb->add_option("--max-depth-m", o->cloud.max_depth_m, "farther depths make no surfaces")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str();
  verb->add_option(
          "--recede-m", o->how.recede_m,
          "how far surfaces stand back from the cameras, so that their noise hides no line")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb->add_option("--upright-deg", o->upright_deg,
                   "lines that lean by less, and within their uncertainty, are upright (0: none)")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  verb->add_option("--min-sightings", o->how.min_sightings, "views that must have seen a line")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--max-sigma-m", o->join.max_sigma_m, "segments that err more are not joined")
      ->check(CLI::Range(1e-4, 10.0))
      ->capture_default_str();
  verb->add_option("--pose-sigma-m", o->join.view_position_m, "error of each view's position")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  verb->add_option("--pose-sigma-rad", o->join.view_turn_rad, "error of each view's rotation")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb->add_option("--shared-m", o->join.shared_m,
                   "error that all sightings of a line may share; it does not average away")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  verb->add_option("--lines", o->lines, "CSV of the lines: sightings and covariance of both ends");
  verb->add_option("--plan", o->plan, "SVG of the floor plan with the route")->check(svg_name);
  verb->add_option("--name", o->name, "name of the world");
  verb->add_option("-o,--output", o->output, "world file")->required();
  check_files_written(*verb, {"--output", "--lines", "--plan"});
  verb->callback(
      [o, verb, &session] { session.action = [=, &session] { run(*o, *verb, session); }; });
}

}  // namespace vernier::cli
