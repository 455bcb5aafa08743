// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/fma_peak.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/fma_peak.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vernier {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::int64_t fma_chains(std::int64_t rounds, double& sink) {
  const hn::CappedTag<double, 8> d;
  const auto a = hn::Set(d, 0.999999), b = hn::Set(d, 1e-6);
  auto x0 = hn::Set(d, 1.0), x1 = x0, x2 = x0, x3 = x0, x4 = x0, x5 = x0, x6 = x0, x7 = x0;
  for (std::int64_t i = 0; i < rounds; ++i) {
    for (int twice = 0; twice < 2; ++twice) {
      x0 = hn::MulAdd(x0, a, b);
      x1 = hn::MulAdd(x1, a, b);
      x2 = hn::MulAdd(x2, a, b);
      x3 = hn::MulAdd(x3, a, b);
      x4 = hn::MulAdd(x4, a, b);
      x5 = hn::MulAdd(x5, a, b);
      x6 = hn::MulAdd(x6, a, b);
      x7 = hn::MulAdd(x7, a, b);
    }
  }
  const auto s =
      hn::Add(hn::Add(hn::Add(x0, x1), hn::Add(x2, x3)), hn::Add(hn::Add(x4, x5), hn::Add(x6, x7)));
  sink += hn::GetLane(hn::SumOfLanes(d, s));
  return rounds * 16 * 2 * static_cast<std::int64_t>(hn::Lanes(d));
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier {
HWY_EXPORT(fma_chains);
std::int64_t fma_chains(std::int64_t rounds, double& sink) {
  return HWY_DYNAMIC_DISPATCH(fma_chains)(rounds, sink);
}
}  // namespace vernier
#endif
