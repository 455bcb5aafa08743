// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
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
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/file_in_progress.h"
#include "calib/base/output_files.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/quantile.h"
#include "cli/localisation/depth_image_pairs.h"
#include "cli/program/camera_images.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/simulation/floor_poses.h"
#include "localise/place.h"
#include "localise/view_file.h"
#include "localise/views/camera_poses.h"
#include "localise/views/depth_view.h"
#include "localise/views/image_names.h"
#include "localise/views/segments_file.h"
#include "stereo/corners/match_images.h"
#include "stereo/grey_levels.h"
#include "stereo/image/depth_image.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/space_segments.h"

namespace vernier::cli {
namespace {

struct LinesArguments {
  std::string image, depth, rig, poses, up = "z", output, segments;
  double height_m = 1.2, pitch_deg = 0, roll_deg = 0, depth_unit_m = 0.001;
  DepthViewOptions how;
};

constexpr double below_floor_m = 0.5;  ///< more than a floor's unevenness and a height's error

/// What was found in the images.
struct LinesFigures {
  std::vector<double> lines, sigmas_m;
  std::vector<double> relative_sigmas;  ///< of a line's distance
  std::vector<double> down;             ///< part of the camera's y axis; 1: held level
  std::size_t segments = 0, placed = 0, below_floor = 0;
  int with_steps = 0;                  ///< images whose depth map has steps …
  double at_edges = 0, by_chance = 0;  ///< … and of them the sums of StepsAtEdges
};

/// The turn of a camera against a level one, from its pitch and roll.
Eigen::Matrix3d turn_of(const LinesArguments& o) {
  constexpr double degree = std::numbers::pi / 180;
  const Pose level = T_robot_camera({1, 0}), pitched = T_robot_camera({1, o.pitch_deg * degree});
  return level.R.transpose() * pitched.R * rotation_from_vector({0, 0, o.roll_deg * degree});
}

Camera camera_of(const LinesArguments& options, const std::string& image, Session& session) {
  const ReadRig read = read_named_rig(options.rig, session, {image});
  if (read.estimate.rig.cameras.size() > 1) {
    session.info(fmt::format("{}: its first camera, \"{}\", is taken", options.rig,
                             read.estimate.rig.cameras[0].name));
  }
  return read.estimate.rig.cameras.at(0);
}

/// Where the camera stands at an image, as far as it is known.
struct Stance {
  std::optional<Pose2D> pose;
  double height_m = 0;
  Eigen::Matrix3d R_level_camera;
};

/// The number of placed segments whose middle is more than below_floor_m below the floor.
std::size_t below_floor(const DepthSegments& segments, const Stance& at) {
  const auto is_below = [&](const MeasuredSegment& s) {
    const Eigen::Vector3d middle = 0.5 * (s.segment.a_m + s.segment.b_m);
    return s.status == SegmentStatus::placed &&
           at.R_level_camera.row(1).dot(middle) > at.height_m + below_floor_m;
  };
  return static_cast<std::size_t>(
      std::count_if(segments.in_space.begin(), segments.in_space.end(), is_below));
}

std::vector<Stance> stances(const LinesArguments& options,
                            const CameraPoses& poses,
                            const std::vector<ImageFiles>& files) {
  std::vector<Stance> all;
  if (options.poses.empty()) {
    all.assign(files.size(), {{}, options.height_m, turn_of(options)});
    return all;
  }
  for (const FloorPose& at :
       floor_poses(poses, {options.poses, options.up, options.height_m}, left_images(files))) {
    all.push_back({at.level.pose, at.level.height_m, at.level.R_level_camera});
  }
  return all;
}

void check(const LinesArguments& options, const CLI::App& verb) {
  up_axis(options.up);
  constexpr std::array of_poses{"--up"};
  constexpr std::array of_mount{"--pitch-deg", "--roll-deg"};
  if (options.poses.empty()) refuse_options(verb, of_poses, "no poses are given");
  if (!options.poses.empty()) refuse_options(verb, of_mount, "the poses say how the camera looks");
  if (options.poses.empty() && !(options.height_m > 0)) {
    throw Error("--height-m", "is not above the floor", "give the height of the camera");
  }
}

void check_outputs(const LinesArguments& options, const std::vector<ImageFiles>& files) {
  std::vector<std::filesystem::path> inputs = files_of_named_rig(options.rig);
  if (!options.poses.empty()) inputs.emplace_back(options.poses);
  for (const ImageFiles& pair : files) inputs.insert(inputs.end(), {pair.left, pair.right});
  check_output_is_not_input(inputs, options.output);
  if (options.segments.empty()) return;
  check_output_is_not_input(inputs, options.segments);
  check_different("--segments", options.segments, options.output);
}

/// Steps of depth that do not lie at edges of the image are another image's. On a real walk half of
/// those that chance leaves do (73 % where it would be 41 %), and of other frames' maps none.
void doubt_depth_maps(const LinesFigures& f, Session& session) {
  constexpr int fewest = 3;
  constexpr double least = 0.2;  // of what chance leaves
  if (f.with_steps < fewest) return;
  if (f.at_edges - f.by_chance > least * (f.with_steps - f.by_chance)) return;
  session.add_trust_warning(fmt::format(
      "{:.0f} % of the steps of depth lie at edges of the images, by chance it would be {:.0f} %: "
      "check that the depth maps belong to these images and are aligned with them",
      100 * f.at_edges / f.with_steps, 100 * f.by_chance / f.with_steps));
}

void report(const LinesArguments& options, const LinesFigures& f, Session& session) {
  const auto median = [](const std::vector<double>& v) {
    return v.empty() ? 0 : quantile(v, 0.5, QuantileKind::linear);
  };
  if (median(f.lines) == 0) {
    session.add_trust_warning(
        "most images have no reliable line in space: check that the depth maps are aligned with "
        "the images, and their unit, --depth-unit-m");
  }
  constexpr double unlikely_relative = 0.3;
  if (median(f.relative_sigmas) > unlikely_relative) {
    session.add_trust_warning(fmt::format(
        "lines are uncertain by {:.0f} % of their distance (median): check the unit of the depth "
        "maps, --depth-unit-m",
        100 * median(f.relative_sigmas)));
  }
  if (const std::string doubt = tilt_doubt(f.down); !doubt.empty()) {
    session.add_trust_warning(doubt);
  }
  doubt_depth_maps(f, session);
  constexpr double most_below = 0.2;  // of all: a stairwell shows some
  if (static_cast<double>(f.below_floor) > most_below * static_cast<double>(f.placed)) {
    session.add_trust_warning(fmt::format(
        "{} of {} segments lie more than {} m below the floor: check {}, and the unit of the depth "
        "maps, --depth-unit-m",
        f.below_floor, f.placed, below_floor_m,
        options.poses.empty() ? "--height-m, --pitch-deg and --roll-deg"
                              : "--up, --height-m, the unit of the poses"));
  }
  Json json{{"images", f.lines.size()},
            {"segments", f.segments},
            {"placed", f.placed},
            {"lines_median", median(f.lines)},
            {"depth_sigma_median_m", median(f.sigmas_m)},
            {"steps_at_edges", f.with_steps > 0 ? Json(f.at_edges / f.with_steps) : Json()},
            {"steps_by_chance", f.with_steps > 0 ? Json(f.by_chance / f.with_steps) : Json()},
            {"doubts", session.trust_warnings()},
            {"output", options.output}};
  session.result(
      json, fmt::format("{} images: {} segments, {} of them with depths; {:.0f} reliable lines an "
                        "image (median), standard deviation {:.3g} m\nwritten to {}\n",
                        f.lines.size(), f.segments, f.placed, median(f.lines), median(f.sigmas_m),
                        options.output));
}

/// Names by which the readers of segments find the images' poses.
std::vector<std::string> names_in_segments(const CameraPoses& poses,
                                           const std::vector<std::filesystem::path>& images) {
  std::vector<std::string> of_poses;
  for (const CameraPose& pose : poses.poses) {
    if (!pose.image.empty()) of_poses.push_back(pose.image);  // others go by time or order
  }
  if (!need_folders(of_poses)) return distinct_names(images);
  std::vector<std::string> names;
  for (const auto& image : images) names.push_back(std::filesystem::absolute(image).string());
  return names;
}

void run(const LinesArguments& options, const CLI::App& verb, Session& session) {
  check(options, verb);
  const std::vector<ImageFiles> files = images_with_depths(options.image, options.depth, session);
  check_outputs(options, files);
  const Camera camera = camera_of(options, files.front().left.string(), session);
  const auto rig = std::make_shared<const Rig>(rig_of({{camera, Pose{}}}));
  const CameraPoses poses =
      options.poses.empty() ? CameraPoses() : read_poses_of_camera(options.poses);
  const std::vector<Stance> all = stances(options, poses, files);
  const std::vector<std::string> names = names_in_segments(poses, left_images(files));
  OutputFiles outputs;
  FileInProgress& views = outputs.add(options.output);
  FileInProgress* const segments_file = outputs.add_wanted(options.segments);
  LinesFigures figures;
  Progress progress(session, "images");
  for (std::size_t i = 0; i < files.size(); ++i) {
    const GreyLevels image = read_image(files[i].left.string(), session);
    const DepthImage depth = read_depth_image(files[i].right, options.depth_unit_m);
    const DepthSegments segments = with_errors_of(files[i].left.string(), [&] {
      return depth_segments(camera, image, depth, options.how.noise);
    });
    RecordedLooks seen;
    seen.pose = all[i].pose;
    seen.looks.push_back(
        {level_view(camera, segments, all[i].R_level_camera, all[i].height_m, options.how.lines),
         0});
    seen.looks[0].view.rig = rig;  // the level camera: the same pinhole
    figures.segments += segments.image.size();
    for (const MeasuredSegment& s : segments.in_space) {
      if (s.status != SegmentStatus::placed) continue;
      ++figures.placed;
      figures.relative_sigmas.push_back(s.relative_sigma);
    }
    figures.below_floor += below_floor(segments, all[i]);
    constexpr int enough_steps = 50;
    if (segments.steps.steps >= enough_steps) {
      ++figures.with_steps;
      figures.at_edges += segments.steps.at_edges;
      figures.by_chance += segments.steps.by_chance;
    }
    figures.down.push_back(all[i].R_level_camera(1, 1));
    figures.lines.push_back(static_cast<double>(seen.looks[0].view.lines.size()));
    for (const PlaceLine& line : seen.looks[0].view.lines) figures.sigmas_m.push_back(line.sigma_m);
    views.append(view_line(seen));
    if (segments_file) {
      segments_file->append(segments_line(segments_of(names[i], segments)));
    }
    progress.update(static_cast<int>(i + 1), static_cast<int>(files.size()));
  }
  outputs.commit();
  report(options, figures, session);
}

}  // namespace

void add_lines(CLI::App& app, Session& session) {
  auto o = std::make_shared<LinesArguments>();
  CLI::App* verb = add_verb(app, session, "lines",
                            "find lines in space in images with depth maps, as views for a map",
                            "vernier lines --image 'walk/*.png' --depth 'depth/*.png' --rig K.txt "
                            "--poses poses.csv --up y "
                            "--height-m 1.6 -o walk.jsonl\n"
                            "  vernier map make --features walk.jsonl -o walk.map");
  verb->add_option("--image", o->image, "images (quoted pattern)")->required();
  verb->add_option(
          "--depth", o->depth,
          "depth maps aligned with them, PNG of 16 bits (quoted pattern); paired by number, or by "
          "time")
      ->required();
  verb->add_option("--rig", o->rig, "the pinhole camera: a rig of any format, or a 3 x 3 matrix")
      ->required();
  verb->add_option("--depth-unit-m", o->depth_unit_m, "unit of the depth maps, metres")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  verb->add_option("--depth-sigma-m", o->how.noise.floor_m, "noise of a depth, metres")
      ->check(CLI::Range(1e-6, 10.0))
      ->capture_default_str();
  verb->add_option("--depth-sigma-per-m2", o->how.noise.per_m2,
                   "error of a depth that an edge's pixels share, of its square, 1/m")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb->add_option("--poses", o->poses,
                   "where the camera was: TUM, KITTI, matrices by image, or a COLMAP model");
  verb->add_option("--up", o->up, "axis of the poses' world that points up: x, y, z, -x, -y or -z")
      ->capture_default_str();
  verb->add_option("--height-m", o->height_m,
                   "of the camera above the floor; with --poses: of their origin")
      ->check(CLI::Range(-1000.0, 1000.0))
      ->capture_default_str();
  verb->add_option("--pitch-deg", o->pitch_deg, "camera pitch without poses; positive is down")
      ->check(CLI::Range(-80.0, 80.0))
      ->capture_default_str();
  verb->add_option("--roll-deg", o->roll_deg, "camera roll without poses; positive is clockwise")
      ->check(CLI::Range(-90.0, 90.0))
      ->capture_default_str();
  verb->add_option("--segments", o->segments,
                   "also write all segments with the covariance of both ends, a line an image");
  verb->add_option("-o,--output", o->output, "file of views, for map make and localise --features")
      ->required();
  check_files_written(*verb, {"--output", "--segments"});
  verb->callback(
      [o, verb, &session] { session.action = [=, &session] { run(*o, *verb, session); }; });
}

}  // namespace vernier::cli
