// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/localise/shape_from_pgh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace vernier::test {

using namespace vernier::localise;
using namespace vernier::stereo;
using Eigen::Vector2d;

namespace {

/// Signed distances of a line's ends. Where signs are not known, |low| <= high.
struct Ends {
  double low = 0, high = 0;
  double span() const { return high - low; }
  Ends negated() const { return {-high, -low}; }
};

struct ReadEntry {
  double angle_rad = 0;
  Ends ends;
};

double cross(const Vector2d& u, const Vector2d& v) { return u.x() * v.y() - u.y() * v.x(); }

class Reader {
 public:
  Reader(const PghAxes& axes, PghType type) : axes_(axes), type_(type) {}

  double angle_width() const { return axes_.max_angle_rad / axes_.angle_bins; }

  /// Entries of a row: runs of angle bins that are not empty.
  std::vector<ReadEntry> entries(const Eigen::RowVectorXf& row) const {
    const int n = axes_.angle_bins;
    Eigen::VectorXd mass(n);
    for (int a = 0; a < n; ++a) mass[a] = distances(row, a).sum();
    const bool periodic = type_ != PghType::mirror;
    const auto filled = [&](int a) { return mass[((a % n) + n) % n] > 1e-5; };
    std::vector<ReadEntry> found;
    for (int first = 0; first < n; ++first) {
      const bool begins = filled(first) && ((first == 0 && !periodic) || !filled(first - 1));
      if (!begins) continue;
      double moment = 0, total = 0;
      Eigen::VectorXd profile = Eigen::VectorXd::Zero(axes_.distance_bins);
      for (int a = first; filled(a) && a < first + n && (periodic || a < n); ++a) {
        moment += mass[a % n] * (a + 0.5);
        total += mass[a % n];
        profile += distances(row, a % n);
      }
      const double angle = std::fmod(moment / total * angle_width(), axes_.max_angle_rad);
      found.push_back({angle, fitted_ends(profile / total)});
    }
    return found;
  }

 private:
  Eigen::VectorXd distances(const Eigen::RowVectorXf& row, int angle) const {
    return row.segment(axes_.column(0, angle, 0), axes_.distance_bins).transpose().cast<double>();
  }

  bool is_signed() const { return type_ == PghType::directed; }
  double width() const { return (axes_.max_distance - axes_.min_distance) / axes_.distance_bins; }

  /// Squared difference of a profile of distances and an even density between two ends.
  double misfit(const Eigen::VectorXd& profile, const Ends& ends) const {
    const auto overlap = [&](double from, double to) {
      return std::max(0.0, std::min(to, ends.high) - std::max(from, ends.low)) / ends.span();
    };
    double sum = 0;
    for (Eigen::Index i = 0; i < profile.size(); ++i) {
      const double from = axes_.min_distance + static_cast<double>(i) * width();
      const double to = from + width();
      const double mass = overlap(from, to) + (is_signed() ? 0 : overlap(-to, -from));
      sum += std::pow(profile[i] - mass, 2);
    }
    return sum;
  }

  /// The ends whose even density fits the bins best.
  Ends fitted_ends(const Eigen::VectorXd& profile) const {
    Eigen::Index last = profile.size() - 1;
    while (last > 0 && profile[last] < 0.25 * profile.maxCoeff()) --last;
    const double high = axes_.min_distance + static_cast<double>(last + 1) * width();
    // Without signs, [-high, high] looks like [0, high], which is taken.
    const double lowest = is_signed() ? axes_.min_distance : -0.75 * high;
    Ends best{high - width(), high};
    double least = std::numeric_limits<double>::infinity();
    const auto attempt = [&](const Ends& ends) {
      if (ends.span() < 0.1 * width()) return false;
      const double value = misfit(profile, ends);
      if (!(value < least)) return false;
      least = value;
      best = ends;
      return true;
    };
    for (double low = lowest; low < high; low += 0.5 * width()) attempt({low, high});
    for (double step = width(); step > 0.01 * width(); step /= 2) {
      bool better = true;
      while (better) {
        better = false;
        for (const auto& [by_low, by_high] :
             {std::pair(step, 0.0), {-step, 0.0}, {0.0, step}, {0.0, -step}}) {
          better = attempt({best.low + by_low, best.high + by_high}) || better;
        }
      }
    }
    return best;
  }

