// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/report/figure_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <string_view>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/program_run.h"
#include "calib/error.h"
#include "cli/program/namespaces.h"
#include "cli/program/text_table.h"

namespace vernier::cli {
namespace {

constexpr std::array<const char*, 6> colours{"#0072b2", "#d55e00", "#009e73",
                                             "#cc79a7", "#e69f00", "#56b4e9"};
constexpr double text_pt = 8, row_pt = 13;

std::string svg_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  const std::string index = "ψ_c";
  for (std::size_t at = out.find(index); at != std::string::npos; at = out.find(index, at)) {
    const std::string lowered =
        "ψ<tspan dy=\"1.8\" font-size=\"6\">c</tspan><tspan dy=\"-1.8\"> </tspan>";
    out.replace(at, index.size(), lowered);
    at += lowered.size();
  }
  return out;
}

std::string svg_label(
    double x, double y, const char* anchor, const std::string& text, const std::string& more = "") {
  return fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y,
                     anchor, more, svg_text(text));
}

std::string stroke(double x1, double y1, double x2, double y2, const std::string& style) {
  return fmt::format("<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\" {}/>\n", x1, y1, x2, y2, style);
}

/// A straight or logarithmic axis from `low` at `from` to `high` at `to`.
class FigureScale {
 public:
  FigureScale(double low, double high, bool log, double from, double to)
      : low_(at(low, log)), high_(at(high, log)), log_(log), from_(from), to_(to) {
    if (!(high_ > low_)) {
      low_ -= 0.5;
      high_ += 0.5;
    }
  }
  double operator()(double value) const {
    return from_ + (at(value, log_) - low_) / (high_ - low_) * (to_ - from_);
  }

  /// Round values within the axis, at most about `most`.
  std::vector<double> ticks(int most) const { return log_ ? log_ticks(most) : plain_ticks(most); }

 private:
  static double at(double value, bool log) { return log ? std::log10(value) : value; }

  std::vector<double> plain_ticks(int most) const {
    const double rough = (high_ - low_) / most;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    double step = 10 * power;
    for (const double nice : {5.0, 2.0, 1.0}) {
      if (nice * power >= rough) step = nice * power;
    }
    std::vector<double> all;
    for (double k = std::ceil(low_ / step - 1e-9); k * step <= high_ + 1e-9 * step; ++k) {
      all.push_back(k == 0 ? 0.0 : k * step);
    }
    return all;
  }

  std::vector<double> log_ticks(int most) const {
    std::vector<double> all;
    const double decades = high_ - low_;
    for (double power = std::floor(low_); power <= high_; ++power) {
      for (const double nice : {1.0, 2.0, 5.0}) {
        if (nice != 1 && 3 * decades > most) continue;
        const double tick = nice * std::pow(10.0, power);
        if (at(tick, true) >= low_ - 1e-9 && at(tick, true) <= high_ + 1e-9) all.push_back(tick);
      }
    }
    return all;
  }

  double low_, high_;
  bool log_;
  double from_, to_;
};

std::string figure_mark(double x, double y, std::size_t kind) {
  const char* colour = colours[kind % colours.size()];
  constexpr double r = 2.2;
  switch (kind % 3) {
    case 0:
      return fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{}\" fill=\"{}\"/>\n", x, y, r,
                         colour);
    case 1:
      return fmt::format(
          "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>\n", x - r,
          y - r, 2 * r, 2 * r, colour);
    default:
      return fmt::format("<path d=\"M{:.2f} {:.2f}l{} {}h{}z\" fill=\"{}\"/>\n", x, y - 1.3 * r,
                         1.2 * r, 2.1 * r, -2.4 * r, colour);
  }
}

/// Where a panel is, in points.
struct Frame {
  double left = 0, right = 0, top = 0, bottom = 0;
};

/// Lowest and highest x of all panels.
std::pair<double, double> x_range(const PaperFigure& figure) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const FigurePanel& panel : figure.panels) {
    for (const FigureLine& line : panel.lines) {
      for (const FigurePoint& p : line.points) {
        low = std::min(low, p.x);
        high = std::max(high, p.x);
      }
    }
  }
  if (figure.log_x) return {low / std::pow(high / low, 0.05), high * std::pow(high / low, 0.05)};
  return {low - 0.05 * (high - low), high + 0.05 * (high - low)};
}

std::string frame_lines(const Frame& f) {
  const std::string ink = "stroke=\"#333\" stroke-width=\"0.6\" fill=\"none\"";
  return stroke(f.left, f.top, f.left, f.bottom, ink) +
         stroke(f.left, f.bottom, f.right, f.bottom, ink);
}

