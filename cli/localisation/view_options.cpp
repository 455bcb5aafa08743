// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/localisation/view_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "calib/base/error_place.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "cli/localisation/place_poses.h"
#include "cli/program/camera_images.h"
#include "cli/program/option_checks.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/simulation/source_options.h"
#include "localise/pair_view.h"
#include "localise/place.h"
#include "localise/view_file.h"
#include "localise/views/image_names.h"
#include "stereo/corners/match_images.h"
#include "stereo/grey_levels.h"

namespace vernier::cli {
namespace {

NamedViews views_of_file(const ViewOptions& options, Session& session) {
  const std::shared_ptr<const Rig> rig =
      options.rig.empty()
          ? nullptr
          : std::make_shared<const Rig>(read_stereo_rig(options.rig, session).estimate.rig);
  NamedViews read{read_views(options.features, rig), {}};
  for (std::size_t i = 0; i < read.views.size(); ++i) {
    read.names.push_back("view " + std::to_string(i + 1));
  }
  return read;
}

/// Nothing of any pair without a file of poses.
std::vector<std::optional<Pose2D>> poses_of_pairs(const ViewOptions& options,
                                                  const std::vector<ImageFiles>& files) {
  if (options.poses.empty()) return std::vector<std::optional<Pose2D>>(files.size());
  std::vector<std::string> names;
  std::vector<Pose2D> poses;
  for (const auto& [name, pose] : read_place_poses(options.poses)) {
    names.push_back(name);
    poses.push_back(pose);
  }
  std::vector<std::optional<Pose2D>> found;
  for (const std::size_t pose : pose_names_of_images(names, left_images(files), options.poses)) {
    found.push_back(poses[pose]);
  }
  return found;
}

NamedViews views_of_images(const ViewOptions& options, Session& session) {
  const std::vector<ImageFiles> files = paired_images(options.left, options.right);
  const RigEstimate estimate =
      read_stereo_rig(options.rig, session,
                      {files.front().left.string(), files.front().right.string()})
          .estimate;
  const auto rig = std::make_shared<const Rig>(estimate.rig);
  const std::vector<std::optional<Pose2D>> poses = poses_of_pairs(options, files);
  PairViewOptions how;
  how.max_disparity_px = options.max_disparity_px;
  how.with_corners = options.corners;
  if (estimate.covariance) how.calibration = estimate.covariance->matrix;
  NamedViews read{{}, distinct_names(left_images(files))};
  constexpr std::size_t few = 5;
  std::optional<Progress> progress;
  if (files.size() > few) progress.emplace(session, "views of image pairs");
  for (std::size_t i = 0; i < files.size(); ++i) {
    const ImageFiles& pair = files[i];
    const RectifiedPair images =
        read_camera_images(*rig, options.rig, pair.left.string(), pair.right.string(), session);
    RecordedLooks seen;
    seen.looks.push_back(
        {with_errors_of(
             options.rig,
             [&] { return view_of_pair(rig, images.left, images.right, options.mount(), how); }),
         0});
    seen.pose = poses[i];
    read.views.push_back(std::move(seen));
    if (progress)
      progress->update(static_cast<int>(read.views.size()), static_cast<int>(files.size()));
  }
  return read;
}

}  // namespace

CameraMount ViewOptions::mount() const { return {height_m, pitch_deg * std::numbers::pi / 180}; }

void add_view_options(CLI::App& verb, ViewOptions& o) {
  verb.add_option("--world", o.world, "world file or shipped name, seen by a simulated robot");
  verb.add_option("--features", o.features,
                  "file of views, one position a line of JSON (docs/file-formats.md)");
  verb.add_option("--left", o.left, "left images (quoted pattern)");
  verb.add_option("--right", o.right,
                  "right images (quoted pattern); paired with left images by number");
  verb.add_option("--rig", o.rig,
                  "rig file or shipped name (simulated robot: nominal unless given)");
  verb.add_option("--poses", o.poses,
                  "poses of image pairs, by left image: image,x_m,y_m,heading_deg");
  verb.add_option("--height-m", o.height_m, "camera height, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb.add_option("--pitch-deg", o.pitch_deg, "camera pitch, degrees; positive is down")
      ->check(CLI::Range(-89.0, 89.0))
      ->capture_default_str();
  verb.add_option("--max-disparity", o.max_disparity_px,
                  "largest disparity to search in images, px (default: a quarter of the width)")
      ->check(CLI::Range(1, 100'000));
  add_source_options(verb, o.sources);
  verb.add_flag("--corners", o.corners,
                "views hold corners, for methods on points (which see to it themselves)");
  verb.add_option("--seed", o.seed, "random seed of the simulated robot")->capture_default_str();
}

namespace {

/// A verb in words: "localise", "map make".
std::string place_of(const CLI::App& verb) {
  const CLI::App* parent = verb.get_parent();
  const bool is_part = parent != nullptr && parent->get_parent() != nullptr;
  return is_part ? parent->get_name() + " " + verb.get_name() : verb.get_name();
}

}  // namespace

void check(const ViewOptions& options, const CLI::App& verb) {
  const bool images = !options.left.empty() || !options.right.empty();
  const int kinds = !options.world.empty() + !options.features.empty() + images;
  if (kinds != 1) {
    throw Error(place_of(verb),
                kinds == 0 ? "no views are given" : "more than one kind of views is given",
                "give --world, or --features, or --left and --right");
  }
  if (images && (options.left.empty() || options.right.empty())) {
    throw Error(place_of(verb), "images of one camera only", "give --left and --right");
  }
  if (images && options.rig.empty()) {
    throw Error(place_of(verb), "images need the rig that took them", "give --rig");
  }
  constexpr std::array of_images{"--poses", "--max-disparity"};
  constexpr std::array of_robot{"--sources", "--source", "--seed"};
  constexpr std::array of_camera{"--height-m", "--pitch-deg"};
  if (!images) refuse_options(verb, of_images, "there are no images");
  if (options.world.empty()) refuse_options(verb, of_robot, "no robot is simulated");
  if (!options.features.empty()) {
    refuse_options(verb, of_camera, "the file of views says how the camera is mounted");
    constexpr std::array of_views{"--corners"};
    refuse_options(verb, of_views, "views of a file hold the corners that they hold");
  }
}

NamedViews read_recorded(const ViewOptions& options, Session& session) {
  return options.features.empty() ? views_of_images(options, session)
                                  : views_of_file(options, session);
}

}  // namespace vernier::cli
