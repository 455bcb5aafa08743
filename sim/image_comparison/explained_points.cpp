// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/image_comparison/explained_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "stereo/canny_edges.h"
#include "stereo/edges/image_edges.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using Eigen::Vector2d;
using stereo::EdgePoint;
using stereo::ImageSegment;

namespace {

/// Lines by the cells of an image that they pass near.
class LinesByPlace {
 public:
  LinesByPlace(const std::vector<ImageSegment>& lines, int width_px, int height_px, double reach_px)
      : columns_(width_px / cell_px + 3), rows_(height_px / cell_px + 3) {
    cells_.resize(static_cast<std::size_t>(columns_) * rows_);
    for (std::size_t i = 0; i < lines.size(); ++i) add(lines[i], static_cast<int>(i), reach_px);
  }

  const std::vector<int>& near(const Vector2d& at) const { return cells_[cell(at)]; }

 private:
  static constexpr int cell_px = 8;

  std::size_t cell(const Vector2d& at) const {
    const auto place = [](double x, int count) {
      return std::clamp(static_cast<int>(std::floor(x / cell_px)) + 1, 0, count - 1);
    };
    return static_cast<std::size_t>(place(at.y(), rows_)) * columns_ + place(at.x(), columns_);
  }

  void add(const ImageSegment& line, int number, double reach_px) {
    const int steps = static_cast<int>(line.length_px() / (cell_px / 2.0)) + 1;
    for (int k = 0; k <= steps; ++k) {
      const Vector2d at = line.a_px + (line.b_px - line.a_px) * (double(k) / steps);
      for (const double dy : {-1.0, 0.0, 1.0}) {
        for (const double dx : {-1.0, 0.0, 1.0}) {
          std::vector<int>& list = cells_[cell(at + (reach_px + cell_px / 4.0) * Vector2d(dx, dy))];
          if (list.empty() || list.back() != number) list.push_back(number);
        }
      }
    }
  }

  int columns_, rows_;
  std::vector<std::vector<int>> cells_;
};

struct Fit {
  int line = 0;
  double along_px = 0, across_px = 0;
};

/// How a point fits a line; false if it does not.
bool fits(const EdgePoint& point, const ImageSegment& line, const ExplainOptions& o, Fit& fit) {
  const double length = line.length_px();
  if (!(length > 0)) return false;
  const Vector2d normal = normal_of(line), from = point.pixel_px.cast<double>() - line.a_px;
  fit.across_px = normal.dot(from);
  if (std::abs(fit.across_px) > o.across_px) return false;
  fit.along_px = (line.b_px - line.a_px).dot(from) / length;
  if (fit.along_px < -o.beyond_px || fit.along_px > length + o.beyond_px) return false;
  return std::abs(normal.dot(point.normal.cast<double>())) >= std::cos(o.turned_rad);
}

}  // namespace

Vector2d normal_of(const ImageSegment& line) {
  const Vector2d d = (line.b_px - line.a_px).normalized();
  return {-d.y(), d.x()};
}

ExplainedPoints explained_points(const stereo::internal::ImageEdges& edges,
                                 const std::vector<ImageSegment>& lines,
                                 const ExplainOptions& options) {
  const LinesByPlace places(lines, edges.width_px, edges.height_px, options.across_px);
  ExplainedPoints result{std::vector<std::vector<PointOnLine>>(lines.size()),
                         std::vector<char>(edges.points.size(), 0)};
  std::vector<Fit> fitting;
  for (std::size_t i = 0; i < edges.points.size(); ++i) {
    const EdgePoint& point = edges.points[i];
    fitting.clear();
    double nearest = std::numeric_limits<double>::infinity();
    std::vector<int> near = places.near(point.pixel_px.cast<double>());
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    for (const int line : near) {
      Fit fit{line, 0, 0};
      if (!fits(point, lines[static_cast<std::size_t>(line)], options, fit)) continue;
      fitting.push_back(fit);
      nearest = std::min(nearest, std::abs(fit.across_px));
    }
    for (const Fit& fit : fitting) {
      if (std::abs(fit.across_px) > nearest + options.alike_px) continue;
      result.explained[i] = 1;
      result.of_line[static_cast<std::size_t>(fit.line)].push_back(
          {static_cast<int>(i), fit.along_px, fit.across_px});
    }
  }
  for (std::vector<PointOnLine>& points : result.of_line) {
    std::sort(points.begin(), points.end(), [](const PointOnLine& p, const PointOnLine& q) {
      return p.along_px != q.along_px ? p.along_px < q.along_px : p.point < q.point;
    });
  }
  return result;
}

}  // namespace vernier::sim::internal