constexpr const char* grid_style = "stroke=\"#ddd\" stroke-width=\"0.4\"";

/// The line through points that exist, their intervals and marks.
std::string curve(const FigureLine& line,
                  std::size_t kind,
                  const FigureScale& x,
                  const FigureScale& y) {
  std::string path, marks;
  const std::string colour = line.is_behind ? "#c4c9ce" : colours[kind % colours.size()];
  for (const FigurePoint& p : line.points) {
    if (std::isnan(p.y)) continue;
    path += fmt::format("{}{:.2f} {:.2f}", path.empty() ? "M" : "L", x(p.x), y(p.y));
    if (line.is_behind) continue;
    if (!std::isnan(p.low)) {
      marks += stroke(x(p.x), y(p.low), x(p.x), y(p.high),
                      fmt::format("stroke=\"{}\" stroke-width=\"0.8\"", colour));
    }
    marks += figure_mark(x(p.x), y(p.y), kind);
  }
  if (path.empty()) return {};
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1\"/>\n", path,
                     colour) +
         marks;
}

std::string against_axis(const PaperFigure& figure,
                         const FigurePanel& panel,
                         std::size_t number,
                         const Frame& f,
                         bool is_left,
                         bool is_below) {
  const auto [low, high] = x_range(figure);
  const FigureScale x(low, high, figure.log_x, f.left, f.right);
  const FigureScale y(figure.y_low, figure.y_high, figure.log_y, f.bottom, f.top);
  std::string svg;
  for (const double tick : y.ticks(5)) {
    svg += stroke(f.left, y(tick), f.right, y(tick), grid_style);
    if (is_left) svg += svg_label(f.left - 4, y(tick) + 2.8, "end", fmt::format("{:g}", tick));
  }
  svg += frame_lines(f);
  for (const double tick : x.ticks(6)) {
    svg += stroke(x(tick), f.bottom, x(tick), f.bottom + 3, "stroke=\"#333\" stroke-width=\"0.6\"");
    svg += svg_label(x(tick), f.bottom + 11, "middle", fmt::format("{:g}", tick));
  }
  if (is_below) {
    svg += svg_label(0.5 * (f.left + f.right), f.bottom + 22, "middle", figure.x_title);
  }
  const bool many = std::count_if(panel.lines.begin(), panel.lines.end(),
                                  [](const auto& line) { return !line.is_behind; }) > 1;
  std::size_t kind = 0;
  for (const FigureLine& line : panel.lines) {
    svg += curve(line, many ? kind : number, x, y);
    kind += !line.is_behind;
  }
  return svg;
}

std::string as_rows(const PaperFigure& figure,
                    const FigurePanel& panel,
                    std::size_t number,
                    const Frame& f) {
  const FigureScale across(figure.y_low, figure.y_high, figure.log_y, f.left, f.right);
  std::string svg = frame_lines(f);
  for (const double tick : across.ticks(6)) {
    svg += stroke(across(tick), f.top, across(tick), f.bottom, grid_style);
    svg += svg_label(across(tick), f.bottom + 10, "middle", fmt::format("{:g}", tick));
  }
  for (std::size_t row = 0; row < panel.rows.size(); ++row) {
    svg += svg_label(f.left - 4, f.top + (static_cast<double>(row) + 0.5) * row_pt + 2.8, "end",
                     panel.rows[row]);
  }
  for (const FigureLine& line : panel.lines) {
    for (const FigurePoint& p : line.points) {
      if (std::isnan(p.y)) continue;
      const double y = f.top + (p.x + 0.5) * row_pt;
      if (!std::isnan(p.low)) {
        svg += stroke(
            across(p.low), y, across(p.high), y,
            fmt::format("stroke=\"{}\" stroke-width=\"0.8\"", colours[number % colours.size()]));
      }
      svg += figure_mark(across(p.y), y, number);
    }
  }
  return svg;
}

std::string panel_title(const FigurePanel& panel, const Frame& f) {
  if (panel.title.empty()) return {};
  constexpr double character_pt = 5.2;
  const auto room = static_cast<std::size_t>(std::max(8.0, (f.right - f.left) / character_pt));
  return svg_label(f.left, f.top - 4, "start", middle_cut(panel.title, room),
                   " font-weight=\"bold\"");
}

