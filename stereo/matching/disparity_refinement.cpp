// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/disparity_refinement.h"
#include "stereo/grey_levels.h"
#include "stereo/image/padded_image.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>

// As in stereo/matching/edge_support.cpp.
#define HWY_WANT_AVX3_DL
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stereo/matching/disparity_refinement.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

#ifndef VERNIER_REFINEMENT_TYPES
#define VERNIER_REFINEMENT_TYPES
namespace vernier::stereo::internal {

constexpr int half_width = 4, half_height = 3, width = 9, rows = 7;
constexpr int lanes = 16;    // per row: its nine pixels, then padding
constexpr int unknowns = 5;  // shift, stretch, shear, gain, offset
constexpr double pixels = width * rows;

using Normal = Eigen::Matrix<double, unknowns, unknowns>;
using Unknowns = Eigen::Matrix<double, unknowns, 1>;

/// The left patch: gradient and grey level, zero beyond the ninth lane.
struct LeftPatch {
  alignas(64) float g[rows][lanes], I[rows][lanes];
};

/// Sums of the right patch K with the left one.
struct RightSums {
  Unknowns with_left;  ///< JᵀK, J = (g, g i, g j, I, 1)
  double squares = 0, sum = 0;
};

}  // namespace vernier::stereo::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace vernier::stereo::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

alignas(64) constexpr float inside[lanes] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
alignas(64) constexpr float column[lanes] = {-4, -3, -2, -1, 0, 1, 2, 3, 4};

/// JᵀJ from its sums.
Normal normal_of(const double (&S)[15]) {
  Normal N;
  N << S[0], S[1], S[3], S[6], S[9],   //
      S[1], S[2], S[4], S[7], S[10],   //
      S[3], S[4], S[5], S[8], S[11],   //
      S[6], S[7], S[8], S[12], S[13],  //
      S[9], S[10], S[11], S[13], pixels;
  return N;
}

/// Loads the left patch and returns JᵀJ.
Normal load_left(const PaddedImage& left, int x, int y, LeftPatch& patch) {
  const hn::CappedTag<float, lanes> d;
  double S[15] = {};
  for (int i = 0; i < lanes; i += static_cast<int>(hn::Lanes(d))) {
    const auto in = hn::Load(d, inside + i), at = hn::Load(d, column + i);
    auto gg = hn::Zero(d), ggj = hn::Zero(d), ggjj = hn::Zero(d), gI = hn::Zero(d),
         gIj = hn::Zero(d), g1 = hn::Zero(d), gj = hn::Zero(d), II = hn::Zero(d), I1 = hn::Zero(d);
    for (int r = 0; r < rows; ++r) {
      const float* const row = left.row(y + r - half_height) + x - half_width + i;
      const auto j = hn::Set(d, static_cast<float>(r - half_height));
      const auto grey = hn::Mul(in, hn::LoadU(d, row));
      const auto slope = hn::Mul(hn::Mul(in, hn::Set(d, 0.5f)),
                                 hn::Sub(hn::LoadU(d, row + 1), hn::LoadU(d, row - 1)));
      hn::Store(grey, d, patch.I[r] + i);
      hn::Store(slope, d, patch.g[r] + i);
      const auto slope2 = hn::Mul(slope, slope), slope_j = hn::Mul(slope, j);
      gg = hn::Add(gg, slope2);
      ggj = hn::MulAdd(slope2, j, ggj);
      ggjj = hn::MulAdd(slope_j, slope_j, ggjj);
      gI = hn::MulAdd(slope, grey, gI);
      gIj = hn::MulAdd(slope_j, grey, gIj);
      g1 = hn::Add(g1, slope);
      gj = hn::Add(gj, slope_j);
      II = hn::MulAdd(grey, grey, II);
      I1 = hn::Add(I1, grey);
    }
    const auto ggi = hn::Mul(gg, at);
    const decltype(gg) sums[15] = {gg,
                                   ggi,
                                   hn::Mul(ggi, at),
                                   ggj,
                                   hn::Mul(ggj, at),
                                   ggjj,
                                   gI,
                                   hn::Mul(gI, at),
                                   gIj,
                                   g1,
                                   hn::Mul(g1, at),
                                   gj,
                                   II,
                                   I1,
                                   in};
    for (int k = 0; k < 15; ++k) S[k] += hn::GetLane(hn::SumOfLanes(d, sums[k]));
  }
  return normal_of(S);
}

