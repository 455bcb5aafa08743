// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/simulate_views.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/file_in_progress.h"
#include "calib/base/output_files.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/quantile.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/simulation/floor_poses.h"
#include "localise/place.h"
#include "localise/view_file.h"
#include "localise/views/depth_view.h"
#include "localise/views/segments_file.h"
#include "sim/depth_views/depth_camera.h"
#include "sim/mount_error.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/visibility.h"

namespace vernier::cli {

namespace {

/// How the camera of a pose truly looks: its turn, with the errors of the mount.
NoiseFreeViewOptions looking_from(const LevelPose& level,
                                  const SourceSettings& sources,
                                  const SensingDraw& draw) {
  const CameraTurn turn = turn_of(level.R_level_camera);
  TrueMount stands = draw_mount({level.height_m, turn.pitch_rad}, sources, draw.seed, draw.trial);
  stands.roll_rad += turn.roll_rad;
  return look_from(stands);
}

void report(const std::vector<double>& edges,
            const std::vector<double>& lines,
            const std::vector<double>& heights_m,
            double baseline_m,
            const std::string& output,
            Session& session) {
  const auto median = [](const std::vector<double>& v) {
    return v.empty() ? 0 : quantile(v, 0.5, QuantileKind::linear);
  };
  if (median(lines) == 0) {
    session.add_trust_warning(
        "most views have no reliable line: check that the poses are in the world, --up and "
        "--height-m");
  }
  session.result(
      {{"views", lines.size()},
       {"segments_median", median(edges)},
       {"lines_median", median(lines)},
       {"camera_height_median_m", median(heights_m)},
       {"baseline_m", baseline_m},
       {"doubts", session.trust_warnings()},
       {"output", output}},
      fmt::format("{}: {:.0f} segments and {:.0f} reliable lines each, cameras {:.2f} m above the "
                  "floor (medians); depths err as those of a pair with a baseline of {:.3f} m\n"
                  "written to {}\n",
                  counted(static_cast<std::int64_t>(lines.size()), "view"), median(edges),
                  median(lines), median(heights_m), baseline_m, output));
}

}  // namespace

void simulate_views(const Visibility& visibility,
                    const std::filesystem::path& world,
                    const std::string& rig_name,
                    const SourceSettings& sources,
                    const SensingDraw& draw,
                    const SimulatedViewOptions& options,
                    Session& session) {
  std::vector<std::filesystem::path> inputs = files_of_named_rig(rig_name);
  inputs.emplace_back(options.at.poses);
  inputs.push_back(world);
  check_output_is_not_input(inputs, options.output);
  if (!options.segments.empty()) {
    check_output_is_not_input(inputs, options.segments);
    check_different("--segments", options.segments, options.output);
  }
  const ReadRig read = read_named_rig(rig_name, session);
  const Camera& camera = read.estimate.rig.cameras.at(0);
  const DepthCameraSensor sensor = with_errors_of(
      rig_name, [&] { return DepthCameraSensor(camera, options.depth_per_m2, sources); });
  const auto rig = std::make_shared<const Rig>(rig_of({{camera, Pose{}}}));
  const NamedFloorPoses all = all_floor_poses(options.at);
  OutputFiles outputs;
  FileInProgress& views = outputs.add(options.output);
  FileInProgress* const segments_file = outputs.add_wanted(options.segments);
  std::vector<double> edges, lines, heights_m;
  Progress progress(session, "views");
  for (std::size_t i = 0; i < all.poses.size(); ++i) {
    const LevelPose& level = all.poses[i].level;
    SensingDraw own = draw;
    own.frame = static_cast<std::uint32_t>(i);
    const DepthSegments segments =
        sensor.sense(visibility, level.pose, looking_from(level, sources, draw), own);
    RecordedLooks seen;
    seen.pose = level.pose;
    seen.looks.push_back(
        {level_view(camera, segments, level.R_level_camera, level.height_m, options.lines), 0});
    seen.looks[0].view.rig = rig;
    views.append(view_line(seen));
    if (segments_file) segments_file->append(segments_line(segments_of(all.names[i], segments)));
    heights_m.push_back(level.height_m);
    edges.push_back(static_cast<double>(segments.image.size()));
    lines.push_back(static_cast<double>(seen.looks[0].view.lines.size()));
    progress.update(static_cast<int>(i + 1), static_cast<int>(all.poses.size()));
  }
  outputs.commit();
  std::vector<double> down;
  for (const FloorPose& pose : all.poses) down.push_back(pose.level.R_level_camera(1, 1));
  if (const std::string doubt = tilt_doubt(down); !doubt.empty()) {
    session.add_trust_warning(doubt);
  }
  report(edges, lines, heights_m, sensor.baseline_m(), options.output, session);
}

}  // namespace vernier::cli
