// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/output_files.h"
#include "calib/base/shown_text.h"
#include "calib/base/utf8.h"
#include "calib/error.h"
#include "calib/rig_file.h"
#include "calib/statistics/quantile.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/simulation/plan_picture.h"
#include "cli/simulation/route_remarks.h"
#include "cli/simulation/world_build.h"
#include "cli/simulation/world_import.h"
#include "cli/simulation/world_sets.h"
#include "cli/simulation/world_view.h"
#include "sim/buildings/building.h"
#include "sim/experiment.h"
#include "sim/noise_free_view.h"
#include "sim/routing/floor_plan.h"
#include "sim/routing/route_proposal.h"
#include "sim/study/ceiling.h"
#include "sim/visibility.h"
#include "sim/world/world_export.h"
#include "sim/world_file.h"

namespace vernier::cli {
namespace {

constexpr double robot_height_m = 1.2;  // of the camera, where nothing says another

struct MakeOptions {
  std::uint64_t seed = 1;
  std::string kinds = "office", size, name, output;
};

struct InfoOptions {
  std::string world, plan, rig = "nominal", protocol = "path";
  int poses = 200;
  std::uint64_t seed = 1;
  double eye_height_m = robot_height_m;
};

struct ExportOptions {
  std::string world, output;
};

struct RouteOptions {
  std::string world, output, plan;
  double eye_height_m = robot_height_m;
};

Json world_json(const World& world, const std::string& file) {
  const WorldExtent box = extent(world);
  const Eigen::Vector3d size = box.high_m - box.low_m;
  return {{"file", file},
          {"name", world.name},
          {"segments", world.segments.size()},
          {"corners", world.corners.size()},
          {"surfaces", world.surfaces.size()},
          {"objects", world.objects.size()},
          {"repeated_share", repeated_share(world)},
          {"size_m", {size.x(), size.y(), size.z()}},
          {"route_m", route_length_m(world.route)},
          {"legs", world.route.size()}};
}

std::string world_text(const World& world, const std::string& file) {
  const WorldExtent box = extent(world);
  const Eigen::Vector3d size = box.high_m - box.low_m;
  return fmt::format(
      "{} ({})\n"
      "  {:.2f} x {:.2f} x {:.2f} m, {} segments ({:.1f} % from repeated templates),\n"
      "  {} corners, {} surfaces, {} objects; route of {:.1f} m in {} legs\n",
      world.name.empty() ? "unnamed world" : world.name, file, size.x(), size.y(), size.z(),
      world.segments.size(), 100 * repeated_share(world), world.corners.size(),
      world.surfaces.size(), world.objects.size(), route_length_m(world.route), world.route.size());
}

void report(const World& world, const std::string& file, Session& session) {
  session.result(world_json(world, file), world_text(world, file));
}

std::vector<double> segment_lengths_m(const World& world) {
  std::vector<double> lengths;
  for (const WorldSegment& segment : world.segments) {
    lengths.push_back((segment.b_m - segment.a_m).norm());
  }
  return lengths;
}

/// How far places look alike, at poses of a protocol.
struct Aliasing {
  double unique_share = 0, undetermined_share = 0, ceiling = 0;
};

Aliasing aliasing_of(const World& world, const InfoOptions& options) {
  const Visibility visibility(world);
  NoiseFreeViewOptions looking;
  looking.mount.height_m = options.eye_height_m;
  const AliasFinder finder(visibility, read_rig(find_rig(options.rig)).estimate.rig, looking);
  const QueryPlaces places(visibility, query_protocol(options.protocol), options.eye_height_m);
  Aliasing sum;
  for (int i = 0; i < options.poses; ++i) {
    const Aliases aliases =
        finder.aliases(places.draw(options.seed, static_cast<std::uint32_t>(i)), &places);
    const QueryCeiling query = query_ceiling(aliases);
    sum.unique_share += query.unaliased;
    sum.undetermined_share += !aliases.determined;
    sum.ceiling += query.right;
  }
  const double poses = options.poses;
  return {sum.unique_share / poses, sum.undetermined_share / poses, sum.ceiling / poses};
}

std::vector<BuildingKind> kinds_of(const std::string& text) {
  std::vector<BuildingKind> kinds;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    const std::string name = text.substr(from, comma - from);
    const std::optional<BuildingKind> kind = building_kind(name);
    if (!kind) {
      throw Error("--kind", in_quotes(name) + " is no kind of building",
                  "use office, home, hall or corridors, or several with commas between");
    }
    kinds.push_back(*kind);
    from = comma + 1;
  }
  return kinds;
}

std::optional<Eigen::Vector3d> size_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::vector<double> size = parse_numbers(text, 3, "--size-m");
  return Eigen::Vector3d(size[0], size[1], size[2]);
}

