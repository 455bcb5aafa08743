// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/tuning/paired_scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/error.h"

namespace vernier::sim::internal {

namespace {

/// The normal deviate that a sum of n terms of unit variance exceeds at any time with probability
/// alpha.
double mixture_deviate(double n, double alpha) {
  return std::sqrt(2 * (1 + 1 / n) * std::log1p(std::sqrt(n + 1) / (2 * alpha)));
}

/// Student's deviate that is as improbable as a normal one; infinite where it overflows.
double student_deviate(double z, double dof) {
  const double scaled = z * (8 * dof + 3) / (8 * dof + 1);
  return std::sqrt(dof * std::expm1(scaled * scaled / dof));
}

}  // namespace

void PairedScores::add_round(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size()) {
    throw Error("paired scores", fmt::format("a round of {} and {} trials", a.size(), b.size()),
                "compare candidates on the same trials");
  }
  Round round{0, static_cast<double>(a.size())};
  for (std::size_t i = 0; i < a.size(); ++i) {
    round.difference += a[i] - b[i];
    squares_ += (a[i] - b[i]) * (a[i] - b[i]);
  }
  sum_ += round.difference;
  trials_ += round.trials;
  rounds_.push_back(round);
}

PairedScores::Variances PairedScores::variances() const {
  if (rounds() < 2) return {};
  const double n = rounds(), mean = difference();
  Variances v;
  for (const Round& round : rounds_) {
    const double off = round.difference - round.trials * mean;
    v.between += n / (n - 1) * off * off;
  }
  v.independent = squares_ - trials_ * mean * mean;
  return v;
}

double PairedScores::sd() const { return trials_ > 0 ? std::sqrt(variance()) / trials_ : 0; }

double PairedScores::limit(double alpha, double variance, int dof) const {
  if (!(alpha > 0 && alpha < 0.5)) {
    throw Error("paired scores", fmt::format("an error rate of {}", alpha), "use one in (0, 0.5)");
  }
  if (dof < 1 || trials_ == 0) return 1;
  const double t = student_deviate(mixture_deviate(rounds(), alpha), dof);
  return std::clamp(difference() + t * std::sqrt(variance) / trials_, -1.0, 1.0);
}

double PairedScores::upper_limit(double alpha) const {
  return limit(alpha, variance(), rounds() - 1);
}

double PairedScores::upper_limit(double alpha, double design_effect, int dof) const {
  return limit(alpha, design_effect * (2 + squares_), dof);
}

}  // namespace vernier::sim::internal
