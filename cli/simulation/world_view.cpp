// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/world_view.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/page.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/simulation/source_options.h"
#include "localise/place.h"
#include "sim/mount_error.h"
#include "sim/moved_furniture.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/sources/source_losses.h"
#include "sim/visibility.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace vernier::cli {
namespace {

struct ViewArguments {
  std::string world, rig = "nominal", output;
  SourceOptions sources;
  double height_m = 1.2, pitch_deg = 0;
  std::uint64_t seed = 1;
  int poses = 60;
};

/// Coordinates in whole millimetres, which take a third of the space of metres.
void add_point(Json& numbers, const Eigen::Vector3d& p) {
  for (const double x : p) numbers.push_back(std::lround(1000 * x));
}

void add_edge(Json& numbers, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  add_point(numbers, a);
  add_point(numbers, b);
}

constexpr double above_m = 1.9;  // what one looks through from above

bool is_ceiling(const WorldSurface& surface) {
  const auto [low, high] =
      std::minmax_element(surface.polygon_m.begin(), surface.polygon_m.end(),
                          [](const auto& a, const auto& b) { return a.z() < b.z(); });
  return low->z() > above_m && high->z() - low->z() < 0.3;
}

/// Triangles, nine numbers each.
Json surfaces_json(const World& world, bool ceilings) {
  Json numbers = Json::array();
  for (const WorldSurface& surface : world.surfaces) {
    if (is_ceiling(surface) != ceilings) continue;
    for (const std::vector<int>& piece : convex_pieces(surface.polygon_m)) {
      for (std::size_t i = 1; i + 1 < piece.size(); ++i) {
        for (const std::size_t k : {std::size_t{0}, i, i + 1}) {
          add_point(numbers, surface.polygon_m[piece[k]]);
        }
      }
    }
  }
  return numbers;
}

/// Names and words of what is drawn at a pose.
Json kinds_json(const std::vector<std::pair<std::string, std::string>>& kinds) {
  Json json = Json::array();
  for (const auto& [name, text] : kinds) json.push_back({{"name", name}, {"text", text}});
  return json;
}

class PoseViews {
 public:
  PoseViews(const Visibility& visibility,
            const Rig& rig,
            const SourceSettings& sources,
            const ViewArguments& options)
      : visibility_(visibility),
        rig_(rig),
        sources_(sources),
        sensor_(rig, sources_),
        told_mount_{options.height_m, options.pitch_deg * std::numbers::pi / 180},
        seed_(options.seed) {
    kinds_.emplace_back("told", "edges that stereo gets");
  }

  Json view(const Pose2D& pose, std::uint32_t trial) {
    const NoiseFreeViewOptions looking = look_from(draw_mount(told_mount_, sources_, seed_, trial));
    const NoiseFreeView seen = look(visibility_, rig_, pose, looking);
    const SensedEdges sensed = source_losses(sensor_, seen, {.seed = seed_, .trial = trial});
    const Pose T_world_left = T_left_world(pose, looking.mount, looking.roll_rad).inverse();
    Json edges = Json::object();
    const auto add = [&](const std::string& name, const std::vector<SpaceEdge>& list) {
      Json& numbers = edges[name] = Json::array();
      for (const auto& [a, b] : list) add_edge(numbers, T_world_left * a, T_world_left * b);
    };
    add("told", sensed.told);
    for (const SourceLosses& source : sensed.sources) {
      if (!source.lost.empty()) {
        add_kind("lost:" + source.source, "lost to " + source.source);
        add("lost:" + source.source, source.lost);
      }
      if (!source.added.empty()) {
        add_kind("added:" + source.source, "added by " + source.source);
        add("added:" + source.source, source.added);
      }
      // Every edge is displaced by the lateral shift.
      if (!source.displaced.empty() && source.source != "lateral_shift_px") {
        add_kind("displaced:" + source.source, "displaced by " + source.source);
        add("displaced:" + source.source, source.displaced);
      }
    }
    return {{"pose", {pose.x_m, pose.y_m, pose.heading_rad}}, {"edges", edges}};
  }

  const std::vector<std::pair<std::string, std::string>>& kinds() const { return kinds_; }

 private:
  void add_kind(const std::string& name, const std::string& text) {
    const auto known = [&](const auto& kind) { return kind.first == name; };
    if (std::none_of(kinds_.begin(), kinds_.end(), known)) kinds_.emplace_back(name, text);
  }

