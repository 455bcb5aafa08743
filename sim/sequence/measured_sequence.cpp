// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sequence/measured_sequence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <numbers>

#include "calib/statistics/quantile.h"
#include "sim/sequence/lost_again.h"
#include "sim/sequence/sequence_samples.h"
#include "sim/sources/clustered_samples.h"
#include "sim/sources/measured_sources.h"
#include "sim/sources/variance_line.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

constexpr double kept_deviations = 3;
constexpr double most_line_variance_px2 = 0.01;  // of lines that ends are compared with
constexpr int resamples_of_scales = 199;         // they sort or iterate over all samples

constexpr double beyond = std::numeric_limits<double>::infinity();
constexpr std::array length_borders_px{0.0, 15.0, 30.0, 60.0, beyond};

/// Which samples count.
using SequencePart = std::function<bool(const SampleAt&)>;

class FiguresOf {
 public:
  FiguresOf(const SequenceSamples& samples,
            const std::vector<int>& block,
            const MeasuringOptions& options)
      : samples_(samples), block_(block), options_(options), of_scales_(options) {
    of_scales_.bootstrap.resamples = std::min(options.bootstrap.resamples, resamples_of_scales);
    for (std::size_t i = 0; i < lost_whole_.size(); ++i) {
      const MeasuredValue lost = ratio(
          samples.expected,
          [&](const SampleAt& at) {
            return at.length_px >= length_borders_px[i] && at.length_px < length_borders_px[i + 1];
          },
          loss, found_or_not);
      if (lost.known()) lost_whole_[i] = std::clamp(lost.value, 0.0, 1.0);
    }
  }

  SequenceFigures of(const SequencePart& part) const {
    SequenceFigures f;
    const auto& expected = samples_.expected;
    f.loss = ratio(expected, part, loss, [](const ExpectedSample& s) {
      return Sums{s.found_px, s.expected_px, s.chance_px};
    });
    f.loss.interval.high = std::fmin(1.0, f.loss.interval.high);
    f.lost_whole = ratio(expected, part, loss, found_or_not);
    widen_to_wilson(f.lost_whole);
    std::vector<ExpectedSample> found;
    for (const ExpectedSample& s : expected) {
      if (s.found) found.push_back(s);
    }
    f.loss_of_found = ratio(found, part, share, [](const ExpectedSample& s) {
      return Sums{s.expected_px - s.found_px, s.expected_px, 0};
    });
    f.pieces = ratio(found, part, share, [](const ExpectedSample& s) {
      return Sums{double(s.pieces), 1, 0};
    });
    f.end_across_px = across(part);
    add_along(part, f);
    f.not_confirmed = not_confirmed(part);
    widen_to_wilson(f.not_confirmed);
    f.beside_lines = ratio(samples_.segments, part, share, [](const SegmentSample& s) {
      return Sums{double(!s.on_line), 1, 0};
    });
    widen_to_wilson(f.beside_lines);
    f.mismatch = mismatch(part);
    widen_to_wilson(f.mismatch);
    return f;
  }

  /// Segments that no view confirms, less the true ones of which all views lost the line: a segment
  /// with chance c of being confirmed where nothing is stands for 1 / (1 − c).
  MeasuredValue not_confirmed(const SequencePart& part) const {
    std::map<int, Sums> sums;
    const int count = add_to(sums, samples_.confirmed, part, [&](const ConfirmedSample& s) {
      return Sums{s.confirmed ? 0 : 1 / (1 - s.chance), 1,
                  std::pow(lost_of(s.at.length_px), s.asked)};
    });
    return measured_ratio(sums, count, options_, [](const Sums& s) {
      return std::clamp((s.part - s.chance) / (s.whole - s.chance), 0.0, 1.0);
    });
  }

  double turn_rad() const {
    std::vector<FoundSample> all;
    for (const FoundSample& s : samples_.found) {
      if (shows_ends(s)) all.push_back(s);
    }
    return std::sqrt(end_variance(all).other);
  }

 private:
  static double loss(const Sums& s) { return (1 - s.part / s.whole) / (1 - s.chance / s.whole); }
  static double share(const Sums& s) { return s.part / s.whole; }
  static bool shows_ends(const FoundSample& s) {
    return s.joined && s.line_variance_px2 <= most_line_variance_px2;
  }
  double lost_of(double length_px) const {
    std::size_t i = 0;
    while (i + 1 < lost_whole_.size() && length_px >= length_borders_px[i + 1]) ++i;
    return lost_whole_[i];
  }
  static Sums found_or_not(const ExpectedSample& s) { return {double(s.found), 1, s.chance_found}; }

  template <class Sample, class Add>
  MeasuredValue ratio(const std::vector<Sample>& samples,
                      const SequencePart& part,
                      double (*figure)(const Sums&),
                      Add add) const {
    std::map<int, Sums> sums;
    const int count = add_to(sums, samples, part, add);
    return measured_ratio(sums, count, options_, figure);
  }

  template <class Sample, class Add>
  int add_to(std::map<int, Sums>& sums,
             const std::vector<Sample>& samples,
             const SequencePart& part,
             Add add) const {
    int count = 0;
    for (const Sample& s : samples) {
      if (!part(s.at)) continue;
      const Sums of_sample = add(s);
      Sums& total = sums[block_[s.at.view]];
      total.part += of_sample.part;
      total.whole += of_sample.whole;
      total.chance += of_sample.chance;
      ++count;
    }
    return count;
  }