/// Names of the lines of the first panel, in a line above all.
std::string key_of(const PaperFigure& figure, double left, double y) {
  std::string svg;
  std::size_t kind = 0;
  for (const FigureLine& line : figure.panels[0].lines) {
    if (line.is_behind) continue;
    if (!line.name.empty()) {
      svg += figure_mark(left + 3, y - 2.8, kind) + svg_label(left + 9, y, "start", line.name);
      left += 16 + 4.4 * static_cast<double>(text_width(line.name));
    }
    ++kind;
  }
  return svg;
}

bool has_key(const PaperFigure& figure) {
  const auto& lines = figure.panels[0].lines;
  return std::any_of(lines.begin(), lines.end(), [](const auto& l) { return !l.name.empty(); });
}

std::string document(double width, double height, const std::string& body) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.1f}pt\" height=\"{1:.1f}pt\" "
      "viewBox=\"0 0 {0:.1f} {1:.1f}\" font-family=\"Helvetica, Arial, 'Liberation Sans', "
      "sans-serif\" font-size=\"{2}\" fill=\"#1d2733\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{3}</svg>\n",
      width, height, text_pt, body);
}

std::string rows_svg(const PaperFigure& figure) {
  std::size_t longest = 0;
  for (const FigurePanel& panel : figure.panels) {
    for (const std::string& row : panel.rows) longest = std::max(longest, text_width(row));
  }
  const double width = longest > 24 ? 504 : 252;
  const double left = std::min(0.6 * width, 12 + 4.3 * static_cast<double>(longest));
  std::string body;
  double top = 8;
  std::size_t number = 0;
  for (const FigurePanel& panel : figure.panels) {
    if (!panel.title.empty()) top += 10;
    const Frame f{left, width - 10, top, top + row_pt * static_cast<double>(panel.rows.size())};
    body += as_rows(figure, panel, number++, f) + panel_title(panel, f);
    top = f.bottom + 18;
  }
  body += svg_label(0.5 * (left + width - 10), top + 6, "middle", figure.y_title);
  return document(width, top + 12, body);
}

/// Whether these are the bytes of a PDF file from its head to its last line.
bool is_whole_pdf(std::string_view bytes) {
  const std::size_t last = bytes.find_last_not_of("\r\n");
  return bytes.starts_with("%PDF-") && bytes.substr(0, last + 1).ends_with("%%EOF");
}

}  // namespace

std::string figure_svg(const PaperFigure& figure) {
  if (!figure.panels[0].rows.empty()) return rows_svg(figure);
  const std::size_t count = figure.panels.size(), columns = std::min<std::size_t>(3, count);
  const std::size_t rows = (count + columns - 1) / columns;
  const double width = count == 1 ? 252 : 504, left = 34, gap = 14, key = has_key(figure) ? 12 : 0;
  const double wide =
      (width - left - 6 - gap * static_cast<double>(columns - 1)) / static_cast<double>(columns);
  const double high = count == 1 ? 130 : 100, between = 34;
  const double first_top = 18 + key;
  std::string body = key_of(figure, left, 10);
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = static_cast<double>(i % columns), row = static_cast<double>(i / columns);
    const double top = first_top + row * (high + between);
    const Frame f{left + column * (wide + gap), left + column * (wide + gap) + wide, top,
                  top + high};
    body += against_axis(figure, figure.panels[i], i, f, i % columns == 0, i + columns >= count) +
            panel_title(figure.panels[i], f);
    if (i % columns == 0) {
      const double x = 9, y = 0.5 * (f.top + f.bottom);
      body += svg_label(x, y, "middle", figure.y_title,
                        fmt::format(" transform=\"rotate(-90 {:.2f} {:.2f})\"", x, y));
    }
  }
  const double last_row = static_cast<double>(rows - 1);
  return document(width, first_top + last_row * (high + between) + high + 28, body);
}

std::optional<std::string> svg_as_pdf(const std::string& svg) {
  const TemporaryFolder folder;
  const std::filesystem::path from = folder.write("figure.svg", svg),
                              to = folder.path() / "figure.pdf";
  constexpr double time_limit_s = 60;
  const ProgramRun run = run_program(
      {"rsvg-convert", "--format=pdf", "--output=" + to.string(), from.string()}, time_limit_s);
  if (run.start_error != 0) return std::nullopt;
  if (run.exit_code != 0) {
    throw Error("rsvg-convert", "failed: " + run.last_output_line(), "leave out --figures");
  }
  std::string pdf = std::filesystem::exists(to) ? read_whole(to) : "";
  if (!is_whole_pdf(pdf)) {
    throw Error("rsvg-convert", "gave no whole PDF file", "leave out --figures");
  }
  return pdf;
}

}  // namespace vernier::cli
