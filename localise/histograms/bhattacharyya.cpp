// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/bhattacharyya.h"

#include <algorithm>
#include <cmath>

#include "calib/error.h"

namespace vernier::localise {

double bhattacharyya_coefficient(const Eigen::Ref<const Eigen::VectorXd>& p,
                                 const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (p.size() != q.size()) {
    throw Error("Bhattacharyya coefficient", "the histograms have different bins",
                "use the same bins for both");
  }
  const auto is_histogram = [](const auto& h) { return h.allFinite() && (h.array() >= 0).all(); };
  if (!is_histogram(p) || !is_histogram(q)) {
    throw Error("Bhattacharyya coefficient", "an entry is negative or not finite",
                "give counts or masses");
  }
  const double largest_p = p.size() > 0 ? p.maxCoeff() : 0;
  const double largest_q = q.size() > 0 ? q.maxCoeff() : 0;
  if (!(largest_p > 0 && largest_q > 0)) return 0;
  const Eigen::ArrayXd a = p.array() / largest_p, b = q.array() / largest_q;
  return std::min(1.0, (a.sqrt() * b.sqrt()).sum() / std::sqrt(a.sum() * b.sum()));
}

double hellinger_distance(double coefficient) { return std::sqrt(std::max(0.0, 1 - coefficient)); }

double matusita_distance(double coefficient) {
  return std::sqrt(std::max(0.0, 2 - 2 * coefficient));
}

double bhattacharyya_distance(double coefficient) {
  return -std::log(std::clamp(coefficient, 0.0, 1.0));
}

double expected_coefficient(int occupied_bins, double n_p, double n_q) {
  if (occupied_bins < 1 || !(n_p > 0) || !(n_q > 0)) {
    throw Error("expected Bhattacharyya coefficient", "bins or counts are not above 0",
                "give at least one bin and some counts");
  }
  return std::max(0.0, 1 - (occupied_bins - 1) / 8.0 * (1 / n_p + 1 / n_q));
}

}  // namespace vernier::localise
