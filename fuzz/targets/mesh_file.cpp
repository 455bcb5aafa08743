// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/mesh_files/mesh_file.h"

#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"
#include "sim/import/imported_world.h"
#include "sim/import/mesh.h"
#include "sim/mesh_files/child_process.h"
#include "sim/mesh_files/mesh_bytes.h"
#include "sim/world.h"
#include "sim/world/world_export.h"

namespace vernier::fuzz {
namespace {

using namespace sim;
using namespace sim::internal;

/// A mesh that was read becomes a world, or is refused; a world that came of it can be built.
void import(const Mesh& mesh) {
  if (mesh.triangles.size() + mesh.lines.size() > 5000) return;
  const auto imported = accepted([&] { return import_world(mesh, {}, "mesh"); });
  if (imported) build_world(imported->world);
}

void run_ply(std::string_view bytes) {
  const auto file = input_file(bytes, "input.ply");
  if (const auto mesh = accepted([&] { return read_ply(file); })) import(*mesh);
}

void run_line_list(std::string_view bytes) {
  const auto file = input_file(bytes, "input.lines.txt");
  if (const auto mesh = accepted([&] { return read_line_list(file); })) import(*mesh);
}

void run_line_tracks(std::string_view bytes) {
  const auto file = input_file(bytes, "input.tracks.txt");
  if (const auto mesh = accepted([&] { return read_line_tracks(file, 1); })) import(*mesh);
}

/// What a child process with a reader in it tells of a mesh: any bytes, if the reader has damaged
/// its memory.
void run_child_mesh(std::string_view bytes) {
  const std::string told(bytes);
  const auto result = accepted([&] { return child_result(told, "mesh"); });
  if (!result) return;
  const auto mesh = accepted([&] { return mesh_of_bytes(*result, "mesh"); });
  if (!mesh) return;
  const std::string written = mesh_bytes(*mesh);
  require(mesh_bytes(mesh_of_bytes(written, "written")) == written,
          "what is written is read as the same");
  import(*mesh);
}

/// A room with a step in its floor.
World room() {
  World world;
  world.name = "room";
  const auto wall = [&](Eigen::Vector3d a, Eigen::Vector3d b, const Eigen::Vector3d& up) {
    world.surfaces.push_back({{a, b, b + up, a + up}, 0});
    world.segments.push_back({a, b, 0});
  };
  const Eigen::Vector3d up(0, 0, 2.5);
  wall({0, 0, 0}, {6, 0, 0}, up);
  wall({6, 0, 0}, {6, 4, 0}, up);
  wall({6, 4, 0}, {0, 4, 0}, up);
  wall({0, 4, 0}, {0, 0, 0}, up);
  wall({0, 0, 0}, {6, 0, 0}, {0, 2, 0});
  wall({0, 2, 0}, {6, 2, 0}, {0, 0, 0.2});
  return world;
}

std::vector<std::string> ply_seeds() {
  return {world_ply(room()),
          "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n"
          "property double y\nproperty short z\nelement face 0\n"
          "property list uchar uint vertex_index\nend_header\n" +
              std::string(14, '\1')};
}

std::vector<std::string> child_mesh_seeds() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 0, 2.5}, {0, 3, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
  mesh.lines = {{0, 3}};
  mesh.up_axis = 2;
  mesh.unit_m = 0.001;
  mesh.doors = 1;
  return {"G" + mesh_bytes(mesh), "G" + mesh_bytes({}),
          "R" + std::string("file.ifc:7\0is wrong\0mend it", 27)};
}

std::vector<std::string> line_list_seeds() {
  return {
      "# a room\n0 0 0 6 0 0\n6 0 0 6 4 0\n6 4 0 0 4 0\n0 4 0 0 0 0\n0 0 0 0 0 2.5\n"
      "6,0,0,6,0,2.5\r\n"};
}

std::vector<std::string> line_tracks_seeds() {
  return {
      "3\n0 4 3\n0 0 0\n6 0 0\n1 1 2 3 \n0 0 1 2 \n1 2 2\n6 0 0\n6 4 0\n1 2 \n4 5 \n2 2 2\n0 0 0\n"
      "0 0 2.5\n1 2 \n3 1 \n"};
}

const Registered child_mesh({"child_mesh", 400, "", run_child_mesh, child_mesh_seeds});
const Registered ply({"ply", 4000, "ply", run_ply, ply_seeds});
const Registered line_list({"line_list", 2000, "columns", run_line_list, line_list_seeds});
const Registered line_tracks({"line_tracks", 2000, "columns", run_line_tracks, line_tracks_seeds});

}  // namespace
}  // namespace vernier::fuzz