void make(const MakeOptions& options, Session& session) {
  WorldDescription description =
      make_building(options.seed, {kinds_of(options.kinds), size_of(options.size)});
  if (!options.name.empty()) {
    constexpr std::size_t most_bytes = 200;
    const auto acts = [](char c) { return static_cast<unsigned char>(c) < 0x20U || c == 0x7f; };
    if (options.name.size() > most_bytes || first_bad_utf8(options.name) != std::string::npos ||
        std::any_of(options.name.begin(), options.name.end(), acts)) {
      throw Error(
          "--name",
          in_quotes(options.name) + " is longer than 200 bytes, not on one line or not UTF-8",
          "shorten or correct it");
    }
    description.name = options.name;
  }
  write_world(description, options.output);
  report(build_world(description), options.output, session);
}

void info(const InfoOptions& options, Session& session) {
  query_protocol(options.protocol);  // refuses others, used or not
  const std::filesystem::path file = find_world(options.world);
  const World world = build_world(read_world(file));
  if (!options.plan.empty()) write_atomically(options.plan, plan_svg(world));
  if (world.route.empty()) {
    session.warn(file.string() + ": has no route; vernier world route proposes one");
  }
  tell_blocked_route(world, file.string(), options.eye_height_m, session);
  Json json = world_json(world, file.string());
  std::string text = world_text(world, file.string());
  const std::vector<double> lengths = segment_lengths_m(world);
  if (!lengths.empty()) {
    const auto at = [&](double share) { return quantile(lengths, share, QuantileKind::linear); };
    json["segment_lengths_m"] = {{"p5", at(0.05)}, {"median", at(0.5)}, {"p95", at(0.95)}};
    text += fmt::format("  segments of {:.2f} m (median; 5 % below {:.2f}, 5 % above {:.2f})\n",
                        at(0.5), at(0.05), at(0.95));
  }
  if (!world.route.empty() && options.poses > 0) {
    const Aliasing aliasing = aliasing_of(world, options);
    json["aliasing"] = {
        {"protocol", options.protocol}, {"height_m", options.eye_height_m},
        {"poses", options.poses},       {"unique_share", aliasing.unique_share},
        {"ceiling", aliasing.ceiling},  {"undetermined_share", aliasing.undetermined_share}};
    text += fmt::format(
        "  of {} views ({}, {:g} m high) {:.1f} % are like no other place's, {:.1f} % leave the "
        "pose open;\n  at best {:.1f} % can be localised (noise-free, guesses counted)\n",
        options.poses, options.protocol, options.eye_height_m, 100 * aliasing.unique_share,
        100 * aliasing.undetermined_share, 100 * aliasing.ceiling);
  }
  if (!world.view_sets.empty() && !world.route.empty() && options.poses > 0) {
    const SetFigures figures =
        set_figures(world, read_rig(find_rig(options.rig)).estimate.rig, options.poses);
    json["view_sets"] = figures.json;
    json["view_sets"]["sets"] = world.view_sets.size();
    text += fmt::format("  {} view sets\n", world.view_sets.size()) + figures.text;
  }
  session.result(json, text);
}

void write_exported(const ExportOptions& options, Session& session) {
  const std::filesystem::path file = find_world(options.world);
  const World world = build_world(read_world(file));
  const std::string ending = std::filesystem::path(options.output).extension().string();
  if (ending != ".obj" && ending != ".ply") {
    throw Error("--output " + options.output, "is neither an OBJ nor a PLY file",
                "end its name in .obj or .ply");
  }
  write_atomically(options.output, ending == ".obj" ? world_obj(world) : world_ply(world));
  session.result({{"file", options.output},
                  {"segments", world.segments.size()},
                  {"surfaces", world.surfaces.size()}},
                 fmt::format("{}: {} segments as {}, {} surfaces as faces; metres, z up\n",
                             options.output, world.segments.size(),
                             ending == ".obj" ? "lines" : "edges", world.surfaces.size()));
}

