// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/world_import.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/output_files.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "cli/simulation/plan_picture.h"
#include "cli/simulation/route_remarks.h"
#include "sim/import/axes_and_unit.h"
#include "sim/import/camera_path.h"
#include "sim/import/imported_world.h"
#include "sim/import/mesh.h"
#include "sim/mesh_files/mesh_file.h"
#include "sim/routing/floor_plan.h"
#include "sim/routing/route_proposal.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace vernier::cli {
namespace {

struct ImportArguments {
  std::string file, output, name, unit, up, plan, colmap;
  sim::internal::ImportOptions options;
  double eye_height_m = 1.2;
  bool no_route = false;
  MeshSelection selection;
};

double unit_of(const std::string& word) {
  static const std::map<std::string, double> units{
      {"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}};
  const auto found = units.find(word);
  if (found != units.end()) return found->second;
  const std::optional<double> metres = vernier::internal::to_real(word);
  if (metres && *metres >= 1e-6 && *metres <= 1e6) return *metres;
  throw Error("--unit " + vernier::internal::shortened(word), "is no unit of length",
              "use m, cm, mm, in, ft, or the number of metres of one");
}

int axis_of(const std::string& word) {
  if (word == "x" || word == "y" || word == "z") return word[0] - 'x';
  throw Error("--up " + vernier::internal::shortened(word), "is no axis", "use x, y or z");
}

/// Zero without the sign that rounding leaves it.
double shown_m(double height_m) { return std::abs(height_m) < 0.005 ? 0 : height_m; }

std::string storeys_text(const ImportReport& report, const sim::internal::ImportOptions& options) {
  const std::string ends =
      report.top_m ? fmt::format(", up to {:.2f} m", shown_m(*report.top_m)) : std::string();
  const double floor_m = shown_m(report.floor_m);
  if (options.floor_m) return fmt::format("floor at {:.2f} m (given){}", floor_m, ends);
  if (report.storeys_m.empty()) {
    return fmt::format("no storeys found, floor at the lowest point, {:.2f} m{}", floor_m, ends);
  }
  if (report.storeys_m.size() == 1) return fmt::format("floor at {:.2f} m{}", floor_m, ends);
  std::vector<double> floors_m;
  for (const double height_m : report.storeys_m) floors_m.push_back(shown_m(height_m));
  return fmt::format("floors at {:.2f} m; storey {} was taken, from {:.2f} m{}",
                     fmt::join(floors_m, ", "), options.storey, floor_m, ends);
}

std::string upright_text(const ImportReport& report) {
  std::string text;
  if (report.made_upright > 0) text = fmt::format("; {} made upright", report.made_upright);
  if (report.levelled_deg > 0) {
    text += fmt::format("; the building was levelled by {:.2f} degrees", report.levelled_deg);
  }
  return text;
}

/// Warns of a list of lines that does not look as if z were up.
void doubt_axis_of_list(const Mesh& mesh, const ImportArguments& arguments, Session& session) {
  constexpr std::size_t least_lines = 12;  // of a room
  if (mesh.format != "list of lines" || mesh.lines.size() < least_lines ||
      arguments.options.up_axis) {
    return;
  }
  Mesh unsaid = mesh;
  unsaid.up_axis.reset();
  try {
    const int up = axes_and_unit(unsaid, {}, 1, arguments.file).up_axis;
    if (up == 2) return;
    session.warn(fmt::format("{}: z is up in lists of lines, but by its shape {} is; see --up",
                             arguments.file, static_cast<char>('x' + up)));
  } catch (const Error&) {  // it does not show
  }
}

/// Warns of a unit that nothing in a reconstruction from images shows.
void doubt_unit_of_tracks(const Mesh& mesh,
                          const ImportArguments& arguments,
                          const ImportReport& report,
                          Session& session) {
  if (mesh.format != "line tracks" || !arguments.unit.empty()) return;
  session.warn(
      fmt::format("{}: images give no unit of length; {:g} m was taken because the lines "
                  "are then as large as a building; say with --unit how many metres one "
                  "is",
                  arguments.file, report.axes.unit_m));
}

/// With --colmap: turns the mesh so that z is up, and finds its unit and its floor. The cameras are
/// turned likewise.
std::vector<PathCamera> level_by_cameras(ImportArguments& arguments, Mesh& mesh) {
  if (arguments.colmap.empty()) return {};
  sim::internal::ImportOptions& options = arguments.options;
  if (options.up_axis) throw Error("--up", "is given beside --colmap", "leave one out");
  if (options.storey != 1) {
    throw Error("--storey", "is given beside --colmap, whose cameras say where the floor is",
                "leave one out, or give --floor-m");
  }
  std::vector<PathCamera> cameras = read_camera_path(arguments.colmap);
  level(up_of(cameras, mesh, arguments.colmap), mesh, cameras);
  options.is_level = true;
  options.unit_m = axes_and_unit(mesh, options.up_axis, options.unit_m, arguments.file).unit_m;
  if (!options.floor_m) {
    options.floor_m = *options.unit_m * median_height(cameras) - arguments.eye_height_m;
  }
  return cameras;
}

void run(ImportArguments arguments, Session& session) {
  sim::internal::ImportOptions& options = arguments.options;
  if (!arguments.unit.empty()) options.unit_m = unit_of(arguments.unit);
  if (!arguments.up.empty()) options.up_axis = axis_of(arguments.up);
  if (options.floor_m && options.storey != 1) {
    throw Error("--storey", "is given beside --floor-m", "leave one out");
  }
  for (const std::string* output : {&arguments.output, &arguments.plan}) {
    std::vector<std::filesystem::path> inputs{arguments.file};
    if (!arguments.colmap.empty()) {
      inputs.push_back(std::filesystem::path(arguments.colmap) / "images.txt");
    }
    check_output_is_not_input(inputs, *output);
  }
  Mesh mesh = read_mesh(arguments.file, arguments.selection);
  doubt_axis_of_list(mesh, arguments, session);
  const std::vector<PathCamera> cameras = level_by_cameras(arguments, mesh);
  if (mesh.doors > 0) {
    session.info(
        fmt::format("{}: its {} doors stand as the file has them, mostly closed; "
                    "--leave-out IfcDoor opens them",
                    arguments.file, mesh.doors));
  }
  ImportedWorld imported = import_world(mesh, options, arguments.file);
  ImportReport& report = imported.report;
  if (!cameras.empty()) {
    report.axes.up_because = "by its cameras";
    if (arguments.unit.empty()) report.axes.unit_because = "by its size";
  }
  doubt_unit_of_tracks(mesh, arguments, report, session);
  WorldDescription& description = imported.world;
  description.name = arguments.name.empty() ? std::filesystem::path(arguments.file).stem().string()
                                            : arguments.name;
  if (!arguments.selection.leave_out.empty() && mesh.parts_left_out == 0) {
    session.warn(fmt::format("{}: no part has {} in its name, nothing is left out", arguments.file,
                             fmt::join(arguments.selection.leave_out, " or ")));
  }
  const bool is_open = description.loose.surfaces_m.empty();
  if (is_open) {
    session.warn(arguments.file + ": holds lines only; without surfaces nothing hides anything");
  }
  if (report.shorter > report.edges / 2) {
    session.warn(
        fmt::format("{}: {} of {} edges are shorter than {:g} m and left out, as those of "
                    "round things are; see --shortest-m",
                    arguments.file, report.shorter, report.edges, options.shortest_m));
  }
  if (report.floor_slope_deg > 0) {
    session.warn(
        fmt::format("{}: its floor slopes by {:.1f} degrees; the world's is level at {:g} m, and "
                    "what lies below "
                    "that is left out: level the file, or give --floor-m",
                    arguments.file, report.floor_slope_deg, report.floor_m));
  }
  constexpr std::size_t least_shallow = 12;  // a column of as many sides
  constexpr double above_shallow_deg = 36;
  if (report.creases.shallow_uprights >= least_shallow && options.crease_deg < above_shallow_deg) {
    session.warn(fmt::format(
        "{}: {} upright edges are between faces that meet at less than 35 degrees, as those of "
        "round columns; --crease-deg {:g} leaves them out",
        arguments.file, report.creases.shallow_uprights, above_shallow_deg));
  }
  const World without_route = build_world(description);
  constexpr double highest_storey_m = 5;
  if (report.storeys_m.empty() && !is_open) {
    const WorldExtent all = extent(without_route);
    if (all.high_m.z() > highest_storey_m) {
      session.warn(
          fmt::format("{}: no storeys were found, and the world is {:.1f} m high; see "
                      "--floor-m and --top-m",
                      arguments.file, all.high_m.z()));
    }
  }
  RouteProposal proposal;
  if (!cameras.empty() && !arguments.no_route) {
    description.route = route_of(cameras, report.axes.unit_m, report.moved_m);
    if (description.route.empty()) {
      session.warn(arguments.colmap +
                   ": its cameras make no way of 0.1 m; give [[route]] points_m");
    }
  } else if (!arguments.no_route) {
    try {
      proposal = propose_route(FloorPlan(without_route, arguments.eye_height_m));
    } catch (const Error& error) {  // a floor that is too large
      session.warn(error.what());
    }
    description.route = proposal.route;
    if (const std::string open = open_floor_text(proposal); !open.empty()) {
      session.warn(arguments.file + ": " + open);
    }
    if (proposal.route.empty()) {
      session.warn(
          arguments.file +
          ": no floor was found on which a robot can drive; give [[route]] points_m to the "
          "world file, or another --storey or --floor-m");
    }
  }
  const World world = build_world(description);
  OutputFiles outputs;
  outputs.add(arguments.output, format_world(description));
  if (!arguments.plan.empty()) outputs.add(arguments.plan, plan_svg(world));
  outputs.commit();

  const WorldExtent box = extent(world);
  const Eigen::Vector3d size = box.high_m - box.low_m;
  const char axis = static_cast<char>('x' + report.axes.up_axis);
  const std::string moved =
      report.moved_m.isZero()
          ? ""
          : fmt::format("  its plan was moved by {:.0f}, {:.0f} m to the origin\n",
                        -report.moved_m.x(), -report.moved_m.y());
  const double length_m = route_length_m(world.route);
  const std::string route =
      world.route.empty() ? "no route\n"
      : !cameras.empty() && !arguments.no_route
          ? fmt::format("the way of its {} cameras, {:.1f} m in {} legs, is the route\n",
                        cameras.size(), length_m, world.route.size())
          : fmt::format("a route of {:.1f} m in {} legs, {}\n", length_m, world.route.size(),
                        floor_text(proposal));
  session.result(
      {{"file", arguments.output},
       {"format", mesh.format},
       {"up", std::string(1, axis)},
       {"up_because", report.axes.up_because},
       {"unit_m", report.axes.unit_m},
       {"unit_because", report.axes.unit_because},
       {"triangles", report.triangles},
       {"lines", report.lines},
       {"storeys_m", report.storeys_m},
       {"floor_m", report.floor_m},
       {"parts_left_out", mesh.parts_left_out},
       {"edges", report.edges},
       {"edges_of_other_storeys", report.outside},
       {"edges_below_floor", report.below},
       {"edges_too_short", report.shorter},
       {"edges_made_upright", report.made_upright},
       {"levelled_deg", report.levelled_deg},
       {"floor_slope_deg", report.floor_slope_deg},
       {"segments", world.segments.size()},
       {"corners", world.corners.size()},
       {"surfaces", world.surfaces.size()},
       {"size_m", {size.x(), size.y(), size.z()}},
       {"moved_m", {report.moved_m.x(), report.moved_m.y()}},
       {"route_m", length_m},
       {"legs", world.route.size()},
       {"floor_m2", proposal.floor_m2},
       {"floor_near_route_m2", proposal.near_m2},
       {"floor_cut_off_m2", proposal.other_m2},
       {"floor_at_other_levels_m2", proposal.level_m2},
       {"floor_open_m2", proposal.open_m2}},
      fmt::format(
          "{}: {}, {} triangles and {} lines\n"
          "  {} is up ({}), a unit is {:g} m ({}); {}\n{}"
          "  {} edges, of them {} below the floor, {} above the top and {} shorter than {:g} m{}\n"
          "{}: {:.1f} x {:.1f} x {:.1f} m, {} segments, {} corners, {} surfaces\n  {}",
          arguments.file, mesh.format, report.triangles, report.lines, axis, report.axes.up_because,
          report.axes.unit_m, report.axes.unit_because, storeys_text(report, options), moved,
          report.edges, report.below, report.outside - report.below, report.shorter,
          options.shortest_m, upright_text(report), arguments.output, size.x(), size.y(), size.z(),
          world.segments.size(), world.corners.size(), world.surfaces.size(), route));
}

}  // namespace

void add_world_import(CLI::App& world, Session& session) {
  auto o = std::make_shared<ImportArguments>();
  CLI::App* verb = add_verb(
      world, session, "import",
      "make a world of one storey of a building: OBJ, PLY, DAE, IFC, glTF, lists of lines, or line "
      "tracks",
      "vernier world import office.ifc --storey 2 -o office.world.toml --plan office.svg");
  verb->add_option("file", o->file, "mesh or lines (docs/worlds.md)")->required();
  verb->add_option("-o,--output", o->output, "world file")->required();
  verb->add_option("--name", o->name, "name of the world (default: of the file)");
  verb->add_option(
      "--unit", o->unit,
      "of length: m, cm, mm, in, ft, or a number of metres (default: the file's, or by its size)");
  verb->add_option("--up", o->up, "axis: x, y or z (default: the file's, or by its shape)");
  verb->add_option("--storey", o->options.storey, "from the lowest, of those found")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--floor-m", o->options.floor_m,
                   "height of the floor in the building, in place of --storey")
      ->check(finite);
  verb->add_option("--top-m", o->options.top_m,
                   "where the world ends above its floor (default: below the next one)")
      ->check(finite_and_positive);
  verb->add_option("--crease-deg", o->options.crease_deg,
                   "surfaces that meet at a smaller angle make no edge")
      ->check(CLI::Range(1.0, 90.0))
      ->capture_default_str();
  verb->add_option("--shortest-m", o->options.shortest_m, "shorter edges are left out")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  verb->add_option(
          "--upright-deg", o->options.upright_deg,
          "edges that lean by at most this become upright where they stay at their surfaces "
          "(0: none)")
      ->check(CLI::Range(0.0, 5.0))
      ->capture_default_str();
  verb->add_option("--colmap", o->colmap,
                   "folder of the model (images.txt) that the line tracks were made with: says "
                   "which way is up, where the floor is (--height-m below its cameras), and the "
                   "route");
  verb->add_option("--min-images", o->selection.least_images,
                   "of line tracks, leave out those that fewer images support")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  verb->add_option("--leave-out", o->selection.leave_out,
                   "parts with this word in their name or material, as IfcDoor (repeatable)");
  verb->add_flag("--no-route", o->no_route, "propose none");
  verb->add_option("--height-m", o->eye_height_m, "height of the robot's camera, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--plan", o->plan, "SVG of the floor plan with the route")->check(svg_name);
  check_files_written(*verb, {"--output", "--plan"});
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
