// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/panorama.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "localise/place.h"
#include "localise/place/view_camera.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

namespace {

using Bins = PanoramaBins;
constexpr double bearing_rad = 2 * std::numbers::pi / Bins::bearings;

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

/// Calls add(bearing in bins, channel, mass) for the parts of a line as seen from (x, y).
template <class Add>
void visit_parts(const PlaceLine& line, double x_m, double y_m, const Add& add) {
  constexpr double upright_part_m = 0.25, other_part_m = 0.2;
  constexpr double nearest_weighed_m = 0.3, most_size = 0.286;  // size: length over range
  const double ratio = std::log(Bins::furthest_m / Bins::nearest_m);
  const bool upright = line.kind == LineKind::vertical;
  const double length = line.length_m();
  const Eigen::Vector3d from(x_m, y_m, 0);
  const double range = (0.5 * (line.a_m + line.b_m) - from).head<2>().norm();
  constexpr double most_m = 1e6;
  if (!(length <= most_m) || !(range <= most_m)) return;
  const int parts = std::clamp(static_cast<int>(length / (upright ? upright_part_m : other_part_m)),
                               1, upright ? 6 : 10);
  const auto mass =
      static_cast<float>(std::min(length / std::max(nearest_weighed_m, range), most_size) / parts);
  for (int i = 0; i < parts; ++i) {
    const Eigen::Vector3d p = line.a_m + (i + 0.5) / parts * (line.b_m - line.a_m) - from;
    const double r = std::max(p.head<2>().norm(), 1e-3);
    const BinPair far =
        bin_pair(std::log(r / Bins::nearest_m) / ratio * Bins::ranges, Bins::ranges);
    const BinPair high =
        bin_pair(std::clamp(p.z() / Bins::highest_m, 0.0, 1.0) * Bins::heights, Bins::heights);
    const double bearing = std::atan2(p.y(), p.x()) / bearing_rad;
    for (int y = 0; y < 2; ++y) {
      for (int z = 0; z < 2; ++z) {
        add(bearing, ((upright ? 0 : Bins::heights) + high.low + z) * Bins::ranges + far.low + y,
            mass * (y ? far.upper_share : 1 - far.upper_share) *
                (z ? high.upper_share : 1 - high.upper_share));
      }
    }
  }
}

/// [1 2 1] / 4 over bearings; a circle is closed.
void smooth(std::vector<float>& bins, bool circle) {
  const int bearings = static_cast<int>(bins.size()) / Bins::channels;
  const std::vector<float> old = bins;
  for (int b = 0; b < bearings; ++b) {
    for (int c = 0; c < Bins::channels; ++c) {
      const auto at = [&](int bearing) {
        if (circle) bearing = (bearing + bearings) % bearings;
        return bearing < 0 || bearing >= bearings
                   ? 0.0f
                   : old[static_cast<std::size_t>(bearing) * Bins::channels + c];
      };
      bins[static_cast<std::size_t>(b) * Bins::channels + c] =
          0.25f * at(b - 1) + 0.5f * at(b) + 0.25f * at(b + 1);
    }
  }
}

/// How many of some views see each bearing of the circle.
std::vector<int> views_by_bearing(std::span<const MapNode* const> views, int in_view) {
  std::vector<int> count(Bins::bearings, 0);
  for (const MapNode* view : views) {
    for (int b = 0; b < Bins::bearings; ++b) {
      const double off =
          std::remainder((b + 0.5) * bearing_rad - view->pose.heading_rad, 2 * std::numbers::pi);
      if (std::abs(off) <= 0.5 * in_view * bearing_rad) ++count[b];
    }
  }
  return count;
}

Panorama panorama_at(std::span<const MapNode* const> views,
                     const std::vector<int>& views_there,
                     double x_m,
                     double y_m,
                     int in_view) {
  std::vector<float> circle(static_cast<std::size_t>(Bins::bearings) * Bins::channels, 0.0f);
  for (const MapNode* view : views) {
    const Pose2D step = relative({x_m, y_m, 0}, view->pose);
    for (const PlaceLine& line : view->view.lines) {
      const Eigen::Vector3d middle = 0.5 * (line.a_m + line.b_m);
      if (!middle.allFinite()) continue;
      const double seen = std::atan2(middle.y(), middle.x()) + view->pose.heading_rad;
      const int there = static_cast<int>(std::floor(seen / bearing_rad));
      const int of = views_there[((there % Bins::bearings) + Bins::bearings) % Bins::bearings];
      const float share = 1.0f / static_cast<float>(std::max(1, of));
      visit_parts(line, step.x_m, step.y_m, [&](double bearing, int channel, float mass) {
        const double at = bearing + view->pose.heading_rad / bearing_rad - 0.5;
        const double low = std::floor(at);
        const auto upper = static_cast<float>(at - low);
        for (int k = 0; k < 2; ++k) {
          const int b = static_cast<int>(
              std::fmod(std::fmod(low + k, Bins::bearings) + Bins::bearings, Bins::bearings));
          circle[static_cast<std::size_t>(b) * Bins::channels + channel] +=
              share * mass * (k ? upper : 1 - upper);
        }
      });
    }
  }
  smooth(circle, true);
  constexpr float most_steps = 255;
  const float largest = *std::max_element(circle.begin(), circle.end());
  const float steps = most_steps / std::sqrt(std::max(largest, 1e-12f));
  Panorama result;
  result.at = {x_m, y_m, 0};
  constexpr double known_share = 0.5;  // of a window
  for (int begin = 0; begin < Bins::bearings; ++begin) {
    int known = 0;
    double mass = 0;
    for (int k = 0; k < in_view; ++k) {
      const int b = (begin + k) % Bins::bearings;
      known += views_there[b] > 0;
      for (int c = 0; c < Bins::channels; ++c) {
        mass += circle[static_cast<std::size_t>(b) * Bins::channels + c];
      }
    }
    if (known < known_share * in_view || !(mass > 1e-6)) continue;
    result.windows.push_back(
        {0, static_cast<std::uint16_t>(begin), static_cast<float>(1 / (steps * std::sqrt(mass)))});
  }
  // Bearings that no window needs are not kept: runs of windows lie one after the other.
  int kept = 0;
  for (std::size_t i = 0; i < result.windows.size(); ++i) {
    Panorama::Window& window = result.windows[i];
    const bool follows = i > 0 && result.windows[i - 1].bearing + 1 == window.bearing;
    const int first_new = follows ? in_view - 1 : 0;
    window.begin = static_cast<std::uint16_t>(follows ? result.windows[i - 1].begin + 1 : kept);
    for (int k = first_new; k < in_view; ++k, ++kept) {
      const int b = (window.bearing + k) % Bins::bearings;
      for (int c = 0; c < Bins::channels; ++c) {
        const float root = std::sqrt(circle[static_cast<std::size_t>(b) * Bins::channels + c]);
        result.bins.push_back(static_cast<std::uint8_t>(root * steps + 0.5f));
      }
    }
  }
  result.bins.shrink_to_fit();  // maps have many
  result.windows.shrink_to_fit();
  return result;
}

}  // namespace

