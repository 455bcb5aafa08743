// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/map_file.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "calib/rig.h"
#include "datasets/shipped.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"
#include "localise/map/part_checksum.h"
#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::fuzz {
namespace {

using namespace localise;

/// The bytes with the checksums of their parts put right, without which hardly one would be read.
std::string with_checksums(std::string_view bytes) {
  std::string right(bytes);
  std::size_t at = 16;
  while (right.size() >= at + 24) {
    std::uint64_t length = 0;
    std::memcpy(&length, right.data() + at + 8, sizeof length);
    if (length > right.size() - at - 24) break;
    const std::uint64_t sum = localise::internal::part_checksum(
        std::string_view(right).substr(at + 24, static_cast<std::size_t>(length)));
    std::memcpy(right.data() + at + 16, &sum, sizeof sum);
    at += 24 + (static_cast<std::size_t>(length) + 7) / 8 * 8;
  }
  return right;
}

void require_same_nodes(const TopologicalMap& a, const TopologicalMap& b) {
  require(a.nodes.size() == b.nodes.size(), "the nodes are kept");
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    const MapNode &p = a.nodes[i], &q = b.nodes[i];
    require(same(p.pose.x_m, q.pose.x_m) && same(p.pose.heading_rad, q.pose.heading_rad),
            "poses are kept");
    require(p.view.lines.size() == q.view.lines.size() &&
                p.view.image_lines.size() == q.view.image_lines.size(),
            "lines are kept");
    require(p.view.corners.size() == q.view.corners.size(), "corners are kept");
    for (std::size_t k = 0; k < p.view.corners.size(); ++k) {
      const StereoCorner &c = p.view.corners[k], &d = q.view.corners[k];
      require(c.left_px == d.left_px && c.right_px == d.right_px &&
                  c.covariance_px2 == d.covariance_px2 && c.descriptor == d.descriptor,
              "corners are kept as they are");
    }
    for (std::size_t k = 0; k < p.view.lines.size(); ++k) {
      require(p.view.lines[k].a_m == q.view.lines[k].a_m &&
                  p.view.lines[k].b_m == q.view.lines[k].b_m &&
                  p.view.lines[k].kind == q.view.lines[k].kind,
              "lines are kept as they are");
    }
  }
}

void run_map_file(std::string_view bytes) {
  accepted([&] { return read_map(input_file(bytes, "a.map")); });
  const std::filesystem::path file = input_file(with_checksums(bytes), "b.map");
  const auto map = accepted([&] { return read_map(file); });
  if (!map) return;
  const std::filesystem::path written = input_folder() / "c.map";
  write_map(written, *map);
  require_same_nodes(*map, read_map(written));
  extend_map(file, map->nodes);
  require(read_map(file).nodes.size() == 2 * map->nodes.size(), "a map is extended");
}

std::vector<std::string> map_file_seeds() {
  std::vector<std::string> seeds;
  TopologicalMap map;
  const auto rig = std::make_shared<const Rig>(datasets::nominal().rig);
  for (int nodes = 0; nodes < 4; ++nodes) {
    const std::filesystem::path file = input_folder() / "seed.map";
    write_map(file, map);
    seeds.push_back(file_bytes(file));
    MapNode node{{0.5 * nodes, -1, 0.25}, {}};
    node.view.rig = rig;
    node.view.lines = {{{2, 0.5, 0.25}, {2, 0.5, 1.5}, LineKind::vertical, 0.02},
                       {{3, -1, 0.5}, {3, 1, 0.5}, LineKind::level, 0.05}};
    node.view.image_lines = {{{10, 20}, {10.5, 200}}};
    if (nodes > 0) {
      node.view.corners = {{{100, 50},
                            {90, 50.5},
                            0.1 * Eigen::Matrix4d::Identity(),
                            Eigen::VectorXf::LinSpaced(5, -1, 1)}};
    }
    map.nodes.push_back(node);
  }
  return seeds;
}

const Registered registered_map_file{{"map_file", 4000, "", run_map_file, map_file_seeds}};

}  // namespace
}  // namespace vernier::fuzz
