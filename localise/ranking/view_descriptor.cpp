// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/view_descriptor.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "localise/place.h"
#include "localise/place/view_camera.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

namespace {

/// A value between the centres of bins: the lower one and the share of the upper.
struct BinPair {
  int low;
  float upper_share;
};

BinPair bin_pair(double at, int bins) {
  const double x = std::clamp(at - 0.5, 0.0, bins - 1.001);
  const int low = static_cast<int>(x);
  return {low, static_cast<float>(x - low)};
}

/// [1 2 1] / 4 over bearings.
void smooth(std::vector<float>& descriptor, const DescriptorBins& bins) {
  constexpr int channels = DescriptorBins::channels;
  std::vector<float> before(channels, 0.0f);
  for (int b = 0; b < bins.bearings; ++b) {
    float* here = &descriptor[static_cast<std::size_t>(b) * channels];
    const float* next = b + 1 < bins.bearings ? here + channels : nullptr;
    for (int c = 0; c < channels; ++c) {
      const float old = here[c];
      here[c] = 0.25f * before[c] + 0.5f * old + (next ? 0.25f * next[c] : 0.0f);
      before[c] = old;
    }
  }
}

}  // namespace

DescriptorBins descriptor_bins(const TopologicalMap& map) {
  constexpr double beyond_rad = 0.15;  // lines between the eyes' fields of view, and blur
  constexpr double widest_rad = 1.5;
  double half = 0;
  for (const MapNode& node : map.nodes) {
    if (!node.view.rig) continue;
    const ViewCamera camera = view_camera(node.view);
    half =
        std::max<double>(half, std::atan(std::max(-camera.left_px, camera.right_px) / camera.f_px));
    break;  // one rig records a map
  }
  DescriptorBins bins;
  if (half > 0) {
    half = std::min(half + beyond_rad, widest_rad);
    bins.bearings = 2 * static_cast<int>(std::ceil(half / DescriptorBins::bearing_rad));
  }
  return bins;
}

std::vector<float> view_descriptor(std::span<const PlaceLine> lines, const DescriptorBins& bins) {
  using Bins = DescriptorBins;
  constexpr double upright_part_m = 0.25, other_part_m = 0.2;   // samples along a line
  constexpr double nearest_weighed_m = 0.3, most_size = 0.286;  // size: length over range
  const double ratio = std::log(Bins::furthest_m / Bins::nearest_m);
  std::vector<float> descriptor(static_cast<std::size_t>(bins.size()), 0.0f);
  for (const PlaceLine& line : lines) {
    const bool upright = line.kind == LineKind::vertical;
    const double length = line.length_m();
    const double range = (0.5 * (line.a_m + line.b_m)).head<2>().norm();
    if (!std::isfinite(length) || !std::isfinite(range)) continue;
    const int parts = std::clamp(
        static_cast<int>(length / (upright ? upright_part_m : other_part_m)), 1, upright ? 6 : 10);
    const auto weight = static_cast<float>(
        std::min(length / std::max(nearest_weighed_m, range), most_size) / parts);
    for (int i = 0; i < parts; ++i) {
      const Eigen::Vector3d p = line.a_m + (i + 0.5) / parts * (line.b_m - line.a_m);
      const double bearing =
          std::atan2(p.y(), p.x()) / Bins::bearing_rad + 0.5 * bins.bearings - 0.5;
      const int b = static_cast<int>(std::floor(bearing));
      if (b < -1 || b >= bins.bearings) continue;
      const auto upper = static_cast<float>(bearing - b);
      const double r = std::max(p.head<2>().norm(), 1e-3);
      const BinPair far =
          bin_pair(std::log(r / Bins::nearest_m) / ratio * Bins::ranges, Bins::ranges);
      const BinPair high =
          bin_pair(std::clamp(p.z() / Bins::highest_m, 0.0, 1.0) * Bins::heights, Bins::heights);
      for (int x = 0; x < 2; ++x) {
        if (b + x < 0 || b + x >= bins.bearings) continue;
        const float share = weight * (x ? upper : 1 - upper);
        for (int y = 0; y < 2; ++y) {
          for (int z = 0; z < 2; ++z) {
            const int channel =
                ((upright ? 0 : Bins::heights) + high.low + z) * Bins::ranges + far.low + y;
            descriptor[static_cast<std::size_t>((b + x) * Bins::channels + channel)] +=
                share * (y ? far.upper_share : 1 - far.upper_share) *
                (z ? high.upper_share : 1 - high.upper_share);
          }
        }
      }
    }
  }
  smooth(descriptor, bins);
  smooth(descriptor, bins);
  double sum = 0;
  for (const float x : descriptor) sum += x;
  if (!(sum > 0)) return descriptor;
  for (float& x : descriptor) x = std::sqrt(x / static_cast<float>(sum));
  return descriptor;
}

std::vector<std::uint16_t> shortened_descriptor(std::span<const float> descriptor) {
  std::vector<std::uint16_t> shortened;
  shortened.reserve(descriptor.size());
  for (const float x : descriptor) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    shortened.push_back(static_cast<std::uint16_t>((bits + 0x8000u) >> 16));  // rounded
  }
  return shortened;
}

}  // namespace vernier::localise::internal
