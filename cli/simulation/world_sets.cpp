// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/world_sets.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_file.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/study/standing_place.h"
#include "sim/visibility.h"
#include "sim/visibility/view_sets.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace vernier::cli {
namespace {

struct SetsOptions {
  std::string world, output, rig = "nominal";
  double spacing_m = 0.5, height_m = 1.2;
  int headings = 16, poses = 200;
};

void make_sets(const SetsOptions& options, Session& session) {
  const std::filesystem::path file = find_world(options.world);
  WorldDescription description = read_world(file);
  description.view_sets.clear();
  World world = build_world(description);
  if (world.route.empty()) {
    throw Error(file.string(), "has no route beside which sets could be made",
                "propose one: vernier world route");
  }
  const Rig rig = read_rig(find_rig(options.rig)).estimate.rig;
  const localise::CameraMount mount{options.height_m, 0};
  const Visibility visibility(world);
  std::vector<localise::Pose2D> poses = map_poses(world.route, options.spacing_m, options.headings);
  std::erase_if(poses, [&](const localise::Pose2D& pose) {
    return !standing_fault(visibility, pose, options.height_m).empty();
  });
  if (poses.empty()) {
    throw Error("--height-m " + fmt::format("{:g}", options.height_m),
                "a camera can stand nowhere along the route at this height",
                "give the height of the robot's camera");
  }
  description.view_sets = view_sets(visibility, rig.cameras.at(0), mount, poses);
  world.view_sets = description.view_sets;
  std::size_t segments = 0;
  for (const ViewSet& set : world.view_sets) segments += set.segments.size();
  const double mean = static_cast<double>(segments) / static_cast<double>(world.view_sets.size());
  const SetFigures figures = set_figures(world, rig, options.poses, options.height_m);
  write_world(description, options.output);
  session.result({{"file", options.output},
                  {"sets", world.view_sets.size()},
                  {"segments_mean", mean},
                  {"agreement", figures.json}},
                 fmt::format("{}: {} view sets of {:.0f} segments on average\n{}", options.output,
                             world.view_sets.size(), mean, figures.text));
}

}  // namespace

SetFigures set_figures(const World& world, const Rig& rig, int poses, double height_m) {
  const Visibility visibility(world);
  const QueryPlaces places(visibility, QueryProtocol::path, height_m);
  std::vector<localise::Pose2D> drawn;
  for (int i = 0; i < poses; ++i) drawn.push_back(places.draw(1, static_cast<std::uint32_t>(i)));
  const SetAgreement agreement = set_agreement(world, rig.cameras.at(0), {height_m, 0}, drawn);
  return {
      {{"poses", poses},
       {"precision", agreement.precision},
       {"recall", agreement.recall},
       {"without_set", agreement.without_set}},
      fmt::format("  of the edges' length by view sets {:.1f} % is seen, and of what is seen the "
                  "sets have {:.1f} %;\n  {:.1f} % of {} views beside the route have no set\n",
                  100 * agreement.precision, 100 * agreement.recall, 100 * agreement.without_set,
                  poses)};
}

void add_world_sets(CLI::App& world, Session& session) {
  auto o = std::make_shared<SetsOptions>();
  CLI::App* verb =
      add_verb(world, session, "sets",
               "write what is seen from poses along the route as view sets, the memo's "
               "view-dependency file",
               "vernier world sets workshop -o workshop-sets.world.toml");
  verb->add_option("world", o->world, "world file, or a shipped name")->required();
  verb->add_option("-o,--output", o->output, "world file with the sets")->required();
  verb->add_option("--rig", o->rig, "rig file or shipped name, whose left camera looks")
      ->capture_default_str();
  verb->add_option("--spacing-m", o->spacing_m, "of the poses along the route")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--headings", o->headings, "at each place, all around; 0: one, along the route")
      ->check(CLI::Range(0, 360))
      ->capture_default_str();
  verb->add_option("--height-m", o->height_m, "height of the robot's camera, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--poses", o->poses, "at which the sets are compared with exact visibility")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  check_files_written(*verb, {"--output"});
  verb->callback([o, &session] { session.action = [=, &session] { make_sets(*o, session); }; });
}

}  // namespace vernier::cli
