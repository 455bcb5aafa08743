// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/coarse_panorama.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localise/ranking/coarse_products.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace vernier::localise::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void four_coarse_products(const std::int16_t* view,
                          std::size_t n,
                          const std::uint8_t* const* windows,
                          std::int32_t* products) {
  const hn::CappedTag<std::int16_t, 32> d;
  const hn::Repartition<std::int32_t, decltype(d)> wide;
  const hn::Rebind<std::uint8_t, decltype(d)> half;
  const auto load = [&](const std::uint8_t* from) {
    return hn::PromoteTo(d, hn::LoadU(half, from));
  };
  auto s0 = hn::Zero(wide), s1 = s0, s2 = s0, s3 = s0;
  auto t0 = s0, t1 = s0, t2 = s0, t3 = s0;  // the other parts of the sums
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto v = hn::LoadU(d, view + i);
    s0 = hn::ReorderWidenMulAccumulate(wide, v, load(windows[0] + i), s0, t0);
    s1 = hn::ReorderWidenMulAccumulate(wide, v, load(windows[1] + i), s1, t1);
    s2 = hn::ReorderWidenMulAccumulate(wide, v, load(windows[2] + i), s2, t2);
    s3 = hn::ReorderWidenMulAccumulate(wide, v, load(windows[3] + i), s3, t3);
  }
  products[0] = hn::GetLane(hn::SumOfLanes(wide, hn::Add(s0, t0)));
  products[1] = hn::GetLane(hn::SumOfLanes(wide, hn::Add(s1, t1)));
  products[2] = hn::GetLane(hn::SumOfLanes(wide, hn::Add(s2, t2)));
  products[3] = hn::GetLane(hn::SumOfLanes(wide, hn::Add(s3, t3)));
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::localise::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::localise::internal {

HWY_EXPORT(four_coarse_products);

void coarse_products(std::span<const std::int16_t> view,
                     const std::uint8_t* run,
                     std::span<std::int32_t> products) {
  const std::size_t count = products.size();
  for (std::size_t i = 0; i < count; i += 4) {
    const std::uint8_t* windows[4];
    for (std::size_t k = 0; k < 4; ++k) {
      windows[k] = run + std::min(i + k, count - 1) * CoarseBins::channels;
    }
    std::int32_t four[4];
    HWY_DYNAMIC_DISPATCH(four_coarse_products)(view.data(), view.size(), windows, four);
    std::copy_n(four, std::min<std::size_t>(4, count - i), products.begin() + i);
  }
}

}  // namespace vernier::localise::internal
#endif