  const Visibility& visibility_;
  const Rig& rig_;
  SourceSettings sources_;
  Sensor sensor_;  // one, since it may run a program
  localise::CameraMount told_mount_;
  std::uint64_t seed_;
  std::vector<std::pair<std::string, std::string>> kinds_;
};

std::filesystem::path page_folder() {
  const std::filesystem::path page = shipped_file("page/world.html");
  if (page.empty() || !std::filesystem::exists(page.parent_path() / "world.js") ||
      !std::filesystem::exists(page.parent_path() / "three.js")) {
    throw Error("world view", "the page was not built, because three.js or esbuild was missing",
                "install Debian's libjs-three and esbuild, configure and build again");
  }
  return page.parent_path();
}

void run(const ViewArguments& options, Session& session) {
  const std::filesystem::path folder = page_folder();
  const std::filesystem::path file = find_world(options.world);
  check_output_is_not_input({file, options.sources.file}, options.output);
  World world = build_world(read_world(file));
  const SourceSettings sources = sources_of(options.sources);
  if (sources.moved > 0) world = with_moved_furniture(world, sources.moved, options.seed);
  const ReadRig rig = read_named_rig(options.rig, session);
  const Rig& true_rig = rig.estimate.rig;
  const Visibility visibility(world);
  const WorldExtent box = extent(world);
  const Camera& left = true_rig.cameras[0];

  Json edges = Json::array(), edges_above = Json::array(), route = Json::array();
  for (const WorldSegment& s : world.segments) {
    add_edge(std::min(s.a_m.z(), s.b_m.z()) > above_m ? edges_above : edges, s.a_m, s.b_m);
  }
  for (const RouteLeg& leg : world.route) {
    for (std::size_t i = 1; i < leg.points_m.size(); ++i) {
      const Eigen::Vector2d &a = leg.points_m[i - 1], &b = leg.points_m[i];
      add_edge(route, {a.x(), a.y(), 0.02}, {b.x(), b.y(), 0.02});
    }
  }
  PoseViews at_poses(visibility, true_rig, sources, options);
  Json views = Json::array();
  const double length_m = route_length_m(world.route);
  for (int i = 0; i < options.poses && length_m > 0; ++i) {
    const Pose2D pose = route_point(world.route, length_m * (i + 0.5) / options.poses).pose;
    views.push_back(at_poses.view(pose, static_cast<std::uint32_t>(i)));
  }
  const Eigen::Vector3d size = box.high_m - box.low_m;
  const Json data{
      {"name", world.name.empty() ? file.stem().string() : world.name},
      {"about",
       fmt::format("{:.1f} x {:.1f} x {:.1f} m, {} edges, {} surfaces, route of {:.0f} m", size.x(),
                   size.y(), size.z(), world.segments.size(), world.surfaces.size(), length_m)},
      {"extent_m",
       {{box.low_m.x(), box.low_m.y(), box.low_m.z()},
        {box.high_m.x(), box.high_m.y(), box.high_m.z()}}},
      {"camera",
       {{"height_m", options.height_m},
        {"pitch_rad", options.pitch_deg * std::numbers::pi / 180},
        {"vertical_deg",
         2 * std::atan(0.5 * left.size_px[1] / left.f_px()) * 180 / std::numbers::pi}}},
      {"edges", edges},
      {"edges_above", edges_above},
      {"surfaces", surfaces_json(world, false)},
      {"ceilings", surfaces_json(world, true)},
      {"route", route},
      {"views", views},
      {"kinds", kinds_json(at_poses.kinds())}};
  const std::string page = fill_page(read_whole(folder / "world.html"),
                                     {{"<!--VERNIER:CSS-->", read_whole(folder / "world.css")},
                                      {"<!--VERNIER:DATA-->", data_script(data)},
                                      {"<!--VERNIER:THREE-->", read_whole(folder / "three.js")},
                                      {"<!--VERNIER:JS-->", read_whole(folder / "world.js")}});
  write_atomically(options.output, page);
  session.result(
      {{"file", options.output}, {"poses", views.size()}, {"bytes", page.size()}},
      fmt::format("{}: {} edges, {} surfaces, {} poses along the route; open it in a browser\n",
                  options.output, world.segments.size(), world.surfaces.size(), views.size()));
}

}  // namespace

void add_world_view(CLI::App& world, Session& session) {
  auto o = std::make_shared<ViewArguments>();
  CLI::App* verb = add_verb(
      world, session, "view",
      "write a page to fly through a world, and to see what a pose sees and each source of "
      "error takes away",
      "vernier world view workshop -o workshop.html");
  verb->add_option("world", o->world, "world file, or a shipped name")->required();
  verb->add_option("-o,--output", o->output, "page (HTML), which needs nothing else")->required();
  verb->add_option("--rig", o->rig, "rig file or shipped name")->capture_default_str();
  verb->add_option("--poses", o->poses, "along the route, evenly")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  add_source_options(*verb, o->sources);
  verb->add_option("--height-m", o->height_m, "camera height, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--pitch-deg", o->pitch_deg, "camera pitch, degrees; positive is down")
      ->check(CLI::Range(-89.0, 89.0))
      ->capture_default_str();
  verb->add_option("--seed", o->seed, "random seed")->capture_default_str();
  check_files_written(*verb, {"--output"});
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
