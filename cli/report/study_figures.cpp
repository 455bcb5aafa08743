// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/report/study_figures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/text_lines.h"
#include "cli/report/figure_svg.h"
#include "cli/simulation/study_folder.h"
#include "cli/simulation/study_table.h"
#include "sim/study/cell_summary.h"
#include "sim/study/one_at_a_time.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"

namespace vernier::cli {
namespace {

constexpr double no_figure = std::numeric_limits<double>::quiet_NaN();

/// A quantity of the cells.
struct CellQuantity {
  std::string file, title;
  std::function<FigurePoint(const CellSummary&)> of;  ///< y and its interval
};

/// Keys that are swept, and how cells are laid out by them.
struct SweepLayout {
  std::string x;  ///< empty: rows
  std::string line;
  std::vector<std::string> panels;
};

std::string shown_key(const std::string& key) {
  return key == "sources.calibration" ? "ψ_c" : short_key(key, {key});
}

SweepLayout layout_of(const StudyResults& results) {
  std::vector<std::string> keys = swept_keys(results);
  std::map<std::string, std::vector<std::string>> values;
  for (const std::string& key : keys) {
    auto& of = values[key];
    for (const CellResult& cell : results.cells) {
      const std::string value = swept_value(cell.cell, key);
      if (std::find(of.begin(), of.end(), value) == of.end()) of.push_back(value);
    }
  }
  SweepLayout layout;
  const bool designed = values.contains("design");
  for (const std::string& key : keys) {
    const auto& of = values[key];
    if (designed || !std::all_of(of.begin(), of.end(),
                                 [](const auto& v) { return to_finite(v).has_value(); })) {
      continue;
    }
    if (layout.x.empty() || of.size() > values[layout.x].size()) layout.x = key;
  }
  if (layout.x.empty()) return layout;
  std::erase(keys, layout.x);
  constexpr std::size_t most_lines = 6;
  if (keys.size() > 1) {
    const auto line = std::find_if(keys.rbegin(), keys.rend(), [&](const std::string& key) {
      return values[key].size() <= most_lines;
    });
    layout.line = line == keys.rend() ? keys.back() : *line;
    std::erase(keys, layout.line);
  }
  layout.panels = keys;
  return layout;
}

/// Cells with the same values of some keys, in their order: title and indices.
std::vector<std::pair<std::string, std::vector<std::size_t>>> grouped(
    const std::vector<CellResult>& cells,
    const std::vector<std::size_t>& of,
    const std::vector<std::string>& keys) {
  std::vector<std::pair<std::string, std::vector<std::size_t>>> groups;
  for (const std::size_t i : of) {
    std::string title;
    for (const std::string& key : keys) {
      const std::string value = swept_value(cells[i].cell, key);
      title += (title.empty() ? "" : ", ") + shown_key(key) + " = " + value;
    }
    const auto found = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& group) { return group.first == title; });
    if (found == groups.end()) {
      groups.push_back({title, {i}});
    } else {
      found->second.push_back(i);
    }
  }
  return groups;
}

class FigureMaker {
 public:
  explicit FigureMaker(const StudyResults& results)
      : cells_(results.cells), layout_(layout_of(results)) {
    for (const CellResult& cell : cells_) summaries_.push_back(cell.summary);
  }

