// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// How sensing and loading grow with the world: offices side by side, 25 m apart, of which a robot
// in the first sees no more whatever the number of the others. CSV:
//
//   world_growth > growth.csv        (bench/plot_world_growth.py growth.csv FIGURE.svg)
//
// Columns: segments; segments seen by the left eye (mean); CPU ms of a frame: both eyes, all
// default sources; CPU s to prepare visibility; CPU s to read and build the world from its file
// with templates (`load_s`) and with every feature written out (`load_flat_s`).
#include <sys/resource.h>

#include <unistd.h>
#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/rig_estimate.h"
#include "datasets/shipped.h"
#include "localise/place.h"
#include "sim/buildings/office.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace {

using namespace vernier;
using namespace vernier::sim;
using namespace vernier::sim::internal;
using Eigen::Vector3d;

constexpr double pitch_m = 25;
constexpr int columns = 10;

double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// `copies` of an office; its loose features become a template too. Only the first has a route.
WorldDescription side_by_side(const WorldDescription& office, int copies) {
  WorldDescription world;
  world.name = std::to_string(copies) + " offices";
  world.templates = office.templates;
  world.templates.push_back({"loose features", office.loose});
  world.route = office.route;
  for (int k = 0; k < copies; ++k) {
    const Vector3d shift(pitch_m * (k % columns), pitch_m * (k / columns), 0);
    for (WorldInstance instance : office.instances) {
      instance.at_m += shift;
      world.instances.push_back(std::move(instance));
    }
    world.instances.push_back({"loose features", shift, 0});
  }
  return world;
}

/// The same world with every feature written out, as an imported mesh is.
WorldDescription flat(const World& world) {
  WorldDescription result;
  result.name = world.name;
  for (const WorldSegment& segment : world.segments) {
    result.loose.segments_m.emplace_back(segment.a_m, segment.b_m);
  }
  for (const WorldSurface& surface : world.surfaces) {
    result.loose.surfaces_m.push_back(surface.polygon_m);
  }
  for (const WorldCorner& corner : world.corners) {
    result.loose.corners_m.push_back(corner.position_m);
  }
  result.route = world.route;
  return result;
}

double load_s(const WorldDescription& description) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("vernier-growth-" + std::to_string(getpid()) + ".world.toml");
  write_world(description, file);
  const double start = cpu_s();
  double used = NAN;
  try {
    const World world = build_world(read_world(file));
    used = cpu_s() - start;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  std::filesystem::remove(file);
  return used;
}

void measure(const WorldDescription& description) {
  constexpr int frames = 400;
  const World world = build_world(description);
  double start = cpu_s();
  const Visibility visibility(world);
  const double prepare = cpu_s() - start;
  const Rig rig = datasets::nominal_truth();
  const Sensor sensor(rig, {});
  const std::vector<localise::Pose2D> places = map_poses(description.route, 0.5);
  std::size_t seen = 0;
  const auto frame = [&](int i) {
    const NoiseFreeView view = look(visibility, rig, places[i % places.size()]);
    seen += view.edges.size();
    return sensor.sense(view, {.trial = static_cast<std::uint32_t>(i)}).segments.size();
  };
  std::size_t kept = 0;
  for (int i = 0; i < 40; ++i) kept += frame(i);
  seen = 0;
  start = cpu_s();
  for (int i = 0; i < frames; ++i) kept += frame(i);
  const double sensing = (cpu_s() - start) / frames * 1e3;
  std::printf("%zu,%.1f,%.4f,%.4f,%.3f,%.3f\n", world.segments.size(),
              static_cast<double>(seen) / frames, sensing, prepare, load_s(description),
              load_s(flat(world)));
  std::fflush(stdout);
  if (kept == 0) std::fprintf(stderr, "nothing was seen\n");
}

}  // namespace

int main() {
  try {
    std::printf("segments,seen,frame_ms,prepare_s,load_s,load_flat_s\n");
    measure(make_office(1, {.size_m = {6, 8, 2.5}}));
    for (const int copies : {1, 3, 10, 30, 104}) {
      measure(side_by_side(datasets::workshop(), copies));
    }
  } catch (const vernier::Error& error) {
    std::fprintf(stderr, "world_growth: %s\n", error.what());
    return 2;
  }
}
