// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/pgh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "calib/error.h"
#include "localise/histograms/smeared_ramp.h"
#include "localise/place.h"
#include "stereo/segment.h"

namespace vernier::localise {

using namespace internal;
using namespace stereo;

namespace {

constexpr double right_angle = 0.5 * std::numbers::pi;

/// Contribution of line `other` to the histogram of a reference line: an angle, and up to four
/// intervals of distance, each with its fraction of the line.
struct Entry {
  double angle_rad = 0;
  int band = 0;
  double weight = 0;
  int stretches = 0;
  double low[4] = {}, high[4] = {}, share[4] = {};

  void add(double from, double to, double part) {
    low[stretches] = std::min(from, to);
    high[stretches] = std::max(from, to);
    share[stretches++] = part;
  }
};

void check(const PghOptions& o) {
  if (o.angle_bins < 1 || o.distance_bins < 1 || o.height_bands < 1 || !(o.max_distance > 0) ||
      !(o.band_height_m > 0) || !(o.angle_sigma_rad > 0) || !(o.distance_sigma > 0) ||
      o.max_lines < 2) {
    throw Error("histogram options", "bins, bands, distances and sigmas must be above 0",
                "use positive values");
  }
}

/// Distributes an angle in [0, pi/2] with Gaussian error over the bins, reflected at both ends (-5
/// degrees between undirected lines is 5 degrees).
void angle_shares(double angle, const PghOptions& o, std::vector<double>& shares) {
  shares.resize(o.angle_bins);
  const double width = right_angle / o.angle_bins;
  const auto below = [&](double x) { return smeared_ramp_cdf(x, angle, angle, o.angle_sigma_rad); };
  for (int i = 0; i < o.angle_bins; ++i) {
    const double low = i * width, high = low + width;
    shares[i] = below(high) - below(low) + below(-low) - below(-high) +
                below(2 * right_angle - low) - below(2 * right_angle - high);
  }
}

void add_entry(const Entry& entry,
               const PghOptions& o,
               std::vector<double>& shares,
               std::span<float> histogram) {
  angle_shares(entry.angle_rad, o, shares);
  std::vector<float>& ramp = [&]() -> std::vector<float>& {
    thread_local std::vector<float> bins;
    bins.assign(o.distance_bins, 0.0f);
    return bins;
  }();
  for (int s = 0; s < entry.stretches; ++s) {
    if (entry.low[s] > o.max_distance + 4 * o.distance_sigma) continue;
    add_smeared_ramp(ramp, o.max_distance, entry.low[s], entry.high[s], o.distance_sigma,
                     entry.weight * entry.share[s]);
  }
  for (int a = 0; a < o.angle_bins; ++a) {
    if (shares[a] < 1e-4) continue;
    float* row = histogram.data() +
                 static_cast<std::ptrdiff_t>(entry.band * o.angle_bins + a) * o.distance_bins;
    const auto share = static_cast<float>(shares[a]);
    for (int d = 0; d < o.distance_bins; ++d) row[d] += share * ramp[d];
  }
}

/// Builds every row from `entry_of(reference, other)`, normalises it, and drops empty ones.
template <class EntryOf, class WeightOf>
Pgh build(const std::vector<int>& chosen,
          int bands,
          const PghOptions& o,
          EntryOf entry_of,
          WeightOf weight_of) {
  const int bins = bands * o.angle_bins * o.distance_bins;
  Pgh pgh;
  pgh.rows = HistogramRows::Zero(static_cast<Eigen::Index>(chosen.size()), bins);
  pgh.weights.resize(static_cast<Eigen::Index>(chosen.size()));
  std::vector<double> shares;
  Eigen::Index kept = 0;
  for (const int reference : chosen) {
    auto row = pgh.rows.row(kept);
    row.setZero();
    for (const int other : chosen) {
      if (other == reference) continue;
      const Entry entry = entry_of(reference, other);
      add_entry(entry, o, shares, {row.data(), static_cast<std::size_t>(bins)});
    }
    const float total = row.sum();
    if (!(total > 1e-6f)) continue;
    row = (row / total).cwiseMax(0.0f).cwiseSqrt();
    row.normalize();
    pgh.weights[kept++] = static_cast<float>(weight_of(reference));
  }
  pgh.rows.conservativeResize(kept, bins);
  pgh.weights.conservativeResize(kept);
  return pgh;
}

/// Whether a line of this length has a direction.
bool has_direction(double length) { return length > 1e-9 && std::isfinite(length); }

/// Indices of the `most` largest lengths in their original order; length 0 marks a line to drop.
std::vector<int> longest(const std::vector<double>& lengths, int most) {
  std::vector<int> order;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (lengths[i] > 0) order.push_back(static_cast<int>(i));
  }
  if (static_cast<int>(order.size()) > most) {
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return lengths[a] > lengths[b]; });
    order.resize(most);
    std::sort(order.begin(), order.end());
  }
  return order;
}

