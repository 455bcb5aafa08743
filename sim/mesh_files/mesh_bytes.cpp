// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/mesh_files/mesh_bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "calib/error.h"
#include "sim/import/mesh.h"

namespace vernier::sim::internal {

namespace {

struct MeshHead {
  std::uint64_t vertices, triangles, lines, parts_left_out, doors;
  double unit_m;         // 0: not said
  std::int64_t up_axis;  // -1: not said
};

template <class T>
void put(std::string& bytes, const std::vector<T>& values) {
  if (values.empty()) return;
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

template <class T>
void take(const std::string& bytes, std::size_t& at, std::uint64_t count, std::vector<T>& values) {
  values.resize(count);
  if (count > 0)
    std::memcpy(static_cast<void*>(values.data()), bytes.data() + at, count * sizeof(T));
  at += count * sizeof(T);
}

/// Whether the parts that it counts are as long as all bytes.
bool fits(const MeshHead& head, std::uint64_t size) {
  // no overflow below
  if (std::max({head.vertices, head.triangles, head.lines}) > size) return false;
  return size == sizeof head + head.vertices * sizeof(Eigen::Vector3d) +
                     head.triangles * sizeof(std::array<std::uint32_t, 3>) +
                     head.lines * sizeof(std::array<std::uint32_t, 2>);
}

bool has_its_vertices(const Mesh& mesh) {
  const auto is_there = [&](std::uint32_t vertex) { return vertex < mesh.vertices.size(); };
  const auto are_there = [&](const auto& ends) {
    return std::all_of(ends.begin(), ends.end(), is_there);
  };
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), are_there) &&
         std::all_of(mesh.lines.begin(), mesh.lines.end(), are_there);
}

}  // namespace

std::string mesh_bytes(const Mesh& mesh) {
  const MeshHead head{
      mesh.vertices.size(), mesh.triangles.size(),   mesh.lines.size(),        mesh.parts_left_out,
      mesh.doors,           mesh.unit_m.value_or(0), mesh.up_axis.value_or(-1)};
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
  put(bytes, mesh.vertices);
  put(bytes, mesh.triangles);
  put(bytes, mesh.lines);
  return bytes;
}

Mesh mesh_of_bytes(const std::string& bytes, const std::string& place) {
  MeshHead head{};
  if (bytes.size() >= sizeof head) std::memcpy(&head, bytes.data(), sizeof head);
  if (!fits(head, bytes.size())) {
    throw Error(place, "was not read to its end", "run it again where there is more memory");
  }
  Mesh mesh;
  std::size_t at = sizeof head;
  take(bytes, at, head.vertices, mesh.vertices);
  take(bytes, at, head.triangles, mesh.triangles);
  take(bytes, at, head.lines, mesh.lines);
  const bool has_unit = std::isfinite(head.unit_m) && head.unit_m >= 0;
  if (!has_unit || head.up_axis < -1 || head.up_axis > 2 || !has_its_vertices(mesh)) {
    throw Error(place, "is damaged, or of a kind on which its reader fails",
                "check the file, or convert it to another format");
  }
  mesh.parts_left_out = head.parts_left_out;
  mesh.doors = head.doors;
  if (head.unit_m > 0) mesh.unit_m = head.unit_m;
  if (head.up_axis >= 0) mesh.up_axis = static_cast<int>(head.up_axis);
  return mesh;
}

}  // namespace vernier::sim::internal
