// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "calib/interval.h"
#include "calib/statistics/cluster_interval.h"
#include "sim/sources/measured_sources.h"
#include "stereo/evaluation/pair_samples.h"

namespace vernier::sim::internal {

/// Cluster of a position in a pair's left image.
struct ClusterOf {
  bool by_pair = false;

  int operator()(const stereo::internal::PairSamples& of,
                 int pair,
                 const Eigen::Vector2d& left_px) const {
    constexpr int parts = 4;
    if (by_pair) return pair;
    const auto part = [](double at, int size) {
      return std::clamp(static_cast<int>(parts * at / std::max(1, size)), 0, parts - 1);
    };
    return (pair * parts + part(left_px.y(), of.height_px)) * parts +
           part(left_px.x(), of.width_px);
  }
};

/// Samples by cluster; clusters without samples are dropped.
template <class Sample>
class ClusteredSamples {
 public:
  void add(int cluster, const Sample& sample) {
    const auto [at, is_new] = place_.emplace(cluster, clusters_.size());
    if (is_new) clusters_.emplace_back();
    clusters_[at->second].push_back(sample);
    ++count_;
  }

  int count() const { return count_; }
  int clusters() const { return static_cast<int>(clusters_.size()); }

  /// The samples of these clusters.
  std::vector<Sample> taken(std::span<const std::size_t> clusters) const {
    std::vector<Sample> all;
    for (const std::size_t k : clusters) {
      all.insert(all.end(), clusters_[k].begin(), clusters_[k].end());
    }
    return all;
  }
  std::vector<Sample> all() const {
    std::vector<Sample> all;
    for (const auto& cluster : clusters_) all.insert(all.end(), cluster.begin(), cluster.end());
    return all;
  }

 private:
  std::map<int, std::size_t> place_;
  std::vector<std::vector<Sample>> clusters_;
  int count_ = 0;
};

/// Clamps at 0.
inline void not_below_zero(MeasuredValue& measured) {
  if (measured.interval.low < 0) measured.interval.low = 0;
}

/// The interval of a fraction is at least that of independent trials: otherwise identical samples
/// would have none.
inline void widen_to_wilson(MeasuredValue& share) {
  if (!share.known()) return;
  const Interval wilson = wilson_interval(share.value * share.samples, share.samples);
  share.interval.low = std::fmin(share.interval.low, wilson.low);
  share.interval.high = std::min(1.0, std::fmax(share.interval.high, wilson.high));
}

/// A statistic of all samples with its interval; unset if there are too few.
template <class Sample, class Figure>
MeasuredValue measured(const ClusteredSamples<Sample>& samples,
                       const MeasuringOptions& options,
                       Figure figure,
                       bool is_scale = false) {
  MeasuredValue result;
  result.samples = samples.count();
  if (samples.count() < options.min_samples) return result;
  result.value = figure(samples.all());
  result.interval = vernier::internal::cluster_interval(
      samples.clusters(),
      [&](std::span<const std::size_t> drawn) { return figure(samples.taken(drawn)); },
      options.bootstrap, is_scale);
  return result;
}

/// Sums for a statistic such as a ratio: one entry per cluster instead of many samples.
struct Sums {
  double part = 0, whole = 0, chance = 0;
};

/// The same from sums, `count` samples in total.
template <class Figure>
MeasuredValue measured_ratio(const std::map<int, Sums>& clusters,
                             int count,
                             const MeasuringOptions& options,
                             Figure figure) {
  std::vector<Sums> sums;
  std::vector<std::size_t> each;
  for (const auto& [cluster, of_cluster] : clusters) {
    each.push_back(sums.size());
    sums.push_back(of_cluster);
  }
  const auto of = [&](std::span<const std::size_t> drawn) {
    Sums total;
    for (const std::size_t k : drawn) {
      total.part += sums[k].part;
      total.whole += sums[k].whole;
      total.chance += sums[k].chance;
    }
    return figure(total);
  };
  MeasuredValue result;
  result.samples = count;
  if (count < options.min_samples) return result;
  result.value = of(each);
  result.interval =
      vernier::internal::cluster_interval(static_cast<int>(clusters.size()), of, options.bootstrap);
  not_below_zero(result);
  return result;
}

}  // namespace vernier::sim::internal
