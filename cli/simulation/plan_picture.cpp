// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/plan_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "sim/world.h"

namespace vernier::cli {
namespace {

constexpr double width_px = 1000, margin_px = 20, foot_px = 40, highest_m = 2;

/// A length that a scale bar shows: 1, 2 or 5 times a power of ten.
double round_length(double length) {
  const double power = std::pow(10, std::floor(std::log10(length)));
  const double share = length / power;
  return power * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}

/// From the floor to the picture.
struct PlanScale {
  explicit PlanScale(const World& world) {
    const WorldExtent box = extent(world);
    low = box.low_m.head<2>();
    size = (box.high_m - box.low_m).head<2>();
    scale = (width_px - 2 * margin_px) / std::max({size.x(), size.y(), 0.1});
    width = size.x() * scale + 2 * margin_px;
    height = size.y() * scale + 2 * margin_px + foot_px;
  }
  double u(double x_m) const { return margin_px + (x_m - low.x()) * scale; }
  double v(double y_m) const { return height - foot_px - margin_px - (y_m - low.y()) * scale; }

  Eigen::Vector2d low, size;  ///< metres
  double scale, width, height;
};

std::string drawn_world(const World& world, const PlanScale& to) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"14\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "fill=\"#fff\"/>\n<g stroke=\"#667\" stroke-width=\"0.8\" stroke-linecap=\"round\">\n",
      to.width, to.height);
  const auto out = std::back_inserter(svg);
  for (const WorldSegment& s : world.segments) {
    if (std::min(s.a_m.z(), s.b_m.z()) > highest_m) continue;
    const double du = to.u(s.b_m.x()) - to.u(s.a_m.x()), dv = to.v(s.b_m.y()) - to.v(s.a_m.y());
    if (std::hypot(du, dv) < 0.5) {
      fmt::format_to(
          out, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.1\" fill=\"#667\" stroke=\"none\"/>\n",
          to.u(s.a_m.x()), to.v(s.a_m.y()));
    } else {
      fmt::format_to(out, "<path d=\"M{:.1f} {:.1f}l{:.1f} {:.1f}\"/>\n", to.u(s.a_m.x()),
                     to.v(s.a_m.y()), du, dv);
    }
  }
  return svg + "</g>\n";
}

std::string drawn_route(const World& world, const PlanScale& to) {
  std::string svg =
      "<defs><marker id=\"end\" markerWidth=\"8\" markerHeight=\"8\" refX=\"6\" refY=\"3\" "
      "orient=\"auto\"><path d=\"M0 0L7 3L0 6z\" fill=\"#c22\"/></marker></defs>\n"
      "<g fill=\"none\" stroke=\"#c22\" stroke-width=\"1.8\" marker-end=\"url(#end)\">\n";
  for (const RouteLeg& leg : world.route) {
    svg += "<path marker-end=\"url(#end)\" d=\"";
    for (std::size_t i = 0; i < leg.points_m.size(); ++i) {
      fmt::format_to(std::back_inserter(svg), "{}{:.1f} {:.1f}", i == 0 ? 'M' : 'L',
                     to.u(leg.points_m[i].x()), to.v(leg.points_m[i].y()));
    }
    svg += "\"/>\n";
  }
  return svg + "</g>\n";
}

std::string drawn_way(const PlanWay& way, const PlanScale& to) {
  if (way.poses.empty()) return "";
  std::string svg = fmt::format(
      "<g fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"><circle cx=\"{:.1f}\" cy=\"{:.1f}\" "
      "r=\"4\"/><path d=\"",
      way.colour, to.u(way.poses[0].x_m), to.v(way.poses[0].y_m));
  for (std::size_t i = 0; i < way.poses.size(); ++i) {
    fmt::format_to(std::back_inserter(svg), "{}{:.2f} {:.2f}", i == 0 ? 'M' : 'L',
                   to.u(way.poses[i].x_m), to.v(way.poses[i].y_m));
  }
  return svg + "\"/></g>\n";
}

/// A scale bar on the left, and on the right words with their colours, the last outermost.
std::string drawn_foot(const std::vector<std::pair<std::string, std::string>>& words,
                       const PlanScale& to) {
  const double bar_m = round_length(0.2 * std::max(to.size.x(), 0.1)), bottom = to.height - 12;
  std::string svg = fmt::format(
      "<path d=\"M{0:.1f} {1:.1f}v5h{2:.1f}v-5\" fill=\"none\" stroke=\"#222\"/>\n"
      "<text x=\"{3:.1f}\" y=\"{4:.1f}\" fill=\"#222\">{5:g} m</text>\n<text x=\"{6:.1f}\" "
      "y=\"{4:.1f}\" text-anchor=\"end\">",
      margin_px, bottom - 6, bar_m * to.scale, margin_px + bar_m * to.scale + 8, bottom, bar_m,
      to.width - margin_px);
  for (const auto& [word, colour] : words) {
    svg += fmt::format("<tspan fill=\"{}\">{}{}</tspan>", colour,
                       &word == &words[0].first ? "" : "  ", word);
  }
  return svg + "</text>\n</svg>\n";
}

}  // namespace

std::string plan_svg(const World& world, const std::vector<PlanWay>& ways) {
  const PlanScale to(world);
  std::string svg = drawn_world(world, to);
  std::vector<std::pair<std::string, std::string>> words;
  for (const PlanWay& way : ways) {
    svg += drawn_way(way, to);
    words.emplace_back(way.name, way.colour);
  }
  if (ways.empty()) {
    svg += drawn_route(world, to);
    words.emplace_back(fmt::format("route of {:.0f} m", route_length_m(world.route)), "#c22");
  }
  return svg + drawn_foot(words, to);
}

}  // namespace vernier::cli
