// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/pgh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <span>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "localise/histograms/line_pairs.h"
#include "localise/histograms/pair_entry.h"
#include "localise/place.h"
#include "stereo/segment.h"

namespace vernier::localise {

using namespace internal;
using namespace stereo;

namespace {

void check(const PghOptions& o) {
  constexpr double most_bins = 1e7;
  const double bins = 8.0 * o.angle_bins * o.distance_bins * o.height_bands;  // directed
  const bool positive = o.angle_bins > 0 && o.distance_bins > 0 && o.height_bands > 0 &&
                        o.max_distance > 0 && o.band_height_m > 0 && o.angle_sigma_rad > 0 &&
                        o.distance_sigma > 0 && o.max_weight_m > 0;
  if (!positive || !(o.endpoint_sigma_px >= 0) || o.max_lines < 2) {
    throw Error("histogram options",
                "bins, bands, distances, sigmas and weight must be above 0, lines above 1",
                "use positive values");
  }
  if (!std::isfinite(o.max_distance)) {
    throw Error("histogram options", "the largest distance is not finite", "use a finite one");
  }
  if (bins > most_bins) {
    throw Error("histogram options", "a histogram has more than 10 million bins",
                "use fewer bins or bands");
  }
}

PghAxes axes_of(const PghOptions& o, int bands) {
  constexpr double right_angle = 0.5 * std::numbers::pi;
  switch (o.type) {
    case PghType::mirror:
      return {bands, o.angle_bins, o.distance_bins, right_angle, 0, o.max_distance};
    case PghType::rotation:
      return {bands, 2 * o.angle_bins, o.distance_bins, 2 * right_angle, 0, o.max_distance};
    case PghType::directed:
      return {bands,           4 * o.angle_bins, 2 * o.distance_bins,
              4 * right_angle, -o.max_distance,  o.max_distance};
  }
  throw Error("histogram options", "the type is unknown", "use mirror, rotation or directed");
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

/// The lines in the robot frame that appear longest to the robot.
std::vector<int> longest_in_view(std::span<const PlaceLine> lines, int most) {
  std::vector<double> subtended;  // angular size: length over range
  for (const PlaceLine& line : lines) {
    const Eigen::Vector3d middle = 0.5 * (line.a_m + line.b_m);
    const double range = std::max(middle.head<2>().norm(), 0.1);
    subtended.push_back(has_direction(line.length_m()) ? line.length_m() / range : 0);
  }
  return longest(subtended, most);
}

/// One row for each of `references`: of every line in `others` except itself the entry that
/// `entry_of(reference, other)` makes. Indices count along both lists. Empty rows are dropped.
template <class EntryOf>
Pgh build(const std::vector<int>& references,
          const std::vector<int>& others,
          const PghAxes& axes,
          PghType type,
          EntryOf entry_of) {
  const auto bins = static_cast<Eigen::Index>(axes.bins());
  Pgh pgh;
  pgh.axes = axes;
  pgh.rows = HistogramRows::Zero(static_cast<Eigen::Index>(references.size()), bins);
  EntryWriter writer(type, axes);
  Eigen::Index kept = 0;
  for (std::size_t r = 0; r < references.size(); ++r) {
    auto row = pgh.rows.row(kept);
    row.setZero();
    for (std::size_t o = 0; o < others.size(); ++o) {
      if (others[o] == references[r]) continue;
      writer.add(entry_of(r, o), {row.data(), static_cast<std::size_t>(bins)});
    }
    const float total = row.sum();
    if (!(total > 1e-6f)) continue;
    row = (row / total).cwiseMax(0.0f).cwiseSqrt();
    row.normalize();
    pgh.lines.push_back(references[r]);
    ++kept;
  }
  pgh.rows.conservativeResize(kept, bins);
  return pgh;
}

template <class WeightOf>
void set_weights(Pgh& pgh, WeightOf weight_of) {
  pgh.weights.resize(static_cast<Eigen::Index>(pgh.lines.size()));
  for (std::size_t i = 0; i < pgh.lines.size(); ++i) {
    pgh.weights[static_cast<Eigen::Index>(i)] = static_cast<float>(weight_of(pgh.lines[i]));
  }
}

LineError error_of(const PlaceLine& line) {
  return {line.sigma_m, line.kind == LineKind::vertical};
}

/// From above, with the robot on its left.
PlaneLine floor_projection(const PlaceLine& line) {
  const Eigen::Vector2d a = line.a_m.head<2>(), b = line.b_m.head<2>();
  const Eigen::Vector2d d = b - a;
  const bool robot_on_left = d.y() * a.x() - d.x() * a.y() >= 0;
  return robot_on_left ? PlaneLine(a, b, error_of(line)) : PlaneLine(b, a, error_of(line));
}

/// Pointing upward, or with the robot on its left.
SpaceLine line_in_space(const PlaceLine& line) {
  const Eigen::Vector3d &a = line.a_m, &b = line.b_m, d = b - a;
  const bool steep = line.kind == LineKind::vertical || std::abs(d.z()) > d.head<2>().norm();
  const bool keep = steep ? d.z() >= 0 : d.y() * a.x() - d.x() * a.y() >= 0;
  return keep ? SpaceLine(a, b, error_of(line)) : SpaceLine(b, a, error_of(line));
}

int band_of(double height_m, const PghOptions& o) {
  const double band = std::floor(height_m / o.band_height_m);
  return static_cast<int>(std::clamp(band, 0.0, o.height_bands - 1.0));
}

}  // namespace

std::string name(PghType type) {
  return type == PghType::mirror ? "mirror" : type == PghType::rotation ? "rotation" : "directed";
}

std::string name(PghBlur blur) { return blur == PghBlur::fixed ? "fixed" : "per_entry"; }

PghType pgh_type(std::string_view name_of) {
  for (const auto type : {PghType::mirror, PghType::rotation, PghType::directed}) {
    if (name(type) == name_of) return type;
  }
  throw Error("type " + vernier::internal::in_quotes(std::string(name_of)), "unknown type",
              "use mirror, rotation or directed");
}

PghBlur pgh_blur(std::string_view name_of) {
  for (const auto blur : {PghBlur::fixed, PghBlur::per_entry}) {
    if (name(blur) == name_of) return blur;
  }
  throw Error("blur " + vernier::internal::in_quotes(std::string(name_of)), "unknown blur",
              "use fixed or per_entry");
}

PghOptions image_pgh_options() {
  return {.angle_bins = 18,
          .distance_bins = 20,
          .max_distance = 400,
          .height_bands = 1,
          .angle_sigma_rad = 0.087,
          .distance_sigma = 20,
          .max_weight_m = 1e9};
}

HistogramRows plain_histograms(const Pgh& pgh) { return pgh.rows.cwiseAbs2(); }

Pgh image_histograms(std::span<const ImageSegment> lines, const PghOptions& options) {
  check(options);
  std::vector<double> lengths;
  for (const ImageSegment& line : lines) {
    lengths.push_back(has_direction(line.length_px()) ? line.length_px() : 0);
  }
  const std::vector<int> chosen = longest(lengths, options.max_lines);
  std::vector<PlaneLine> pointing;
  pointing.reserve(chosen.size());
  for (const int i : chosen) {
    pointing.emplace_back(lines[i].a_px, lines[i].b_px, LineError{options.endpoint_sigma_px});
  }
  Pgh pgh = build(chosen, chosen, axes_of(options, 1), options.type, [&](auto r, auto o) {
    PairEntry entry = pair_in_plane(pointing[r], pointing[o], options);
    entry.weight = pointing[o].length;
    return entry;
  });
  set_weights(pgh, [&](int i) { return lengths[i]; });
  return pgh;
}

Pgh ground_histograms(std::span<const PlaceLine> lines, const PghOptions& options) {
  check(options);
  const auto floor_length = [&](int i) { return (lines[i].b_m - lines[i].a_m).head<2>().norm(); };
  const auto is_point = [&](int i) {
    return lines[i].kind == LineKind::vertical || !has_direction(floor_length(i));
  };
  const std::vector<int> chosen = longest_in_view(lines, options.max_lines);
  std::vector<int> projected, others;  // lines first, then points
  std::vector<PlaneLine> pointing;
  for (const int i : chosen) {
    if (is_point(i)) continue;
    projected.push_back(i);
    pointing.push_back(floor_projection(lines[i]));
  }
  others = projected;
  std::copy_if(chosen.begin(), chosen.end(), std::back_inserter(others), is_point);

  Pgh pgh = build(projected, others, axes_of(options, 2), options.type, [&](auto r, auto o) {
    const PlaceLine& other = lines[others[o]];
    const bool point = o >= projected.size();
    PairEntry entry = point ? point_in_plane(pointing[r], 0.5 * (other.a_m + other.b_m).head<2>(),
                                             other.sigma_m, options)
                            : pair_in_plane(pointing[r], pointing[o], options);
    entry.band = point ? 1 : 0;
    entry.weight = std::min(options.max_weight_m, point ? other.length_m() : pointing[o].length);
    return entry;
  });
  set_weights(pgh, [&](int i) { return std::min(options.max_weight_m, floor_length(i)); });
  return pgh;
}

Pgh spatial_histograms(std::span<const PlaceLine> lines, const PghOptions& options) {
  check(options);
  const std::vector<int> chosen = longest_in_view(lines, options.max_lines);
  std::vector<SpaceLine> pointing;
  pointing.reserve(chosen.size());
  for (const int i : chosen) pointing.push_back(line_in_space(lines[i]));
  const PghAxes axes = axes_of(options, options.height_bands);
  Pgh pgh = build(chosen, chosen, axes, options.type, [&](auto r, auto o) {
    PairEntry entry = pair_in_space(pointing[r], pointing[o], options);
    entry.weight = std::min(options.max_weight_m, pointing[o].length);
    entry.band = band_of(0.5 * (pointing[o].a.z() + pointing[o].b.z()), options);
    return entry;
  });
  set_weights(pgh, [&](int i) { return std::min(options.max_weight_m, lines[i].length_m()); });
  return pgh;
}

}  // namespace vernier::localise