  PaperFigure figure(const CellQuantity& quantity) const {
    PaperFigure figure;
    figure.x_title = shown_key(layout_.x);
    figure.y_title = quantity.title;
    std::vector<std::size_t> all(cells_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    const Groups groups =
        has_design(cells_[0].cell) ? designs() : grouped(cells_, all, layout_.panels);
    for (const auto& [title, cells] : groups) {
      FigurePanel panel;
      panel.title = title;
      if (layout_.x.empty()) {
        add_rows(panel, cells, quantity);
      } else {
        if (layout_.line.empty()) add_behind(panel, groups, title, quantity);
        const auto lines = grouped(cells_, cells,
                                   layout_.line.empty() ? std::vector<std::string>{}
                                                        : std::vector<std::string>{layout_.line});
        for (const auto& [name, of] : lines) panel.lines.push_back({name, points(of, quantity)});
      }
      figure.panels.push_back(std::move(panel));
    }
    set_x_axis(figure);
    set_y_axis(figure);
    return figure;
  }

 private:
  using Groups = std::vector<std::pair<std::string, std::vector<std::size_t>>>;

  std::vector<FigurePoint> points(const std::vector<std::size_t>& cells,
                                  const CellQuantity& quantity) const {
    std::vector<FigurePoint> points;
    for (const std::size_t i : cells) {
      points.push_back(quantity.of(summaries_[i]));
      points.back().x = to_finite(swept_value(cells_[i].cell, layout_.x)).value_or(no_figure);
    }
    std::stable_sort(points.begin(), points.end(),
                     [](const FigurePoint& a, const FigurePoint& b) { return a.x < b.x; });
    return points;
  }

  void add_behind(FigurePanel& panel,
                  const Groups& groups,
                  const std::string& own,
                  const CellQuantity& quantity) const {
    for (const auto& [title, cells] : groups) {
      if (title != own) panel.lines.push_back({"", points(cells, quantity), true});
    }
  }

  /// The name of a cell's row, by its design if it is of one.
  static std::string row_name(const StudyCell& cell) {
    const std::string design = swept_value(cell, "design"), source = swept_value(cell, "source");
    if (design.empty()) return short_label(cell);
    if (source.empty()) return design == "as set" ? "all sources as set" : design;
    return design == "all but" ? "without " + source : source + " = " + swept_value(cell, "value");
  }

  void add_rows(FigurePanel& panel,
                const std::vector<std::size_t>& cells,
                const CellQuantity& quantity) const {
    FigureLine line;
    for (const std::size_t i : cells) {
      FigurePoint point = quantity.of(summaries_[i]);
      point.x = static_cast<double>(panel.rows.size());
      line.points.push_back(point);
      panel.rows.push_back(row_name(cells_[i].cell));
    }
    panel.lines.push_back(std::move(line));
  }

  /// Each design a group, its reference first.
  Groups designs() const {
    Groups groups;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const auto reference = std::find_if(
          cells_.begin(), cells_.end(),
          [&](const CellResult& cell) { return is_reference_of(cell.cell, cells_[i].cell); });
      if (reference == cells_.end()) continue;
      std::string title = swept_value(cells_[i].cell, "design");
      if (title != "swept") title += " this source";
      for (const auto& [key, value] : cells_[i].cell.swept) {
        if (key != "design" && key != "source" && key != "value") title = value + ": " + title;
      }
      if (groups.empty() || groups.back().first != title) {
        groups.push_back({title, {static_cast<std::size_t>(reference - cells_.begin())}});
      }
      groups.back().second.push_back(i);
    }
    return groups;
  }

  static void set_x_axis(PaperFigure& figure) {
    double low = std::numeric_limits<double>::infinity(), high = 0;
    for (const FigurePanel& panel : figure.panels) {
      for (const FigureLine& line : panel.lines) {
        for (const FigurePoint& p : line.points) {
          low = std::min(low, p.x);
          high = std::max(high, p.x);
        }
      }
    }
    figure.log_x = low > 0 && high / low > 20;
  }

  static void set_y_axis(PaperFigure& figure) {
    if (figure.y_title.find('%') != std::string::npos) {
      figure.y_high = 100;
      return;
    }
    double low = std::numeric_limits<double>::infinity(), high = 0;
    for (const FigurePanel& panel : figure.panels) {
      for (const FigureLine& line : panel.lines) {
        for (const FigurePoint& p : line.points) {
          if (std::isnan(p.y)) continue;
          low = std::min(low, p.y);
          high = std::max(high, p.y);
        }
      }
    }
    figure.log_y = low > 0 && high / low > 20;
    figure.y_low = figure.log_y ? low / 1.3 : 0;
    figure.y_high = high > 0 ? (figure.log_y ? 1.3 : 1.08) * high : 1;
  }

  const std::vector<CellResult>& cells_;
  SweepLayout layout_;
  std::vector<CellSummary> summaries_;
};

std::string error_title(const StudyCell& cell) {
  const SystemKind& kind = system_kind(cell.system.name);
  return "median " + kind.error_title + (kind.unit.empty() ? "" : ", " + kind.unit);
}

}  // namespace

std::vector<std::pair<std::string, PaperFigure>> study_figures(const StudyResults& results) {
  const FigureMaker maker(results);
  const std::vector<CellQuantity> quantities{
      {"success", "success, %",
       [](const CellSummary& s) {
         if (s.trials == 0) return FigurePoint{0, no_figure, no_figure, no_figure};
         const auto& i = s.success_interval_95;
         return FigurePoint{0, 100 * s.success, i ? 100 * i->low : no_figure,
                            i ? 100 * i->high : no_figure};
       }},
      {"median_error", error_title(results.cells[0].cell), [](const CellSummary& s) {
         return FigurePoint{0, s.median_error, no_figure, no_figure};
       }}};
  std::vector<std::pair<std::string, PaperFigure>> figures;
  for (const CellQuantity& quantity : quantities) {
    figures.emplace_back(quantity.file, maker.figure(quantity));
  }
  return figures;
}

}  // namespace vernier::cli
