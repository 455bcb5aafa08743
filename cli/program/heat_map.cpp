// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/heat_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "calib/error.h"

namespace vernier::cli {
namespace {

constexpr double left = 62, top = 46, width = 560, bar = 18, gap = 24;
constexpr int shades = 128;

/// Five anchor colours of viridis: dark blue, green, yellow, with uniform lightness steps.
std::string colour(double share) {
  static constexpr std::array<std::array<double, 3>, 5> anchors{
      {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};
  const double at = std::clamp(share, 0.0, 1.0) * (anchors.size() - 1);
  const auto below = std::min<std::size_t>(static_cast<std::size_t>(at), anchors.size() - 2);
  const double part = at - static_cast<double>(below);
  std::array<int, 3> rgb{};
  for (std::size_t i = 0; i < 3; ++i) {
    rgb[i] = static_cast<int>(
        std::lround(anchors[below][i] + part * (anchors[below + 1][i] - anchors[below][i])));
  }
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

std::string text(double x, double y, const std::string& anchor, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     words);
}

std::string escaped(const std::string& words) {
  std::string out;
  for (const char c : words) {
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return out;
}

/// Tick step: 1, 2 or 5 times a power of ten, about a fifth of the extent; 1 if the extent is 0.
double nice_step(double extent) {
  if (!(extent > 0)) return 1;
  const double rough = extent / 5, power = std::pow(10, std::floor(std::log10(rough)));
  const double digit = rough / power;
  return power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
}

/// Maps values to [0, 1] on the colour scale; logarithmic if a few large values would otherwise use
/// up the scale.
struct Scale {
  double least, greatest;

  bool logarithmic() const { return least > 0 && greatest > 4 * least; }
  double value_at(double share) const {
    return logarithmic() ? least * std::pow(greatest / least, share)
                         : least + share * (greatest - least);
  }
  int shade(double value) const {
    if (!(greatest > least)) return 0;
    const double share = logarithmic() ? std::log(value / least) / std::log(greatest / least)
                                       : (value - least) / (greatest - least);
    return static_cast<int>(std::lround((shades - 1) * share));
  }
};

Scale scale_of(const std::vector<double>& values) {
  Scale scale{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    scale = {std::min(scale.least, v), std::max(scale.greatest, v)};
  }
  return scale;
}

/// Draws the cells of one row; merges neighbours of the same shade.
std::string row_of_cells(const HeatMap& map, std::size_t row, double height, const Scale& scale) {
  const std::size_t columns = map.x_px.size();
  const double w = width / columns, h = height / map.y_px.size();
  const auto shade = [&](std::size_t c) {
    const double v = map.values[row * columns + c];
    return std::isfinite(v) ? scale.shade(v) : -1;
  };
  std::string svg;
  for (std::size_t c = 0, end = 0; c < columns; c = end) {
    for (end = c + 1; end < columns && shade(end) == shade(c);) ++end;
    svg += fmt::format(
        "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"/>\n",
        left + w * c, top + h * row, w * (end - c), h,
        shade(c) < 0 ? "#d0d0d0" : colour(shade(c) / double(shades - 1)));
  }
  return svg;
}

std::string axes(const HeatMap& map, double height) {
  std::string svg;
  // A cell is centred on its pixel, so the outer pixels are half a cell inside the frame.
  const auto place = [](const std::vector<double>& at, double value, double start, double length) {
    const double cell = length / at.size();
    const double extent = at.back() - at.front();
    const double share = extent > 0 ? (value - at.front()) / extent : 0.5;
    return start + cell / 2 + (length - cell) * share;
  };
  const double x_step = nice_step(map.x_px.back() - map.x_px.front());
  for (double x = 0; x <= map.x_px.back(); x += x_step) {
    const double at = place(map.x_px, x, left, width);
    svg += fmt::format("<path d=\"M{0:.1f} {1:.1f}v5\"/>\n", at, top + height);
    svg += text(at, top + height + 18, "middle", fmt::format("{:g}", x));
  }
  const double y_step = nice_step(map.y_px.back() - map.y_px.front());
  for (double y = 0; y <= map.y_px.back(); y += y_step) {
    const double at = place(map.y_px, y, top, height);
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}h-5\"/>\n", left, at);
    svg += text(left - 8, at + 4, "end", fmt::format("{:g}", y));
  }
  svg += fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{:.1f}\" fill=\"none\" stroke=\"#333\"/>\n",
      left, top, width, height);
  svg += text(left + width / 2, top + height + 36, "middle", "u, px");
  svg += fmt::format(
      "<text transform=\"translate(18 {:.1f}) rotate(-90)\" text-anchor=\"middle\">v, px</text>\n",
      top + height / 2);
  return svg;
}

std::string colour_bar(const HeatMap& map, double height, const Scale& scale) {
  std::string svg;
  const double x = left + width + gap, h = height / shades;
  for (int i = 0; i < shades; ++i) {
    svg += fmt::format("<rect x=\"{}\" y=\"{:.2f}\" width=\"{}\" height=\"{:.2f}\" fill=\"{}\"/>\n",
                       x, top + height - h * (i + 1), bar, h + 0.3, colour(i / double(shades - 1)));
  }
  for (int i = 0; i <= 4; ++i) {
    const double value = scale.value_at(i / 4.0);
    const double y = top + height * (1 - i / 4.0);
    svg += fmt::format("<path d=\"M{} {:.1f}h5\"/>\n", x + bar, y);
    svg += text(x + bar + 8, y + 4, "start", fmt::format("{:.3g}", value));
  }
  return svg + text(x + bar / 2, top - 10, "middle", escaped(map.unit));
}

}  // namespace

std::string heat_map_svg(const HeatMap& map) {
  const std::size_t columns = map.x_px.size(), rows = map.y_px.size();
  if (columns < 2 || rows < 2 || map.values.size() != columns * rows) {
    throw Error("heat map",
                "the number of values is not columns x rows, or the grid is smaller than 2x2",
                "give one value per cell");
  }
  const double height =
      width * (map.y_px.back() - map.y_px.front() + 1) / (map.x_px.back() - map.x_px.front() + 1);
  const double total_width = left + width + gap + bar + 66, total_height = top + height + 50;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<style>path{{stroke:#333;fill:none}}text{{fill:#222}}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n<g shape-rendering=\"crispEdges\">\n",
      total_width, total_height);
  const Scale scale = scale_of(map.values);
  for (std::size_t row = 0; row < rows; ++row) svg += row_of_cells(map, row, height, scale);
  svg += "</g>\n";
  svg +=
      fmt::format("<text x=\"{}\" y=\"22\" font-size=\"15\">{}</text>\n", left, escaped(map.title));
  svg += axes(map, height);
  if (std::isfinite(scale.least)) svg += colour_bar(map, height, scale);
  const bool missing =
      std::any_of(map.values.begin(), map.values.end(), [](double v) { return !std::isfinite(v); });
  if (missing) svg += text(left + width, top + height + 36, "end", "grey: no ray or not visible");
  return svg + "</svg>\n";
}

}  // namespace vernier::cli