/// The right image along a row at base + stretch i, by cubic convolution (Keys 1981, a = −1/2).
template <class D, class V = hn::Vec<D>>
HWY_INLINE V right_row(D d, const float* row, float base, float stretch, int i) {
  const hn::RebindToSigned<D> whole;
  V k[4], t;
  if (stretch == 1.0f) {
    const float floor = std::floor(base);
    const float* const from = row + static_cast<int>(floor) - half_width + i;
    t = hn::Set(d, base - floor);
    for (int n = 0; n < 4; ++n) k[n] = hn::LoadU(d, from + n - 1);
  } else {
    const auto at = hn::MulAdd(hn::Set(d, stretch), hn::Load(d, column + i), hn::Set(d, base));
    const auto floor = hn::Floor(at);
    const auto index = hn::ConvertTo(whole, floor);
    t = hn::Sub(at, floor);
    for (int n = 0; n < 4; ++n) k[n] = hn::GatherIndex(d, row + n - 1, index);
  }
  const auto half = hn::Set(d, 0.5f);
  const auto c1 = hn::Mul(half, hn::Sub(k[2], k[0]));
  const auto c2 = hn::Sub(hn::Add(k[0], hn::Add(k[2], k[2])),
                          hn::MulAdd(hn::Set(d, 2.5f), k[1], hn::Mul(half, k[3])));
  const auto c3 =
      hn::MulAdd(hn::Set(d, 1.5f), hn::Sub(k[1], k[2]), hn::Mul(half, hn::Sub(k[3], k[0])));
  return hn::MulAdd(hn::MulAdd(hn::MulAdd(c3, t, c2), t, c1), t, k[1]);
}

RightSums right_sums(const PaddedImage& right,
                     const LeftPatch& patch,
                     float centre,
                     int y,
                     float stretch,
                     float shear) {
  const hn::CappedTag<float, lanes> d;
  double S[7] = {};
  for (int i = 0; i < lanes; i += static_cast<int>(hn::Lanes(d))) {
    if (i >= width) break;
    const auto in = hn::Load(d, inside + i), at = hn::Load(d, column + i);
    auto g = hn::Zero(d), gj = hn::Zero(d), I = hn::Zero(d), one = hn::Zero(d), K2 = hn::Zero(d);
    for (int r = 0; r < rows; ++r) {
      const auto j = static_cast<float>(r - half_height);
      const auto K =
          hn::Mul(in, right_row(d, right.row(y + r - half_height), centre + shear * j, stretch, i));
      const auto gK = hn::Mul(hn::Load(d, patch.g[r] + i), K);
      g = hn::Add(g, gK);
      gj = hn::MulAdd(gK, hn::Set(d, j), gj);
      I = hn::MulAdd(hn::Load(d, patch.I[r] + i), K, I);
      one = hn::Add(one, K);
      K2 = hn::MulAdd(K, K, K2);
    }
    const decltype(g) sums[6] = {g, hn::Mul(g, at), gj, I, one, K2};
    for (int k = 0; k < 6; ++k) S[k] += hn::GetLane(hn::SumOfLanes(d, sums[k]));
  }
  RightSums sums;
  sums.with_left << S[0], S[1], S[2], S[3], S[4];
  sums.sum = S[4];
  sums.squares = S[5];
  return sums;
}

/// Standard deviation and correlation of a fit; `inverse` is N⁻¹₀₀.
void judge_fit(const Normal& J2,
               const RightSums& K,
               const Unknowns& fit,
               double inverse,
               float stretch,
               const RefinementOptions& options,
               RefinedDisparity& result) {
  const double gain = fit[3];
  const double residual = K.squares - 2 * fit.dot(K.with_left) + fit.dot(J2 * fit);
  const double mean_square = std::max(residual / (pixels - unknowns),
                                      options.noise_left * options.noise_left * gain * gain +
                                          options.noise_right * options.noise_right);
  const double edge_share = std::max(
      0.2, 1 - (pixels - unknowns) * static_cast<double>(options.slope_variance) * inverse);
  const double left_power = J2(3, 3) - J2(3, 4) * J2(3, 4) / pixels,
               right_power = K.squares - K.sum * K.sum / pixels,
               both = K.with_left[3] - J2(3, 4) * K.sum / pixels;
  const double sigma =
      stretch * std::sqrt(std::max(0.0, mean_square * inverse)) / (gain * edge_share);
  const double most = std::hypot(options.start_sigma_px, options.max_shift_px / std::sqrt(3.0));
  result.sigma_px = static_cast<float>(std::min(sigma, most));
  result.score = static_cast<float>(both / std::sqrt(std::max(1e-9, left_power * right_power)));
}