int bearings_in_view(const TopologicalMap& map) {
  constexpr double usual_tan = 320.0 / 525, beyond_rad = 0.1, widest_rad = 1.5;
  double half = std::atan(usual_tan);
  for (const MapNode& node : map.nodes) {
    if (!node.view.rig) continue;
    const ViewCamera camera = view_camera(node.view);
    const double seen = std::atan(std::max(-camera.left_px, camera.right_px) / camera.f_px);
    if (seen > 0) half = seen;  // a wrong calibration may look nowhere
    break;                      // one rig records a map
  }
  return static_cast<int>(std::ceil(2 * std::min(half + beyond_rad, widest_rad) / bearing_rad));
}

std::vector<float> view_descriptor(std::span<const PlaceLine> lines, int bearings) {
  std::vector<float> bins(static_cast<std::size_t>(bearings) * Bins::channels, 0.0f);
  for (const PlaceLine& line : lines) {
    visit_parts(line, 0, 0, [&](double bearing, int channel, float mass) {
      const double at = bearing + 0.5 * bearings - 0.5;
      const double low = std::floor(at);
      const auto upper = static_cast<float>(at - low);
      for (int k = 0; k < 2; ++k) {
        const int b = static_cast<int>(low) + k;
        if (b < 0 || b >= bearings) continue;
        bins[static_cast<std::size_t>(b) * Bins::channels + channel] +=
            mass * (k ? upper : 1 - upper);
      }
    });
  }
  smooth(bins, false);
  double sum = 0;
  for (const float x : bins) sum += x;
  if (!(sum > 0)) return bins;
  for (float& x : bins) x = std::sqrt(x / static_cast<float>(sum));
  return bins;
}

std::vector<Panorama> panoramas(std::span<const MapNode* const> views, int in_view) {
  if (views.empty()) return {};
  constexpr double beside_m = 0.4;
  const std::vector<int> there = views_by_bearing(views, in_view);
  const Pose2D& at = views[0]->pose;
  std::vector<Panorama> all;
  for (const auto& [dx, dy] : {std::pair(0, 0), {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    all.push_back(
        panorama_at(views, there, at.x_m + dx * beside_m, at.y_m + dy * beside_m, in_view));
  }
  return all;
}

PanoramaMatch best_match(std::span<const float> view,
                         const Panorama& panorama,
                         int bearing,
                         int reach) {
  const int in_view = static_cast<int>(view.size()) / Bins::channels;
  const std::vector<Panorama::Window>& windows = panorama.windows;
  const auto is_near = [&](const Panorama::Window& window) {
    const int apart = std::abs(window.bearing - bearing);
    return std::min(apart, Bins::bearings - apart) <= reach;
  };
  PanoramaMatch best;
  for (std::size_t i = 0; i < windows.size();) {
    std::size_t end = i;
    while (end < windows.size() && is_near(windows[end])) ++end;
    if (end == i) {
      ++i;
      continue;
    }
    std::array<float, Bins::bearings> products;
    window_products(view, panorama, i, std::span(products).first(end - i));
    for (std::size_t k = i; k < end; ++k) {
      const float likeness = products[k - i] * windows[k].per_norm;
      if (!(likeness > best.likeness)) continue;
      best.likeness = likeness;
      best.heading_rad = static_cast<float>((windows[k].bearing + 0.5 * in_view) * bearing_rad);
    }
    i = end;
  }
  return best;
}

}  // namespace vernier::localise::internal