void route(const RouteOptions& options, Session& session) {
  const std::filesystem::path file = find_world(options.world);
  WorldDescription description = read_world(file);
  description.route.clear();
  const RouteProposal proposal =
      propose_route(FloorPlan(build_world(description), options.eye_height_m));
  if (proposal.route.empty()) {
    throw Error(file.string(), "no floor was found on which a robot can drive",
                "give [[route]] points_m yourself");
  }
  if (const std::string open = open_floor_text(proposal); !open.empty()) {
    session.warn(file.string() + ": " + open);
  }
  session.info(file.string() + ": " + floor_text(proposal));
  description.route = proposal.route;
  const World world = build_world(description);
  OutputFiles outputs;
  outputs.add(options.output, format_world(description));
  if (!options.plan.empty()) outputs.add(options.plan, plan_svg(world));
  outputs.commit();
  report(world, options.output, session);
}

}  // namespace

void add_world(CLI::App& app, Session& session) {
  CLI::App* verb = app.add_subcommand("world", "generate and inspect worlds");
  verb->require_subcommand(1);
  verb->footer("Example:\n  vernier world make --seed 7 -o my.world.toml");

  auto o = std::make_shared<MakeOptions>();
  CLI::App* maker = add_verb(*verb, session, "make", "generate a random floor of a building",
                             "vernier world make --kind office,hall --seed 7 -o my.world.toml");
  maker->add_option("--seed", o->seed, "random seed")->capture_default_str();
  maker
      ->add_option("--kind", o->kinds,
                   "office, home, hall or corridors; several, with commas, stand side by side")
      ->capture_default_str();
  maker->add_option("--size-m", o->size,
                    "length,width,height in metres of the whole, which a net of corridors may not "
                    "fill (default: what suits the kind)");
  maker->add_option("--name", o->name, "name of the world");
  maker->add_option("-o,--output", o->output, "world file")->required();
  check_files_written(*maker, {"--output"});
  maker->callback([o, &session] { session.action = [=, &session] { make(*o, session); }; });

  auto i = std::make_shared<InfoOptions>();
  CLI::App* info_verb =
      add_verb(*verb, session, "info", "print feature counts, size and route of a world",
               "vernier world info workshop --plan workshop.svg");
  info_verb->add_option("world", i->world, "world file, or a shipped name (workshop)")->required();
  info_verb->add_option("--rig", i->rig, "rig file or shipped name, of the aliasing figure")
      ->capture_default_str();
  info_verb->add_option("--poses", i->poses, "views of the aliasing figure; 0: none")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  info_verb
      ->add_option("--protocol", i->protocol, "where they are: near_path, path, anywhere or free")
      ->capture_default_str();
  info_verb
      ->add_option("--seed", i->seed,
                   "of the views, which are the queries of a study with it and the protocol")
      ->capture_default_str();
  info_verb->add_option("--height-m", i->eye_height_m, "height of the robot's camera, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  info_verb->add_option("--plan", i->plan, "SVG of the floor plan with the route")->check(svg_name);
  check_files_written(*info_verb, {"--plan"});
  info_verb->callback([i, &session] { session.action = [=, &session] { info(*i, session); }; });

  auto e = std::make_shared<ExportOptions>();
  CLI::App* exporter =
      add_verb(*verb, session, "export", "write a world as OBJ or PLY, for other programs",
               "vernier world export workshop -o workshop.ply");
  exporter->add_option("world", e->world, "world file, or a shipped name")->required();
  exporter->add_option("-o,--output", e->output, "file that ends in .obj or .ply")->required();
  check_files_written(*exporter, {"--output"});
  exporter->callback(
      [e, &session] { session.action = [=, &session] { write_exported(*e, session); }; });

  auto r = std::make_shared<RouteOptions>();
  CLI::App* router = add_verb(*verb, session, "route",
                              "propose a route through a world's free floor, in place of its own",
                              "vernier world route workshop -o my.world.toml --plan route.svg");
  router->add_option("world", r->world, "world file, or a shipped name")->required();
  router->add_option("-o,--output", r->output, "world file with the route")->required();
  router->add_option("--plan", r->plan, "SVG of the floor plan with the route")->check(svg_name);
  router->add_option("--height-m", r->eye_height_m, "height of the robot's camera, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  check_files_written(*router, {"--output", "--plan"});
  router->callback([r, &session] { session.action = [=, &session] { route(*r, session); }; });

  add_world_sets(*verb, session);
  add_world_build(*verb, session);
  add_world_import(*verb, session);
  add_world_view(*verb, session);
}

}  // namespace vernier::cli