/// Distances of a segment's points from the line (p, unit u): a hyperbola that falls to the point
/// nearest the line and rises from there. Each branch is approximated by two intervals with
/// linearly growing distance.
void add_stretches(const Eigen::Vector3d& p,
                   const Eigen::Vector3d& u,
                   const PlaceLine& other,
                   Entry& entry) {
  const auto across = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const Eigen::Vector3d y = x - p;
    return y - u * u.dot(y);
  };
  const Eigen::Vector3d a = across(other.a_m), d = across(other.b_m) - a;
  const double dd = d.squaredNorm();
  if (dd < 1e-12) {
    entry.add(a.norm(), a.norm(), 1);
    return;
  }
  const double nearest = std::clamp(-a.dot(d) / dd, 0.0, 1.0);
  const auto branch = [&](double from, double to) {
    if (!(to > from)) return;
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    const double at_middle = (a + middle * d).norm();
    entry.add((a + from * d).norm(), at_middle, half);
    entry.add(at_middle, (a + to * d).norm(), half);
  };
  branch(0, nearest);
  branch(nearest, 1);
}

}  // namespace

PghOptions image_pgh_options() {
  return {.angle_bins = 18,
          .distance_bins = 20,
          .max_distance = 400,
          .height_bands = 1,
          .angle_sigma_rad = 0.087,
          .distance_sigma = 20,
          .max_weight_m = 1e9};
}

Pgh spatial_histograms(std::span<const PlaceLine> lines, const PghOptions& options) {
  check(options);
  std::vector<double> subtended;  // angular size: length over range
  std::vector<Eigen::Vector3d> directions;
  for (const PlaceLine& line : lines) {
    const Eigen::Vector3d middle = 0.5 * (line.a_m + line.b_m);
    const double range = std::max(middle.head<2>().norm(), 0.1);
    subtended.push_back(has_direction(line.length_m()) ? line.length_m() / range : 0);
    directions.push_back((line.b_m - line.a_m).normalized());
  }
  const auto weight = [&](int i) { return std::min(options.max_weight_m, lines[i].length_m()); };
  const auto entry_of = [&](int reference, int other) {
    Entry entry;
    const double cosine = std::abs(directions[reference].dot(directions[other]));
    entry.angle_rad = std::acos(std::min(1.0, cosine));
    entry.weight = weight(other);
    const double height = 0.5 * (lines[other].a_m.z() + lines[other].b_m.z());
    entry.band = std::clamp(static_cast<int>(std::floor(height / options.band_height_m)), 0,
                            options.height_bands - 1);
    add_stretches(lines[reference].a_m, directions[reference], lines[other], entry);
    return entry;
  };
  return build(longest(subtended, options.max_lines), options.height_bands, options, entry_of,
               weight);
}

Pgh image_histograms(std::span<const ImageSegment> lines, const PghOptions& options) {
  check(options);
  std::vector<double> lengths;
  for (const ImageSegment& line : lines) {
    lengths.push_back(has_direction(line.length_px()) ? line.length_px() : 0);
  }
  const auto entry_of = [&](int reference, int other) {
    const ImageSegment &r = lines[reference], &o = lines[other];
    const Eigen::Vector2d u = (r.b_px - r.a_px) / lengths[reference];
    const Eigen::Vector2d v = (o.b_px - o.a_px) / lengths[other];
    Entry entry;
    entry.angle_rad = std::acos(std::min(1.0, std::abs(u.dot(v))));
    entry.weight = lengths[other];
    const auto across = [&](const Eigen::Vector2d& x) {
      const Eigen::Vector2d y = x - r.a_px;
      return u.x() * y.y() - u.y() * y.x();
    };
    const double a = across(o.a_px), b = across(o.b_px);
    if (a * b < 0) {  // crosses the reference line
      const double share = std::abs(a) / (std::abs(a) + std::abs(b));
      entry.add(0, std::abs(a), share);
      entry.add(0, std::abs(b), 1 - share);
    } else {
      entry.add(std::abs(a), std::abs(b), 1);
    }
    return entry;
  };
  return build(longest(lengths, options.max_lines), 1, options, entry_of,
               [&](int i) { return lengths[i]; });
}

}  // namespace vernier::localise
