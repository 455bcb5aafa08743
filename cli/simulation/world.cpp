// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "calib/base/shown_text.h"
#include "calib/base/utf8.h"
#include "calib/error.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "sim/world/office.h"
#include "sim/world_file.h"

namespace vernier::cli {
namespace {

struct MakeOptions {
  std::uint64_t seed = 1;
  std::string size = "20,15,2.5", name, output;
};

void report(const World& world, const std::string& file, Session& session) {
  const WorldExtent box = extent(world);
  const Eigen::Vector3d size = box.high_m - box.low_m;
  const double route = route_length_m(world.route);
  session.result(
      {{"file", file},
       {"name", world.name},
       {"segments", world.segments.size()},
       {"corners", world.corners.size()},
       {"surfaces", world.surfaces.size()},
       {"objects", world.objects.size()},
       {"repeated_share", repeated_share(world)},
       {"size_m", {size.x(), size.y(), size.z()}},
       {"route_m", route},
       {"legs", world.route.size()}},
      fmt::format("{} ({})\n"
                  "  {:.2f} x {:.2f} x {:.2f} m, {} segments ({:.1f} % from repeated templates),\n"
                  "  {} corners, {} surfaces, {} objects; route of {:.1f} m in {} legs\n",
                  world.name.empty() ? "unnamed world" : world.name, file, size.x(), size.y(),
                  size.z(), world.segments.size(), 100 * repeated_share(world),
                  world.corners.size(), world.surfaces.size(), world.objects.size(), route,
                  world.route.size()));
}

void make(const MakeOptions& options, Session& session) {
  const std::vector<double> size = parse_numbers(options.size, 3, "--size-m");
  OfficeOptions office;
  office.size_m = {size[0], size[1], size[2]};
  WorldDescription description = make_office(options.seed, office);
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

void info(const std::string& name, Session& session) {
  const std::filesystem::path file = find_world(name);
  report(build_world(read_world(file)), file.string(), session);
}

}  // namespace

void add_world(CLI::App& app, Session& session) {
  CLI::App* verb = app.add_subcommand("world", "generate and inspect worlds");
  verb->require_subcommand(1);
  verb->footer("Example:\n  vernier world make --seed 7 -o my.world.toml");

  auto o = std::make_shared<MakeOptions>();
  CLI::App* maker = add_verb(*verb, session, "make", "generate a random office floor",
                             "vernier world make --seed 7 --size-m 20,15,2.5 -o my.world.toml");
  maker->add_option("--seed", o->seed, "random seed")->capture_default_str();
  maker->add_option("--size-m", o->size, "length,width,height in metres")->capture_default_str();
  maker->add_option("--name", o->name, "name of the world");
  maker->add_option("-o,--output", o->output, "world file")->required();
  maker->callback([o, &session] { session.action = [=, &session] { make(*o, session); }; });

  auto name = std::make_shared<std::string>();
  CLI::App* info_verb =
      add_verb(*verb, session, "info", "print feature counts, size and route of a world",
               "vernier world info workshop");
  info_verb->add_option("world", *name, "world file, or a shipped name (workshop)")->required();
  info_verb->callback(
      [name, &session] { session.action = [=, &session] { info(*name, session); }; });
}

}  // namespace vernier::cli
