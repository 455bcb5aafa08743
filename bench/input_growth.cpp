// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// How readers and searches grow with their input: the CPU time of one and of four times as much,
// each the least of three, and their ratio, about 4 where time is linear and 16 where it is
// quadratic.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/random.h"
#include "datasets/shipped.h"
#include "localise/joined_lines.h"
#include "sim/mesh_files/mesh_file.h"
#include "sim/study/ceiling.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "sim/world_file.h"
#include "tests/support/spiral_ply.h"

namespace {

using namespace vernier;
using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;
using Eigen::Vector3d;

/// CPU time of a call, its preparation left out.
using Seconds = std::function<double(int)>;

template <typename Work>
double cpu_s(const Work& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

void print_growth(const char* what, int size, const Seconds& seconds) {
  const auto least = [&](int of) {
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) best = std::min(best, seconds(of));
    return best;
  };
  const double one = least(size), four = least(4 * size);
  std::printf("| %s | %d | %.4g | %d | %.4g | %.1f |\n", what, size, one, 4 * size, four,
              four / one);
}

double world_file_s(int segments) {
  WorldDescription world;
  for (int i = 0; i < segments; ++i) {
    const double x = 0.0123 * i;
    world.loose.segments_m.push_back({{x, 1.2345, 0.5}, {x, 7.6543, 2.4321}});
  }
  const std::string text = format_world(world);
  return cpu_s([&] { parse_world(text, "text"); });
}

double concave_face_s(int corners) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("input_growth_" + std::to_string(std::clock()) + ".ply");
  std::ofstream(file) << test::spiral_ply(corners);
  const double took = cpu_s([&] { read_mesh(file); });
  std::filesystem::remove(file);
  return took;
}

/// Rooms side by side, of 60 lines and 10 views each.
double joined_rooms_s(int rooms) {
  std::vector<SegmentsOfView> views;
  for (int room = 0; room < rooms; ++room) {
    RandomStream draws({.seed = 6, .trial = static_cast<std::uint32_t>(room)});
    const Vector3d shift(8.0 * room, 0, 0);
    std::vector<std::pair<Vector3d, Vector3d>> lines;
    for (int i = 0; i < 60; ++i) {
      const Vector3d middle{draws.uniform(-1.5, 1.5), draws.uniform(-1.5, 1.5),
                            draws.uniform(0, 2.4)};
      const Vector3d way(draws.normals(3));
      const Vector3d along = way.normalized() * draws.uniform(0.15, 0.8);
      lines.emplace_back(middle - along, middle + along);
    }
    for (int v = 0; v < 10; ++v) {
      SegmentsOfView view;
      const double turn = draws.uniform(-1, 1) + 0.3 * v;
      const Eigen::Matrix3d R = (Eigen::AngleAxisd(turn, Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(-1.5708, Vector3d::UnitX()))
                                    .toRotationMatrix();
      view.T_world_camera = {R, shift - 3 * R.col(2) + Vector3d(0, 0, 1.2)};
      for (const auto& [a, b] : lines) {
        SightedSegment segment;
        const Pose T_camera_world = view.T_world_camera.inverse();
        segment.a_m = T_camera_world * Vector3d(a + shift) + 0.003 * Vector3d(draws.normals(3));
        segment.b_m = T_camera_world * Vector3d(b + shift) + 0.003 * Vector3d(draws.normals(3));
        segment.covariance_m2 = 9e-6 * Eigen::Matrix<double, 6, 6>::Identity();
        view.segments.push_back(segment);
      }
      views.push_back(std::move(view));
    }
  }
  return cpu_s([&] { join_lines(views); });
}

/// Upright edges of the same height in one room, of which no pair is rare: one query.
double aliases_s(int uprights) {
  World world;
  world.objects.resize(1);
  RandomStream draws({.seed = 7});
  for (int i = 0; i < uprights; ++i) {
    const Vector3d foot{draws.uniform(0, 20), draws.uniform(0, 20), 0};
    world.segments.push_back({foot, foot + Vector3d(0, 0, 2.5), 0});
  }
  const Visibility visibility(world);
  const RigEstimate nominal = datasets::nominal();
  const AliasFinder finder(visibility, nominal.rig, {});
  return cpu_s([&] { finder.aliases({10, 10, 0.3}); });
}

}  // namespace

int main() {
  try {
    std::puts(
        "| what | size | CPU s | size | CPU s | ratio |\n| --- | --- | --- | --- | --- | --- |");
    print_growth("a world's file, segments", 100'000, world_file_s);
    print_growth("one concave face, corners", 500, concave_face_s);
    print_growth("rooms whose lines are joined", 4, joined_rooms_s);
    print_growth("aliases of a place, upright edges in one room", 5'000, aliases_s);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "input_growth: %s\n", error.what());
    return 1;
  }
}
