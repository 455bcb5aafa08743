// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sources/source_losses.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim::internal {

namespace {

constexpr double displaced_at_px = 2, shortest_m = 1e-6;

/// A part of an edge, by the shares of its length at which it begins and ends.
using Part = std::pair<double, double>;

/// The parts of each feature that stereo gets.
std::map<std::uint32_t, std::vector<Part>> parts_of(
    const SensedView& view, const std::map<std::uint32_t, VisibleEdge>& whole) {
  std::map<std::uint32_t, std::vector<Part>> parts;
  for (const SensedEdge& edge : view.edges) {
    const auto of = whole.find(edge.truth.feature);
    if (!edge.in_stereo || of == whole.end()) continue;
    const Eigen::Vector3d d = of->second.b_m - of->second.a_m;
    const auto share = [&](const Eigen::Vector3d& p) {
      return (p - of->second.a_m).dot(d) / d.squaredNorm();
    };
    const double a = share(edge.truth.a_m), b = share(edge.truth.b_m);
    parts[edge.truth.feature].emplace_back(std::min(a, b), std::max(a, b));
  }
  for (auto& [feature, list] : parts) std::sort(list.begin(), list.end());
  return parts;
}

/// What one list of parts has and the other, sorted, has not.
std::vector<Part> gone_parts(const std::vector<Part>& before, const std::vector<Part>& after) {
  std::vector<Part> gone;
  for (const Part& part : before) {
    double from = part.first;
    for (const Part& left : after) {
      if (left.second <= from || left.first >= part.second) continue;
      if (left.first > from) gone.emplace_back(from, left.first);
      from = std::max(from, left.second);
    }
    if (part.second > from) gone.emplace_back(from, part.second);
  }
  return gone;
}

SpaceEdge part_of(const VisibleEdge& edge, const Part& part) {
  const Eigen::Vector3d d = edge.b_m - edge.a_m;
  return {edge.a_m + part.first * d, edge.a_m + part.second * d};
}

bool is_displaced(const SensedEdge& before, const SensedEdge& after) {
  for (std::size_t eye = 0; eye < 2; ++eye) {
    for (std::size_t end = 0; end < 2; ++end) {
      const double moved = (after.offset_px[eye][end] - before.offset_px[eye][end]).norm();
      if (moved >= displaced_at_px) return true;
    }
  }
  return false;
}

}  // namespace

SensedEdges source_losses(const Sensor& sensor,
                          const NoiseFreeView& view,
                          const SensingDraw& draw) {
  using Identity = std::pair<std::uint32_t, std::uint32_t>;  // feature and piece
  std::map<std::uint32_t, VisibleEdge> whole;
  std::map<std::uint32_t, std::vector<Part>> parts_before;
  std::map<Identity, SensedEdge> edges_before;
  for (const VisibleEdge& edge : view.edges) {
    whole.emplace(edge.feature, edge);
    parts_before[edge.feature] = {{0, 1}};
    edges_before[{edge.feature, 0}].truth = edge;
  }
  SensedEdges result;
  const auto compare = [&](const UncertaintySource& source, const SensedView& sensed) {
    SourceLosses& losses = result.sources.emplace_back();
    losses.source = source.name();
    auto parts = parts_of(sensed, whole);
    for (const auto& [feature, before] : parts_before) {
      for (const Part& gone : gone_parts(before, parts[feature])) {
        const SpaceEdge edge = part_of(whole.at(feature), gone);
        if ((edge.second - edge.first).norm() > shortest_m) losses.lost.push_back(edge);
      }
    }
    std::map<Identity, SensedEdge> edges;
    for (const SensedEdge& edge : sensed.edges) {
      const Identity identity(edge.truth.feature, edge.piece);
      const auto was = edges_before.find(identity);
      if (was == edges_before.end() && whole.count(edge.truth.feature) == 0) {
        losses.added.emplace_back(edge.truth.a_m, edge.truth.b_m);
      }
      if (was != edges_before.end() && edge.in_stereo && is_displaced(was->second, edge)) {
        losses.displaced.emplace_back(edge.truth.a_m, edge.truth.b_m);
      }
      edges.emplace(identity, edge);
    }
    parts_before = std::move(parts);
    edges_before = std::move(edges);
  };
  const StereoObservation observation = sensor.sense(view, draw, compare);
  if (!observation.failure.empty()) {
    throw Error("source " + result.sources.back().source, observation.failure, "mend it");
  }
  for (const VisibleEdge& edge : observation.true_edges) {
    result.told.emplace_back(edge.a_m, edge.b_m);
  }
  return result;
}

}  // namespace vernier::sim::internal
