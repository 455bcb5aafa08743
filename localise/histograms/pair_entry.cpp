// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/histograms/pair_entry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "localise/histograms/smeared_ramp.h"
#include "localise/pgh.h"

namespace vernier::localise::internal {

namespace {

/// Adds to `below`, for every edge of an even division of [0, end], the mass of a Gaussian below
/// it, summed over all turns of the angle by `period` that come within reach.
void add_turns(double angle,
               double sigma,
               double mass,
               double period,
               double end,
               std::vector<double>& below) {
  constexpr double reach = 6;  // in sigmas: 1e-9 of the mass is beyond
  const double width = end / static_cast<double>(below.size() - 1);
  const double first = std::ceil((-reach * sigma - angle) / period);
  for (double at = angle + first * period; at <= end + reach * sigma; at += period) {
    for (std::size_t i = 0; i < below.size(); ++i) {
      below[i] += mass * mass_below(static_cast<double>(i) * width, {at, at, sigma});
    }
  }
}

}  // namespace

void EntryWriter::share_among_angles(const PairEntry& entry) {
  const bool folded = type_ == PghType::mirror;
  // Angles between undirected lines repeat after a half-turn.
  const double period = folded ? std::numbers::pi : axes_.max_angle_rad;
  const double sigma = entry.angle_sigma_rad;
  angles_.assign(static_cast<std::size_t>(axes_.angle_bins), 1.0 / axes_.angle_bins);
  if (!(sigma < period)) return;
  below_.assign(angles_.size() + 1, 0.0);
  // Folding an angle at 0 and π/2 is to count it with both signs.
  const double plus = folded ? 1 : entry.positive, minus = folded ? 1 : 1 - entry.positive;
  const double end = axes_.max_angle_rad;
  if (plus > 0) add_turns(entry.angle_rad, sigma, plus, period, end, below_);
  if (minus > 0) add_turns(-entry.angle_rad, sigma, minus, period, end, below_);
  for (std::size_t i = 0; i < angles_.size(); ++i) angles_[i] = below_[i + 1] - below_[i];
}

void EntryWriter::share_among_distances(const PairEntry& entry) {
  distances_.assign(static_cast<std::size_t>(axes_.distance_bins), 0.0f);
  for (const Stretch& stretch : entry.stretches()) {
    const double mass = entry.weight * stretch.share;
    if (type_ != PghType::directed) {
      add_magnitudes(distances_, axes_.max_distance, stretch.distance, mass);
      continue;
    }
    const auto& [low, high, sigma] = stretch.distance;
    if (stretch.left > 0) {
      add_signed(distances_, axes_.max_distance, {low, high, sigma}, mass * stretch.left);
    }
    if (stretch.left < 1) {
      add_signed(distances_, axes_.max_distance, {-high, -low, sigma}, mass * (1 - stretch.left));
    }
  }
}

void EntryWriter::add(const PairEntry& entry, std::span<float> histogram) {
  share_among_angles(entry);
  share_among_distances(entry);
  const double negligible = 6e-4 / axes_.angle_bins;
  for (int a = 0; a < axes_.angle_bins; ++a) {
    if (angles_[a] < negligible) continue;
    float* row = histogram.data() + axes_.column(entry.band, a, 0);
    const auto share = static_cast<float>(angles_[a]);
    for (int d = 0; d < axes_.distance_bins; ++d) row[d] += share * distances_[d];
  }
}

}  // namespace vernier::localise::internal
