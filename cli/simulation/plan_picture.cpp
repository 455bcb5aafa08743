// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/plan_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>

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

}  // namespace

std::string plan_svg(const World& world) {
  const WorldExtent box = extent(world);
  const Eigen::Vector2d low = box.low_m.head<2>(), size = (box.high_m - box.low_m).head<2>();
  const double scale = (width_px - 2 * margin_px) / std::max({size.x(), size.y(), 0.1});
  const double width = size.x() * scale + 2 * margin_px;
  const double height = size.y() * scale + 2 * margin_px + foot_px;
  const auto u = [&](double x_m) { return margin_px + (x_m - low.x()) * scale; };
  const auto v = [&](double y_m) { return height - foot_px - margin_px - (y_m - low.y()) * scale; };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"14\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "fill=\"#fff\"/>\n<g stroke=\"#667\" stroke-width=\"0.8\" stroke-linecap=\"round\">\n",
      width, height);
  const auto out = std::back_inserter(svg);
  for (const WorldSegment& s : world.segments) {
    if (std::min(s.a_m.z(), s.b_m.z()) > highest_m) continue;
    const double du = u(s.b_m.x()) - u(s.a_m.x()), dv = v(s.b_m.y()) - v(s.a_m.y());
    if (std::hypot(du, dv) < 0.5) {
      fmt::format_to(
          out, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.1\" fill=\"#667\" stroke=\"none\"/>\n",
          u(s.a_m.x()), v(s.a_m.y()));
    } else {
      fmt::format_to(out, "<path d=\"M{:.1f} {:.1f}l{:.1f} {:.1f}\"/>\n", u(s.a_m.x()),
                     v(s.a_m.y()), du, dv);
    }
  }
  svg +=
      "</g>\n<defs><marker id=\"end\" markerWidth=\"8\" markerHeight=\"8\" refX=\"6\" refY=\"3\" "
      "orient=\"auto\"><path d=\"M0 0L7 3L0 6z\" fill=\"#c22\"/></marker></defs>\n"
      "<g fill=\"none\" stroke=\"#c22\" stroke-width=\"1.8\" marker-end=\"url(#end)\">\n";
  for (const RouteLeg& leg : world.route) {
    svg += "<path marker-end=\"url(#end)\" d=\"";
    for (std::size_t i = 0; i < leg.points_m.size(); ++i) {
      fmt::format_to(out, "{}{:.1f} {:.1f}", i == 0 ? 'M' : 'L', u(leg.points_m[i].x()),
                     v(leg.points_m[i].y()));
    }
    svg += "\"/>\n";
  }
  const double bar_m = round_length(0.2 * std::max(size.x(), 0.1));
  const double bottom = height - 12;
  svg += fmt::format(
      "</g>\n<path d=\"M{0:.1f} {1:.1f}v5h{2:.1f}v-5\" fill=\"none\" stroke=\"#222\"/>\n"
      "<text x=\"{3:.1f}\" y=\"{4:.1f}\" fill=\"#222\">{5:g} m</text>\n"
      "<text x=\"{6:.1f}\" y=\"{4:.1f}\" fill=\"#c22\" text-anchor=\"end\">route of {7:.0f} "
      "m</text>\n</svg>\n",
      margin_px, bottom - 6, bar_m * scale, margin_px + bar_m * scale + 8, bottom, bar_m,
      width - margin_px, route_length_m(world.route));
  return svg;
}

}  // namespace vernier::cli