RefinedDisparity refine(const PaddedImage& left,
                        const PaddedImage& right,
                        const RefinementStart& start,
                        const RefinementOptions& options) {
  RefinedDisparity result;
  LeftPatch patch;
  const Normal J2 = load_left(left, start.x, start.y, patch);
  const double noise2 =
      options.noise_left * options.noise_left + options.noise_right * options.noise_right;
  Normal N = J2;
  const double prior = noise2 / (options.stretch_sigma * options.stretch_sigma);
  N(1, 1) += prior;
  N(2, 2) += prior;
  const Eigen::LLT<Normal> factor(N);
  if (factor.info() != Eigen::Success) return result;
  const float begin = static_cast<float>(start.x) - start.disparity_px;
  float centre = begin, stretch = start.stretch, shear = start.shear;
  for (int step = 0; step < options.iterations; ++step) {
    const RightSums K = right_sums(right, patch, centre, start.y, stretch, shear);
    const Unknowns fit = factor.solve(K.with_left);
    const double gain = fit[3];
    if (!(gain > 0.3 && gain < 3)) return result;
    const auto shift = static_cast<float>(fit[0] / gain);
    const auto more_stretch = static_cast<float>(fit[1] / gain);
    const auto more_shear = static_cast<float>(fit[2] / gain);
    constexpr float near_px = 0.05f;  // this step leaves a tenth of it
    if (std::abs(shift) < near_px || step + 1 == options.iterations) {
      judge_fit(J2, K, fit, factor.solve(Unknowns::Unit(0))[0], stretch, options, result);
      result.settled = std::abs(shift) < near_px;
    }
    // The left patch warped by (shift, stretch, shear) matches the right one: apply the inverse.
    const float undone = 1 / (1 + std::clamp(more_stretch, -0.3f, 0.3f));
    centre -= stretch * undone * std::clamp(shift, -0.6f, 0.6f);
    shear -= stretch * undone * std::clamp(more_shear, -0.3f, 0.3f);
    stretch *= undone;
    if (!(std::abs(centre - begin) <= options.max_shift_px) || !(stretch > 0.25f && stretch < 4) ||
        !(std::abs(shear) < 1.2f)) {
      result.settled = false;
      return result;
    }
    if (result.settled) break;
  }
  result.disparity_px = static_cast<float>(start.x) - centre;
  result.stretch = stretch;
  result.shear = shear;
  return result;
}

void refine_all(const PaddedImage& left,
                const PaddedImage& right,
                const std::vector<RefinementStart>& starts,
                const RefinementOptions& options,
                std::vector<RefinedDisparity>& refined) {
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const float at = static_cast<float>(starts[i].x) - starts[i].disparity_px;
    const float reach = 5 * std::max(1.0f, starts[i].stretch);
    const bool usable = starts[i].stretch > 0.25f && starts[i].stretch < 4 &&
                        std::abs(starts[i].shear) < 1.2f && starts[i].x >= 0 &&
                        starts[i].x < left.width() && starts[i].y >= 0 &&
                        starts[i].y < left.height();
    const bool inside_right =
        usable && at > -reach && at < static_cast<float>(right.width()) + reach;
    refined.push_back(inside_right ? refine(left, right, starts[i], options) : RefinedDisparity{});
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::stereo::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::stereo::internal {

HWY_EXPORT(refine_all);

namespace {

constexpr int margin_px = 48;  // of patches stretched fourfold at the border

}  // namespace

DisparityRefiner::DisparityRefiner(const GreyLevels& left,
                                   const GreyLevels& right,
                                   const RefinementOptions& options)
    : left_(left, margin_px), right_(right, margin_px), options_(options) {}

std::vector<RefinedDisparity> DisparityRefiner::refine(
    const std::vector<RefinementStart>& starts) const {
  std::vector<RefinedDisparity> refined;
  refined.reserve(starts.size());
  HWY_DYNAMIC_DISPATCH(refine_all)(left_, right_, starts, options_, refined);
  return refined;
}

}  // namespace vernier::stereo::internal
#endif  // HWY_ONCE
