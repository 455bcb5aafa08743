// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace vernier::cli {

/// A mark of a figure; NaN where there is none. In a figure of rows x is the number of the row.
struct FigurePoint {
  double x = 0, y = 0;
  double low = 0, high = 0;  ///< ends of the interval of y
};

struct FigureLine {
  std::string name;  ///< in the key; empty: not there
  std::vector<FigurePoint> points;
  bool is_behind = false;  ///< in grey, without marks
};

struct FigurePanel {
  std::string title;
  std::vector<FigureLine> lines;
  std::vector<std::string> rows;  ///< names; empty: points against an x axis
};

/// A figure for a paper: small multiples with common axes.
struct PaperFigure {
  std::string x_title, y_title;
  bool log_x = false, log_y = false;
  std::vector<FigurePanel> panels;
  double y_low = 0, y_high = 1;  ///< of the axis
};

/// As SVG: 3.5 inches wide with one panel, 7 with more, as columns of papers are; 8 pt text,
/// colours that are told apart with every common kind of colour blindness, and marks in grey print.
std::string figure_svg(const PaperFigure& figure);

/// The same as PDF with its fonts, by rsvg-convert (librsvg) if that program is there; nullopt if
/// not. Throws Error if it fails.
std::optional<std::string> svg_as_pdf(const std::string& svg);

}  // namespace vernier::cli
