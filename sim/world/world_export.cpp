// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world/world_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/world.h"

namespace vernier::sim::internal {

namespace {

/// The points of a world, each once, and lines and faces by their numbers from 0.
struct Numbered {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::pair<std::size_t, std::size_t>> lines;
  std::vector<std::vector<std::size_t>> faces;

  explicit Numbered(const World& world) {
    for (const WorldSegment& segment : world.segments) {
      const std::size_t a = number(segment.a_m), b = number(segment.b_m);
      lines.emplace_back(a, b);
    }
    for (const WorldSurface& surface : world.surfaces) {
      std::vector<std::size_t>& face = faces.emplace_back();
      for (const Eigen::Vector3d& p : surface.polygon_m) face.push_back(number(p));
    }
  }

 private:
  std::size_t number(const Eigen::Vector3d& p) {
    const auto [at, is_new] = numbers_.try_emplace(std::tuple(p.x(), p.y(), p.z()), points.size());
    if (is_new) points.push_back(p);
    return at->second;
  }
  std::map<std::tuple<double, double, double>, std::size_t> numbers_;
};

}  // namespace

std::string world_obj(const World& world) {
  const Numbered numbered(world);
  std::string text =
      "# " + world.name + "\n# metres, z up; lines are edges, faces hide what is behind\n";
  const auto out = std::back_inserter(text);
  for (const auto& p : numbered.points)
    fmt::format_to(out, "v {:.9g} {:.9g} {:.9g}\n", p.x(), p.y(), p.z());
  for (const auto& [a, b] : numbered.lines) fmt::format_to(out, "l {} {}\n", a + 1, b + 1);
  for (const auto& face : numbered.faces) {
    text += 'f';
    for (const std::size_t i : face) fmt::format_to(out, " {}", i + 1);
    text += '\n';
  }
  return text;
}

std::string world_ply(const World& world) {
  const Numbered numbered(world);
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment {}\ncomment metres, z up\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\nelement face {}\n"
      "property list int int vertex_indices\nelement edge {}\nproperty int vertex1\n"
      "property int vertex2\nend_header\n",
      world.name, numbered.points.size(), numbered.faces.size(), numbered.lines.size());
  const auto out = std::back_inserter(text);
  for (const auto& p : numbered.points)
    fmt::format_to(out, "{:.9g} {:.9g} {:.9g}\n", p.x(), p.y(), p.z());
  for (const auto& face : numbered.faces) {
    fmt::format_to(out, "{}", face.size());
    for (const std::size_t i : face) fmt::format_to(out, " {}", i);
    text += '\n';
  }
  for (const auto& [a, b] : numbered.lines) fmt::format_to(out, "{} {}\n", a, b);
  return text;
}

}  // namespace vernier::sim::internal
