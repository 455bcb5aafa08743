// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "localise/histograms/smeared_ramp.h"
#include "localise/pgh.h"

namespace vernier::localise::internal {

/// A part of a line over which its distance from the reference grows evenly.
struct Stretch {
  SmearedRamp distance;  ///< of its points; its sign is dropped unless the type is `directed`
  double share = 0;      ///< of the line
  double left = 1;       ///< of its mass, the part that has this sign; the rest has the other
};

/// What a line adds to the histogram of a reference line.
struct PairEntry {
  double angle_rad = 0;
  double angle_sigma_rad = 0;  ///< from a full period on, the angle is not known: even over all
  double positive = 1;         ///< part of the mass at +angle_rad; the rest is at -angle_rad
  int band = 0;
  double weight = 0;

  void add(const Stretch& stretch) { stretches_[count_++] = stretch; }
  std::span<const Stretch> stretches() const {
    return std::span(stretches_).first(static_cast<std::size_t>(count_));
  }

  static constexpr int most_stretches = 12;

 private:
  std::array<Stretch, most_stretches> stretches_;
  int count_ = 0;
};

/// Enters lines into histograms of one type and resolution.
class EntryWriter {
 public:
  EntryWriter(PghType type, const PghAxes& axes) : type_(type), axes_(axes) {}

  /// Adds an entry, integrated over the bins, to a histogram of axes.bins().
  void add(const PairEntry& entry, std::span<float> histogram);

 private:
  void share_among_angles(const PairEntry& entry);
  void share_among_distances(const PairEntry& entry);

  PghType type_;
  PghAxes axes_;
  std::vector<double> angles_, below_;  // mass of each angle bin; mass below each edge
  std::vector<float> distances_;
};

}  // namespace vernier::localise::internal
