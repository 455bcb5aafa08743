// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/reconstruction/disparity_line.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

namespace vernier::stereo::internal {
namespace {

using Samples = std::span<const DisparitySample>;

constexpr int max_apart = 3;        // consecutive outliers allowed within one line
constexpr int max_candidates = 32;  // end points of the lines tried
constexpr int max_line_rounds = 10;

/// A line of two coefficients, and the run of samples on it.
struct LineCandidate {
  double at_px = 0, value_px = 0, slope = 0;
  std::vector<int> run;

  double off(const DisparitySample& s) const {
    return s.disparity_px - value_px - slope * (s.along_px - at_px);
  }
};

/// The longest run of samples on the line, with limited outliers in a row.
std::vector<int> longest_run(const LineCandidate& line, Samples samples, double max_off_sigma) {
  std::vector<int> best, run;
  for (int i = 0; i < static_cast<int>(samples.size()); ++i) {
    const DisparitySample& s = samples[static_cast<std::size_t>(i)];
    if (std::abs(line.off(s)) > max_off_sigma * s.sigma_px) continue;
    if (!run.empty() && i - run.back() > max_apart + 1) {
      if (run.size() > best.size()) best = run;
      run.clear();
    }
    run.push_back(i);
  }
  return run.size() > best.size() ? run : best;
}

/// Of the lines through pairs of samples, the one with the longest run.
LineCandidate consensus(Samples samples, const DisparityLineOptions& options) {
  const std::size_t n = samples.size();
  const std::size_t step = std::max<std::size_t>(1, (n + max_candidates - 1) / max_candidates);
  LineCandidate best;
  for (std::size_t i = 0; i < n; i += step) {
    for (std::size_t j = i + 1; j < n; j += step) {
      const double apart = samples[j].along_px - samples[i].along_px;
      if (!(apart > 1)) continue;
      LineCandidate line{samples[i].along_px,
                         samples[i].disparity_px,
                         (samples[j].disparity_px - samples[i].disparity_px) / apart,
                         {}};
      line.run = longest_run(line, samples, options.max_off_sigma);
      if (line.run.size() > best.run.size()) best = std::move(line);
    }
  }
  return best;
}

/// Weighted regression to some of the samples.
struct Regression {
  double centre = 0, mean = 0, weight = 0, spread = 0, slope = 0;

  Regression(Samples samples, const std::vector<int>& places) {
    for (const int i : places) {
      const DisparitySample& s = samples[static_cast<std::size_t>(i)];
      const double w = 1 / (s.sigma_px * s.sigma_px);
      weight += w;
      centre += w * s.along_px;
      mean += w * s.disparity_px;
    }
    centre /= weight;
    mean /= weight;
    double products = 0;
    for (const int i : places) {
      const DisparitySample& s = samples[static_cast<std::size_t>(i)];
      const double w = 1 / (s.sigma_px * s.sigma_px), apart = s.along_px - centre;
      spread += w * apart * apart;
      products += w * apart * (s.disparity_px - mean);
    }
    slope = spread > 0 ? products / spread : 0;
  }

  /// Derivatives of the mean and the slope by a sample's disparity.
  Eigen::Vector2d gain(const DisparitySample& s) const {
    return {1 / weight / (s.sigma_px * s.sigma_px),
            (s.along_px - centre) / spread / (s.sigma_px * s.sigma_px)};
  }
};

/// Covariance of the noise of two samples.
double noise(const DisparitySample& a, const DisparitySample& b, const DisparityLineOptions& o) {
  const auto sigma = [](const DisparitySample& s) {
    return std::sqrt(std::max(0.0, s.sigma_px * s.sigma_px - s.shared_px * s.shared_px));
  };
  const double apart = std::abs(a.along_px - b.along_px);
  return sigma(a) * sigma(b) * std::max(0.0, 1 - apart / o.noise_length_px);
}

/// Covariance of what they share beyond it.
double shared(const DisparitySample& a, const DisparitySample& b, const DisparityLineOptions& o) {
  const double apart = std::abs(a.along_px - b.along_px);
  return a.shared_px * b.shared_px * std::exp(-apart / o.floor_length_px);
}

DisparityLine fitted(Samples samples, const std::vector<int>& run, const DisparityLineOptions& o) {
  const Regression r(samples, run);
  DisparityLine line;
  line.along_px = r.centre;
  line.coefficients = {r.mean, r.slope};
  for (const int i : run) line.samples.push_back(samples[static_cast<std::size_t>(i)]);
  double squares = 0, weighted = 0, expected = 0;
  for (const DisparitySample& a : line.samples) {
    const double off = a.disparity_px - line.at(a.along_px), w = 1 / (a.sigma_px * a.sigma_px);
    squares += off * off;
    weighted += w * off * off;
    const Eigen::Vector2d gain_a = r.gain(a);
    for (const DisparitySample& b : line.samples) {
      const double n = noise(a, b, o), c = n + shared(a, b, o);
      const Eigen::Vector2d gain_b = r.gain(b);
      line.covariance += c * gain_a * gain_b.transpose();
      line.noise_covariance += n * gain_a * gain_b.transpose();
      const double projection = gain_b[0] + gain_b[1] * (a.along_px - r.centre);
      expected += w * ((&a == &b ? 1 : 0) - projection) * c;
    }
  }
  line.rms_px = std::sqrt(squares / static_cast<double>(line.samples.size()));
  if (expected > 0 && weighted > expected) line.covariance *= weighted / expected;
  return line;
}

/// Appends the lines of these samples in order.
void append(Samples samples,
            const DisparityLineOptions& options,
            std::vector<DisparityLine>& lines) {
  const auto least = static_cast<std::size_t>(options.min_points);
  if (samples.size() < least) return;
  LineCandidate line = consensus(samples, options);
  for (int round = 0; round < max_line_rounds && line.run.size() >= least; ++round) {
    const Regression r(samples, line.run);
    LineCandidate next{r.centre, r.mean, r.slope, {}};
    next.run = longest_run(next, samples, options.max_off_sigma);
    const bool settled = next.run == line.run;
    line = std::move(next);
    if (settled) break;
  }
  if (line.run.size() < least) return;
  const auto first = static_cast<std::size_t>(line.run.front());
  const auto end = static_cast<std::size_t>(line.run.back()) + 1;
  append(samples.first(first), options, lines);
  lines.push_back(fitted(samples, line.run, options));
  append(samples.subspan(end), options, lines);
}

}  // namespace

std::vector<DisparityLine> disparity_lines(const std::vector<DisparitySample>& samples,
                                           const DisparityLineOptions& options) {
  std::vector<DisparityLine> lines;
  append(samples, options, lines);
  return lines;
}

}  // namespace vernier::stereo::internal