  /// Wrong segments on lines, less those beside lines.
  MeasuredValue mismatch(const SequencePart& part) const {
    std::map<int, Sums> sums;
    const int count = add_to(sums, samples_.found, part, [](const FoundSample& s) {
      return Sums{double(s.wrong), 1, 0};
    });
    add_to(sums, samples_.chance, part, [](const ChanceSample& s) { return Sums{0, 0, s.wrong}; });
    return measured_ratio(sums, count, options_, [](const Sums& s) {
      return std::max(0.0, (s.part - s.chance) / s.whole);
    });
  }

  static VarianceLine end_variance(const std::vector<FoundSample>& samples) {
    std::vector<SquareSample> squares;
    squares.reserve(samples.size());
    for (const FoundSample& s : samples) {
      squares.push_back({s.ends_across_px * s.ends_across_px - s.line_variance_px2,
                         s.length_px * s.length_px, s.line_variance_px2});
    }
    return variance_line(squares, kept_deviations);
  }

  MeasuredValue across(const SequencePart& part) const {
    ClusteredSamples<FoundSample> all;
    for (const FoundSample& s : samples_.found) {
      if (part(s.at) && shows_ends(s)) all.add(block_[s.at.view], s);
    }
    MeasuredValue value = measured(
        all, of_scales_,
        [](const std::vector<FoundSample>& s) { return std::sqrt(end_variance(s).own / 2); }, true);
    not_below_zero(value);
    return value;
  }

  void add_along(const SequencePart& part, SequenceFigures& f) const {
    ClusteredSamples<double> same;
    std::map<int, Sums> cut;
    const int count = add_to(cut, samples_.ends, part, [&](const EndSample& s) {
      const bool far = std::abs(s.along_px) > same_end_px;
      if (!far) same.add(block_[s.at.view], s.along_px);
      return Sums{double(far), 1, 0};
    });
    f.cut_short = measured_ratio(cut, count, options_, share);
    constexpr double of_normal = 1.4826;
    f.end_along_px = measured(
        same, of_scales_,
        [](std::vector<double> off) {
          for (double& x : off) x = std::abs(x);
          return of_normal * median_or_zero(std::move(off)) / std::numbers::sqrt2;
        },
        true);
  }

  const SequenceSamples& samples_;
  const std::vector<int>& block_;
  const MeasuringOptions& options_;
  MeasuringOptions of_scales_;
  std::array<double, length_borders_px.size() - 1> lost_whole_{};
};

std::vector<SequenceBand> bands(const FiguresOf& figures,
                                const std::vector<double>& borders,
                                double SampleAt::*value) {
  std::vector<SequenceBand> all;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    const double from = borders[i], to = borders[i + 1];
    all.push_back({from, to, figures.of([=](const SampleAt& at) {
                     return at.*value >= from && at.*value < to;
                   })});
  }
  return all;
}

}  // namespace

std::vector<int> blocks_of_way(std::span<const SequenceView> views, double& block_m) {
  constexpr int least_blocks = 6, most_blocks = 8;
  std::vector<int> block;
  double way_m = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (v > 0) way_m += (views[v].T_world_camera.t - views[v - 1].T_world_camera.t).norm();
    block.push_back(static_cast<int>(std::min(1e6, way_m / block_m)));
  }
  std::vector<int> used(block);
  if (std::unique(used.begin(), used.end()) - used.begin() >= least_blocks) return block;
  block_m = 0;
  const std::size_t blocks = std::min<std::size_t>(most_blocks, views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    block[v] = static_cast<int>(v * blocks / views.size());
  }
  return block;
}

MeasuredSequence measure_sequence(const SequenceSamples& samples,
                                  std::span<const SequenceView> views,
                                  double block_m,
                                  const MeasuringOptions& options) {
  MeasuredSequence result;
  result.block_m = block_m;
  const std::vector<int> block = blocks_of_way(views, result.block_m);
  std::vector<int> used(block);
  result.clusters = static_cast<int>(std::unique(used.begin(), used.end()) - used.begin());
  result.views = static_cast<int>(views.size());
  result.lines = samples.lines;
  result.with_depth = samples.with_depth;
  const FiguresOf figures(samples, block, options);
  result.all = figures.of([](const SampleAt&) { return true; });
  result.turn_rad = figures.turn_rad();
  constexpr double degree = std::numbers::pi / 180;
  result.lost_again = lost_again(samples.expected, views, block, options);
  result.alike = losses_alike(samples.expected, views, block, options);
  const auto agree = std::count_if(samples.segments.begin(), samples.segments.end(),
                                   [](const SegmentSample& s) { return s.depth_agrees; });
  if (!samples.segments.empty()) {
    result.depths_agree = static_cast<double>(agree) / static_cast<double>(samples.segments.size());
  }
  result.by_range = bands(figures, {0, 1, 2, 3, 5, 10, beyond}, &SampleAt::range_m);
  result.by_angle =
      bands(figures, {0, 30 * degree, 60 * degree, 75 * degree, 91 * degree}, &SampleAt::angle_rad);
  result.by_length =
      bands(figures, {length_borders_px.begin(), length_borders_px.end()}, &SampleAt::length_px);
  return result;
}

}  // namespace vernier::sim::internal
