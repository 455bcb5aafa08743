// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/histograms/best_matches.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localise/histograms/best_matches.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

#include "calib/error.h"
#include "localise/pgh.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::localise::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Dot products of 4 rows of A with 2 rows of B over n columns, with fused multiply-add if
/// available.
void dot_4x2(const float* A,
             std::ptrdiff_t lda,
             const float* B,
             std::ptrdiff_t ldb,
             int n,
             float (&out)[4][2]) {
  const hn::ScalableTag<float> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  auto s00 = hn::Zero(d), s01 = s00, s10 = s00, s11 = s00, s20 = s00, s21 = s00, s30 = s00,
       s31 = s00;
  int i = 0;
  for (; i + lanes <= n; i += lanes) {
    const auto b0 = hn::LoadU(d, B + i), b1 = hn::LoadU(d, B + ldb + i);
    const auto a0 = hn::LoadU(d, A + i), a1 = hn::LoadU(d, A + lda + i);
    const auto a2 = hn::LoadU(d, A + 2 * lda + i), a3 = hn::LoadU(d, A + 3 * lda + i);
    s00 = hn::MulAdd(a0, b0, s00);
    s01 = hn::MulAdd(a0, b1, s01);
    s10 = hn::MulAdd(a1, b0, s10);
    s11 = hn::MulAdd(a1, b1, s11);
    s20 = hn::MulAdd(a2, b0, s20);
    s21 = hn::MulAdd(a2, b1, s21);
    s30 = hn::MulAdd(a3, b0, s30);
    s31 = hn::MulAdd(a3, b1, s31);
  }
  const auto sum = [&](auto v) { return hn::GetLane(hn::SumOfLanes(d, v)); };
  const float sums[4][2] = {
      {sum(s00), sum(s01)}, {sum(s10), sum(s11)}, {sum(s20), sum(s21)}, {sum(s30), sum(s31)}};
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 2; ++c) {
      float tail = 0;
      for (int k = i; k < n; ++k) tail += A[r * lda + k] * B[c * ldb + k];
      out[r][c] = sums[r][c] + tail;
    }
  }
}

/// `queries` has a multiple of 4 rows, `stored` a multiple of 2 (padded by the caller).
void best_matches(const float* queries,
                  int nq,
                  std::ptrdiff_t ldq,
                  const float* stored,
                  int ns,
                  std::ptrdiff_t lds,
                  int n,
                  float* of_queries,
                  float* of_stored) {
  float out[4][2];
  for (int s = 0; s < ns; s += 2) {
    const std::ptrdiff_t second = s + 1 < ns ? lds : 0;  // an odd last row is used twice
    for (int q = 0; q < nq; q += 4) {
      dot_4x2(queries + q * ldq, ldq, stored + s * lds, second, n, out);
      for (int r = 0; r < 4; ++r) {
        for (int c = 0; c < (second ? 2 : 1); ++c) {
          of_queries[q + r] = of_queries[q + r] < out[r][c] ? out[r][c] : of_queries[q + r];
          of_stored[s + c] = of_stored[s + c] < out[r][c] ? out[r][c] : of_stored[s + c];
        }
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::localise::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::localise::internal {

HWY_EXPORT(best_matches);

BestMatches best_matches(const Eigen::Ref<const HistogramRows>& queries,
                         const Eigen::Ref<const HistogramRows>& stored) {
  if (queries.cols() != stored.cols()) {
    throw Error("histogram comparison", "the two sets have different bins",
                "use the same options for both");
  }
  BestMatches best{Eigen::VectorXf::Zero(queries.rows()), Eigen::VectorXf::Zero(stored.rows())};
  if (queries.rows() == 0 || stored.rows() == 0) return best;
  // Queries in blocks of four rows; the last block is padded with empty rows that match nothing.
  const Eigen::Index padded = (queries.rows() + 3) / 4 * 4;
  HistogramRows block;
  const float* data = queries.data();
  Eigen::Index stride = queries.outerStride();
  if (padded != queries.rows()) {
    block = HistogramRows::Zero(padded, queries.cols());
    block.topRows(queries.rows()) = queries;
    data = block.data();
    stride = block.outerStride();
  }
  Eigen::VectorXf of_queries = Eigen::VectorXf::Zero(padded);
  HWY_DYNAMIC_DISPATCH(best_matches)
  (data, static_cast<int>(padded), stride, stored.data(), static_cast<int>(stored.rows()),
   stored.outerStride(), static_cast<int>(stored.cols()), of_queries.data(), best.of_stored.data());
  best.of_queries = of_queries.head(queries.rows());
  return best;
}

}  // namespace vernier::localise::internal
#endif
