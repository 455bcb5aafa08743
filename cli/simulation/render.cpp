// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/output_files.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/estimate/rig_part.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/simulation/comparison_report.h"
#include "cli/simulation/render_files.h"
#include "cli/simulation/render_options.h"
#include "localise/place.h"
#include "sim/image_comparison/compared_sources.h"
#include "sim/image_comparison/edge_sample.h"
#include "sim/image_comparison/pair_comparison.h"
#include "sim/images/image_scene.h"
#include "sim/images/image_truth.h"
#include "sim/images/render.h"
#include "sim/images/rendered_pair.h"
#include "sim/images/sensor_response.h"
#include "sim/images/true_edges.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "sim/world_file.h"
#include "stereo/edge_matcher.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matching/stretch_correlation.h"
#include "stereo/rectification.h"

namespace vernier::cli {
namespace {

/// What all poses of a call share.
struct RenderedWorld {
  const Visibility& visibility;
  ImageScene scene;
  Rig rig;
  RectifiedGeometry geometry;
};

RenderedView view_of(const RenderedWorld& world,
                     const RenderArguments& options,
                     const RectifiedView& view,
                     const Pose& T_left,
                     std::uint32_t number) {
  RenderedView rendered;
  rendered.pair = rendered_pair(world.scene, world.rig, world.rig, view.geometry, T_left,
                                options.pair, {options.seed, number, 0});
  rendered.truth = pair_truth(world.scene, world.rig, view, options.pair.render.threads);
  rendered.edges = true_edges(world.visibility, world.scene.segments, view);
  return rendered;
}

/// Of the pixels, in which the sensor is full.
double saturated_share(const stereo::GreyLevels& image) {
  const auto full = std::count(image.values.begin(), image.values.end(), 255.0F);
  return static_cast<double>(full) / static_cast<double>(image.values.size());
}

Json pose_json(const std::string& folder,
               const Pose2D& pose,
               int trial,
               const RenderedView& rendered) {
  return {{"folder", folder},
          {"trial", trial < 0 ? Json() : Json(trial)},
          {"x_m", pose.x_m},
          {"y_m", pose.y_m},
          {"heading_deg", pose.heading_rad * 180 / std::numbers::pi},
          {"exposure", rendered.pair.exposure},
          {"saturated", saturated_share(rendered.pair.left)},
          {"edges", rendered.edges.both.size()}};
}

/// A doubt if an image shows little but white.
void doubt_saturation(const Json& poses, Session& session) {
  constexpr double too_much = 0.5;  // of the pixels
  double most = 0;
  for (const Json& pose : poses) most = std::max(most, pose["saturated"].get<double>());
  if (most <= too_much) return;
  session.add_trust_warning(
      fmt::format("up to {:.0f} % of an image is saturated; lower --exposure", 100 * most));
}

/// What was rendered, in a line.
std::string how_rendered(const RenderArguments& options, std::size_t poses) {
  return fmt::format(
      "{} pose{} in {}, rig {}, seed {}: point spread {:g} px, full well {:g} e, read noise {:g} "
      "e, "
      "texture {:g}{}{}",
      poses, poses == 1 ? "" : "s", std::filesystem::path(options.world).filename().string(),
      std::filesystem::path(options.rig).filename().string(), options.seed,
      options.pair.sensor.point_spread_px, options.pair.sensor.full_well_e,
      options.pair.sensor.read_noise_e, options.scene.appearance.texture_contrast,
      options.pair.render.shadows ? ", with shadows" : "",
      options.no_noise ? ", without noise" : "");
}

/// The folder of a pose inside the output folder, and its name in lists.
std::string folder_of(std::size_t pose, std::size_t poses) {
  return poses == 1 ? "" : fmt::format("{:03}/", pose);
}

/// Throws Error if a file to be written is the world or the rig.
void check_outputs(const RenderArguments& options, std::size_t poses) {
  std::vector<std::filesystem::path> inputs = files_of_named_rig(options.rig);
  inputs.push_back(find_world(options.world));
  const std::filesystem::path folder = options.output;
  for (const char* name :
       {"pairs.toml", "render.json", "comparison.json", "comparison.html", "sources.toml"}) {
    check_output_is_not_input(inputs, folder / name);
  }
  for (std::size_t i = 0; i < poses; ++i) {
    for (const std::filesystem::path& name : view_file_names()) {
      check_output_is_not_input(inputs, folder / folder_of(i, poses) / name);
    }
  }
}

/// Adds the files of the comparison. Returns its report.
ComparisonReport add_comparison(OutputFiles& outputs,
                                const RenderArguments& options,
                                const ComparedEdges& compared,
                                std::size_t poses) {
  const std::string how = how_rendered(options, poses);
  ComparisonReport report = comparison_report(compared, how, options.seed);
  const std::filesystem::path folder = options.output;
  outputs.add(folder / "comparison.json", comparison_json(report).dump(1) + "\n");
  outputs.add(folder / "comparison.html", comparison_page(report));
  outputs.add(folder / "sources.toml", compared_sources_toml(report.sources, how));
  return report;
}

Rig rig_for_rendering(const RenderArguments& options, Session& session) {
  const ReadRig file = read_named_rig(options.rig, session);
  require_pair(file.estimate.rig, options.rig, options.rig);
  return file.estimate.rig;
}

void run(RenderArguments options, Session& session) {
  options.scene.appearance.seed = options.seed;
  options.scene.lighting.lamps = !options.no_lamps;
  options.pair.sensor.noise = !options.no_noise;
  check_sensor(options.pair.sensor);
  const std::filesystem::path world_file = find_world(options.world), folder = options.output;
  const World world = build_world(read_world(world_file));
  const Visibility visibility(world);
  const Rig rig = rig_for_rendering(options, session);
  for (const Camera& camera : rig.cameras)
    with_errors_of(options.rig, [&] { check_image_size(camera); });
  const RenderedWorld shared{
      visibility, with_errors_of(options.world, [&] { return image_scene(world, options.scene); }),
      rig, with_errors_of(options.rig, [&] { return rectified_geometry(rig); })};
  const RenderPoses at = poses_of(options, visibility, rig);
  const std::vector<Pose2D>& poses = at.poses;
  if (at.left_out > 0) {
    session.info(
        fmt::format("{} of the first {} queries left out: a surface stands between the cameras",
                    at.left_out, at.trials.back() + 1));
  }

  check_outputs(options, poses.size());
  OutputFiles outputs;
  outputs.add_folder(folder);
  Json made = {{"format", "vernier/render"}, {"version", 1}, {"settings", settings_json(options)}};
  made["poses"] = Json::array();
  std::string pairs = "# made by vernier render; for vernier evaluate and vernier characterise\n\n";
  std::size_t edges = 0;
  ComparedEdges compared;
  const std::vector<Matcher> matchers{edge_matcher(), stretch_matcher()};
  {
    Progress progress(session, "rendering");
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const std::string inside = folder_of(i, poses.size());
      const Pose T_left = left_camera(options, poses[i]);
      const RectifiedView view = rectified_view(rig, shared.geometry, T_left);
      const RenderedView rendered =
          view_of(shared, options, view, T_left, static_cast<std::uint32_t>(i));
      add_view_files(outputs, folder / inside, view, rendered);
      made["poses"].push_back(pose_json(inside, poses[i], at.trials[i], rendered));
      pairs += pair_toml(fmt::format("{:03}", i), inside, rendered.truth);
      edges += rendered.edges.both.size();
      if (options.compare) {
        add_pair(rendered.pair, rendered.edges, search_range(rendered.truth.left), matchers,
                 compared);
      }
      progress.update(static_cast<int>(i) + 1, static_cast<int>(poses.size()));
    }
  }
  outputs.add(folder / "pairs.toml", pairs);
  outputs.add(folder / "render.json", made.dump(1) + "\n");
  std::string text =
      fmt::format("{} pair{} of {}x{} px with {} edges visible in both eyes written to {}\n",
                  poses.size(), poses.size() == 1 ? "" : "s", rig.cameras[0].size_px[0],
                  rig.cameras[0].size_px[1], edges, options.output);
  if (options.compare) {
    const ComparisonReport report = add_comparison(outputs, options, compared, poses.size());
    made["comparison"] = comparison_json(report);
    text += "\n" + comparison_text(report);
  }
  doubt_saturation(made["poses"], session);
  outputs.commit();
  session.result(made, text);
}

}  // namespace

void add_render(CLI::App& app, Session& session) {
  auto o = std::make_shared<RenderArguments>();
  CLI::App* verb = add_verb(
      app, session, "render", "render what a rig sees of a world as grey images, with their truth",
      "vernier render --world workshop --rig nominal --pose 10,7.5,0 -o images\n"
      "  a set for evaluate and characterise:  vernier render --poses 12 -o set");
  add_render_options(*verb, *o);
  verb->add_flag("--compare", o->compare,
                 "compare what detectors and matchers make of the images with what the simulator's "
                 "sources assume: a table, comparison.html, comparison.json and sources.toml");
  verb->add_option("-o,--output", o->output, "output folder")->required();
  check_folder_written(*verb, "--output");
  verb->callback([o, &session] {
    if (o->poses.empty() && o->pose_count == 0) {
      throw CLI::RequiredError("--pose or --poses");
    }
    session.action = [=, &session] { run(*o, session); };
  });
}

}  // namespace vernier::cli
