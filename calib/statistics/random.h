// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace vernier::internal {

/// Identifies a random draw. The generator has no other state: the same counter gives the same
/// numbers whatever else is drawn, in any order, on any number of threads.
struct RandomCounter {
  std::uint64_t seed = 0;
  std::uint32_t trial = 0;
  std::uint32_t feature = 0;  ///< identity of the thing, never its position in a list
  std::uint32_t source = 0;   ///< 8 bits: which process draws
  std::uint32_t eye = 0;      ///< 2 bits: 0 left, 1 right
  std::uint32_t frame = 0;    ///< 22 bits: time step or observation
};

/// `place` for the view of a camera in a frame, distinct for every frame from 0 and every camera
/// from 0 to 63: sets the feature and, with the part that exceeds its 32 bits, the counter's frame.
RandomCounter of_view(RandomCounter place, int frame, int camera);

/// `place` for the prior of this number from 0 to 65535, distinct from those of all views.
RandomCounter of_prior(RandomCounter place, std::uint32_t number);

/// Stream of random numbers for one counter: Philox4x32-10 (Salmon et al., "Parallel random
/// numbers: as easy as 1, 2, 3", SC11) with key = seed and counter = (trial, feature, source · eye
/// · frame, draw). Normal deviates by inverse CDF, so one draw costs one uniform and couples
/// monotonically.
class RandomStream {
 public:
  /// Throws Error if source, eye or frame exceed their bits.
  explicit RandomStream(const RandomCounter& place);

  double uniform();                         ///< in (0, 1), 53 bits
  double uniform(double low, double high);  ///< in (low, high)
  double normal();                          ///< mean 0, standard deviation 1
  std::uint32_t below(std::uint32_t n);     ///< integer in [0, n)
  Eigen::VectorXd normals(int n);

 private:
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> words_{};
  int used_ = 4;
};

/// Quantile of the standard normal distribution, p in (0, 1): Wichura's AS 241, PPND16
/// (relative accuracy about 1e-16).
double normal_quantile(double p);

}  // namespace vernier::internal