  PghAxes axes_;
  PghType type_;
};

/// entry[i][j]: what row i says of line j. Empty if the entries do not tell.
using Table = std::vector<std::vector<std::optional<ReadEntry>>>;

/// The other way round, an angle has the opposite sign, as far as it has one.
double angle_mismatch(double of_i, double of_j, PghType type) {
  if (type == PghType::mirror) return std::abs(of_i - of_j);
  const double period = type == PghType::rotation ? M_PI : 2 * M_PI;
  return std::abs(std::remainder(of_i + of_j, period));
}

Table labelled(const std::vector<std::vector<ReadEntry>>& rows, PghType type, double tolerance) {
  const std::size_t n = rows.size();
  Table table(n, std::vector<std::optional<ReadEntry>>(n));
  for (std::size_t i = 0; i < n; ++i) {
    if (rows[i].size() != n - 1) return {};
    for (const ReadEntry& entry : rows[i]) {
      std::size_t partners = 0, partner = 0;
      for (std::size_t j = 0; j < n; ++j) {
        if (j == i) continue;
        for (const ReadEntry& other : rows[j]) {
          if (angle_mismatch(entry.angle_rad, other.angle_rad, type) > tolerance) continue;
          ++partners;
          partner = j;
        }
      }
      if (partners != 1 || table[i][partner]) return {};
      table[i][partner] = entry;
    }
  }
  return table;
}

class Placement {
 public:
  Placement(const Table& table, PghType type, double angle_tolerance, double tolerance)
      : table_(table), type_(type), angle_tolerance_(angle_tolerance), tolerance_(tolerance) {}

  std::vector<Shape> all() {
    double along = 0, weight = 0;  // length of the first line, as all others see it
    for (std::size_t j = 1; j < table_.size(); ++j) {
      const double sine = std::abs(std::sin(table_[j][0]->angle_rad));
      along += sine * table_[j][0]->ends.span();
      weight += sine * sine;
    }
    shape_ = {{Vector2d::Zero(), {along / weight, 0}}};
    place_next();
    return shapes_;
  }

 private:
  void place_next() {
    const std::size_t j = shape_.size();
    if (j == table_.size()) {
      shapes_.push_back(shape_);
      return;
    }
    // A half-turn and, for `mirror`, a reflection are free: the second line fixes them.
    const bool first = j == 1;
    std::vector<double> angles{table_[0][j]->angle_rad};
    if (type_ == PghType::mirror && !first) angles.push_back(M_PI - angles[0]);
    for (const double angle : angles) {
      for (const Ends& of_j : with_signs(table_[0][j]->ends, first)) {
        for (const Ends& of_first : with_signs(table_[j][0]->ends, false)) {
          shape_.push_back(placed(angle, of_j, of_first));
          if (agrees_with_all(j)) place_next();
          shape_.pop_back();
        }
      }
    }
  }

  std::vector<Ends> with_signs(const Ends& ends, bool fixed) const {
    if (type_ == PghType::directed || fixed) return {ends};
    return {ends, ends.negated()};
  }

  /// The line at an angle to x whose ends have these distances from x, and from which the ends of
  /// the first line have those.
  static ImageSegment placed(double angle, const Ends& from_x, const Ends& of_first) {
    const Vector2d v(std::cos(angle), std::sin(angle));
    const bool rises = v.y() > 0;
    const double y_a = rises ? from_x.low : from_x.high, y_b = rises ? from_x.high : from_x.low;
    const double origin = rises ? of_first.high : of_first.low;  // v × (0 - a)
    const Vector2d a((origin + v.x() * y_a) / v.y(), y_a);
    return {a, a + v * (y_b - y_a) / v.y()};
  }

  bool agrees_with_all(std::size_t j) const {
    for (std::size_t k = 0; k < j; ++k) {
      if (!agrees(k, j) || !agrees(j, k)) return false;
    }
    return true;
  }

  /// Whether row i says of line j what the placed lines show.
  bool agrees(std::size_t i, std::size_t j) const {
    const ImageSegment &r = shape_[i], &o = shape_[j];
    const ReadEntry& said = *table_[i][j];
    const Vector2d u = (r.b_px - r.a_px).normalized(), v = o.b_px - o.a_px;
    const double seen = std::atan2(cross(u, v), u.dot(v));
    const double period = type_ == PghType::directed ? 2 * M_PI : M_PI;
    double wrong = std::abs(std::remainder(seen - said.angle_rad, period));
    if (type_ == PghType::mirror) {
      wrong = std::min(wrong, std::abs(std::remainder(seen + said.angle_rad, period)));
    }
    if (wrong > angle_tolerance_) return false;
    const double a = cross(u, o.a_px - r.a_px), b = cross(u, o.b_px - r.a_px);
    const Ends ends{std::min(a, b), std::max(a, b)};
    const auto near = [&](const Ends& e) {
      return std::abs(e.low - said.ends.low) < tolerance_ &&
             std::abs(e.high - said.ends.high) < tolerance_;
    };
    return near(ends) || (type_ != PghType::directed && near(ends.negated()));
  }

  const Table& table_;
  PghType type_;
  double angle_tolerance_, tolerance_;
  Shape shape_;
  std::vector<Shape> shapes_;
};

}  // namespace

std::vector<Shape> shapes_from_histograms(const HistogramRows& histograms,
                                          const PghAxes& axes,
                                          PghType type,
                                          double tolerance) {
  const Reader reader(axes, type);
  std::vector<std::vector<ReadEntry>> rows;
  for (Eigen::Index i = 0; i < histograms.rows(); ++i) {
    rows.push_back(reader.entries(histograms.row(i)));
  }
  const Table table = labelled(rows, type, reader.angle_width());
  if (table.size() < 2) return {};
  return Placement(table, type, 2 * reader.angle_width(), tolerance).all();
}

}  // namespace vernier::test
