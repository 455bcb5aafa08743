// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/map/corner_part.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <utility>

#include "calib/base/all_within.h"
#include "localise/map/native_bytes.h"
#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

namespace {

constexpr std::size_t most_corners = 10'000, longest_descriptor = 1024;
constexpr double largest_px = 1e7;
constexpr std::size_t counts_bytes = 8, fixed_bytes = 14 * sizeof(double);

bool is_corner(const StereoCorner& corner) {
  const auto within = [](const auto& x) { return vernier::internal::all_within(x, largest_px); };
  return within(corner.left_px) && within(corner.right_px) && within(corner.covariance_px2) &&
         corner.covariance_px2 == corner.covariance_px2.transpose() &&
         corner.covariance_px2.llt().info() == Eigen::Success && corner.descriptor.allFinite();
}

/// A corner from at least corner_size(descriptor) bytes.
StereoCorner take_corner(std::string_view& bytes, std::size_t descriptor) {
  StereoCorner corner;
  for (Eigen::Vector2d* pixel : {&corner.left_px, &corner.right_px}) {
    for (int i = 0; i < 2; ++i) (*pixel)[i] = take<double>(bytes);
  }
  for (int i = 0; i < 4; ++i) {
    for (int k = i; k < 4; ++k) {
      corner.covariance_px2(i, k) = corner.covariance_px2(k, i) = take<double>(bytes);
    }
  }
  corner.descriptor.resize(static_cast<Eigen::Index>(descriptor));
  if (descriptor > 0) {  // an empty vector has no memory to copy to
    std::memcpy(corner.descriptor.data(), bytes.data(), descriptor * sizeof(float));
  }
  bytes.remove_prefix(corner_size(descriptor) - fixed_bytes);
  return corner;
}

}  // namespace

std::size_t corner_size(std::size_t descriptor) {
  return fixed_bytes + (descriptor * sizeof(float) + 7) / 8 * 8;
}

bool have_corners(std::span<const MapNode> nodes) {
  return std::any_of(nodes.begin(), nodes.end(),
                     [](const MapNode& node) { return !node.view.corners.empty(); });
}

bool writable(std::span<const StereoCorner> corners) {
  if (corners.size() > most_corners) return false;
  return std::all_of(corners.begin(), corners.end(), [&](const StereoCorner& corner) {
    return corner.descriptor.size() == corners[0].descriptor.size() &&
           corner.descriptor.size() <= static_cast<Eigen::Index>(longest_descriptor) &&
           is_corner(corner);
  });
}

std::string corner_bytes(std::span<const MapNode> nodes) {
  std::string bytes;
  for (const MapNode& node : nodes) {
    const std::vector<StereoCorner>& corners = node.view.corners;
    const Eigen::Index descriptor = corners.empty() ? 0 : corners[0].descriptor.size();
    put(bytes, static_cast<std::uint32_t>(corners.size()));
    put(bytes, static_cast<std::uint32_t>(descriptor));
    for (const StereoCorner& corner : corners) {
      const std::size_t end = bytes.size() + corner_size(static_cast<std::size_t>(descriptor));
      for (const Eigen::Vector2d& pixel : {corner.left_px, corner.right_px}) {
        for (int i = 0; i < 2; ++i) put(bytes, pixel[i]);
      }
      for (int i = 0; i < 4; ++i) {
        for (int k = i; k < 4; ++k) put(bytes, corner.covariance_px2(i, k));
      }
      for (Eigen::Index i = 0; i < descriptor; ++i) put(bytes, corner.descriptor[i]);
      bytes.resize(end);
    }
  }
  return bytes;
}

void read_corners(std::string_view bytes,
                  std::span<MapNode> nodes,
                  const std::function<void(const std::string&)>& fail) {
  for (MapNode& node : nodes) {
    if (bytes.size() < counts_bytes) return fail("a part is shorter than what it should hold");
    const std::size_t count = take<std::uint32_t>(bytes), descriptor = take<std::uint32_t>(bytes);
    if (count > most_corners || descriptor > longest_descriptor ||
        count * corner_size(descriptor) > bytes.size()) {
      return fail("a node has more corners than it can hold");
    }
    node.view.corners.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      node.view.corners.push_back(take_corner(bytes, descriptor));
      if (!is_corner(node.view.corners.back())) return fail("a corner is none");
    }
  }
  if (!bytes.empty()) fail("a part is longer than what it should hold");
}

}  // namespace vernier::localise::internal
