// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/characterise_sequence.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstddef>
#include <filesystem>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/error_place.h"
#include "calib/board_detection.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/stereo/sequence_report.h"
#include "localise/views/camera_poses.h"
#include "localise/views/depth_maps.h"
#include "localise/views/segments_file.h"
#include "sim/sequence/measured_sequence.h"
#include "sim/sequence/sequence_file.h"
#include "sim/sequence/sequence_samples.h"
#include "sim/sources/measured_sources.h"
#include "sim/sources/sources_file.h"
#include "stereo/image/depth_image.h"

namespace vernier::cli {

using namespace sim::internal;
using namespace localise::internal;

namespace {

constexpr std::array of_pairs{
    "--left",          "--right",         "--truth",        "--right-truth", "--truth-scale",
    "--max-disparity", "--min-disparity", "--scenes",       "--matcher",     "--command",
    "--corners",       "--repair",        "--lateral-shift"};
constexpr std::array of_sequence{"--poses",       "--rig",           "--depth",  "--depth-unit-m",
                                 "--other-views", "--bracket-views", "--block-m"};

/// The views with the names of their images.
struct ReadSequence {
  std::vector<SequenceView> views;
  std::vector<std::filesystem::path> images;
};

ReadSequence read_sequence(const SequenceArguments& options) {
  const std::vector<SegmentsOfImage> images = read_segments(options.segments);
  ReadSequence read;
  for (const SegmentsOfImage& image : images) read.images.emplace_back(image.image);
  const std::vector<Pose> T_world_camera =
      poses_of_images(read_poses_of_camera(options.poses), read.images, options.poses);
  for (std::size_t i = 0; i < images.size(); ++i) {
    read.views.push_back({T_world_camera[i], {}});
    for (const ImageSegmentInSpace& s : images[i].segments) {
      if (s.reliable) read.views.back().segments.push_back({s.image_px, s.in_space});
    }
  }
  return read;
}

DepthImage depth_of(const std::filesystem::path& file, const Camera& camera, double unit_m) {
  DepthImage map = read_depth_image(file, unit_m);
  if (Eigen::Vector2i(map.width_px, map.height_px) != camera.size_px) {
    throw Error(file.string(),
                fmt::format("is of {}x{} px, the camera of {}x{}", map.width_px, map.height_px,
                            camera.size_px[0], camera.size_px[1]),
                "give depth maps aligned with the images");
  }
  return map;
}

std::string how_measured(const SequenceArguments& options) {
  const SequenceOptions& how = options.how;
  return fmt::format("lines of {:g} px or longer, seen by {} other views or more{}",
                     how.min_length_px, how.other_views,
                     how.bracket_views > 0 ? fmt::format(", by one of the {} before and one of the "
                                                         "{} after",
                                                         how.bracket_views, how.bracket_views)
                                           : "");
}

/// Reports limitations of the results. Returns whether they can be written.
bool report_limits(const MeasuredSequence& sequence, Session& session) {
  constexpr double most_loss = 0.7, most_false = 0.7, least_agreeing = 0.7, most_beside = 0.75;
  constexpr int least_clusters = 6;
  if (!sequence.with_depth) {
    session.warn("no depth maps: a line that something hides counts as lost");
  }
  if (sequence.clusters < least_clusters) {
    session.warn(fmt::format("only {} blocks of the way: intervals are wide, and do not generalise",
                             sequence.clusters));
  }
  bool any = false;
  for (const SourceEntry& entry : source_entries(sequence)) any = any || entry.written;
  if (sequence.depths_agree < least_agreeing) {
    any = false;
    session.add_trust_warning(
        fmt::format("the depth maps agree with {:.0f} % of the segments of their own images only: "
                    "check that they belong to the images, and --depth-unit-m",
                    100 * sequence.depths_agree));
  } else if (!any) {
    session.add_trust_warning(
        "nothing could be measured: fewer than 30 lines were seen by enough views; check that the "
        "poses are camera to world and belong to the images");
  } else {
    struct Doubt {
      const MeasuredValue& share;
      double most;
      const char* told;
    };
    const SequenceFigures& all = sequence.all;
    for (const Doubt& doubt :
         {Doubt{all.not_confirmed, most_false,
                "of the segments are where the poses put them in no neighbouring view: check the "
                "poses, and the unit of the depths"},
          Doubt{all.loss, most_loss,
                "of what other views saw is not where the poses put it: check the poses, and the "
                "unit of the depths"},
          Doubt{all.beside_lines, most_beside,
                "of the segments lie on no line that other views saw: check that the depth maps, "
                "the poses and the segments are of the same images"}}) {
      if (!doubt.share.known() || doubt.share.value <= doubt.most) continue;
      any = false;
      session.add_trust_warning(fmt::format("{:.0f} % {}", 100 * doubt.share.value, doubt.told));
      break;
    }
  }
  return any;
}

void check_output(const SequenceArguments& options,
                  const std::vector<std::filesystem::path>& maps,
                  const std::string& output) {
  if (output.empty()) return;
  std::vector<std::filesystem::path> inputs = files_of_named_rig(options.rig);
  inputs.insert(inputs.end(), {options.segments, options.poses});
  inputs.insert(inputs.end(), maps.begin(), maps.end());
  check_output_is_not_input(inputs, output);
}

}  // namespace

void add_sequence_options(CLI::App& verb, SequenceArguments& o) {
  verb.add_option("--sequence", o.segments,
                  "measure in looks at the same lines: segments of images, as lines --segments "
                  "writes them, in the order in which they were taken");
  verb.add_option("--poses", o.poses,
                  "of the sequence: where the camera was; TUM, KITTI, matrices by image, or a "
                  "COLMAP model");
  verb.add_option("--rig", o.rig, "of the sequence: its pinhole camera");
  verb.add_option("--depth", o.depth,
                  "of the sequence: depth maps, to see what hides a line (quoted pattern)");
  verb.add_option("--depth-unit-m", o.depth_unit_m, "unit of the depth maps, metres")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  verb.add_option("--other-views", o.how.other_views,
                  "of the sequence: how many others must have seen a line")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  verb.add_option("--bracket-views", o.how.bracket_views,
                  "of the sequence: a line is expected between views that saw it, as many before "
                  "and after; 0, with depth maps: in all")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  verb.add_option("--block-m", o.block_m, "of the sequence: blocks of the bootstrap, metres of way")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
}

void check_sequence_options(const CLI::App& verb, const SequenceArguments& options) {
  if (options.segments.empty()) {
    refuse_options(verb, of_sequence, "no --sequence is given");
    return;
  }
  refuse_options(verb, of_pairs, "it is of pairs with ground truth, not of a --sequence");
  if (options.poses.empty() || options.rig.empty()) {
    throw Error("--sequence",
                options.poses.empty() ? "is given without --poses" : "is given without --rig",
                "say where the camera was, and which it is");
  }
  if (options.depth.empty()) {
    constexpr std::array of_depth{"--depth-unit-m"};
    refuse_options(verb, of_depth, "no depth maps are given");
  }
}

void characterise_sequence(const SequenceArguments& options,
                           const std::string& output,
                           std::uint64_t seed,
                           Session& session) {
  const ReadSequence read = read_sequence(options);
  std::vector<std::filesystem::path> maps;
  if (!options.depth.empty()) {
    const std::vector<std::filesystem::path> files = matching_files(options.depth);
    check_output(options, files, output);
    maps = depth_maps_of_images(read.images, files, "--depth " + options.depth);
  }
  check_output(options, {}, output);
  const ReadRig rig = read_named_rig(options.rig, session, {maps.empty() ? "" : maps[0].string()});
  const Camera& camera = rig.estimate.rig.cameras.at(0);
  DepthOfView depth;
  if (!maps.empty()) {
    depth = [&](std::size_t view) { return depth_of(maps[view], camera, options.depth_unit_m); };
  }
  MeasuringOptions measuring;
  measuring.bootstrap.seed = seed;
  SequenceSamples samples;
  {
    Progress progress(session, "views");
    samples = with_errors_of(options.segments, [&] {
      return sequence_samples(camera, read.views, depth, options.how,
                              [&](int done, int total) { progress.update(done, total); });
    });
  }
  const MeasuredSequence sequence =
      measure_sequence(samples, read.views, options.block_m, measuring);
  const bool trusted = report_limits(sequence, session);
  if (!output.empty()) {
    if (trusted) {
      write_atomically(output, sources_toml(sequence, how_measured(options)));
    } else {
      session.warn(output + " was not written");
    }
  }
  session.result(sequence_json(sequence), sequence_text(sequence));
}

}  // namespace vernier::cli
