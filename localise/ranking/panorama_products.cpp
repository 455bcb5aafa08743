// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/panorama.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localise/ranking/panorama_products.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace vernier::localise::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void four_products(const float* view, int n, const std::uint8_t* const* windows, float* products) {
  const hn::ScalableTag<float> d;
  const hn::Rebind<std::int32_t, decltype(d)> whole;
  const hn::Rebind<std::uint8_t, decltype(d)> quarter;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto load = [&](const std::uint8_t* from) {
    return hn::ConvertTo(d, hn::PromoteTo(whole, hn::LoadU(quarter, from)));
  };
  auto s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0;
  for (int i = 0; i < n; i += lanes) {
    const auto v = hn::LoadU(d, view + i);
    s0 = hn::MulAdd(v, load(windows[0] + i), s0);
    s1 = hn::MulAdd(v, load(windows[1] + i), s1);
    s2 = hn::MulAdd(v, load(windows[2] + i), s2);
    s3 = hn::MulAdd(v, load(windows[3] + i), s3);
  }
  products[0] = hn::GetLane(hn::SumOfLanes(d, s0));
  products[1] = hn::GetLane(hn::SumOfLanes(d, s1));
  products[2] = hn::GetLane(hn::SumOfLanes(d, s2));
  products[3] = hn::GetLane(hn::SumOfLanes(d, s3));
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::localise::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::localise::internal {

HWY_EXPORT(four_products);

void window_products(std::span<const float> view,
                     const Panorama& panorama,
                     std::size_t first,
                     std::span<float> products) {
  const std::size_t count = products.size();
  for (std::size_t i = 0; i < count; i += 4) {
    const std::uint8_t* windows[4];
    for (std::size_t k = 0; k < 4; ++k) {
      const Panorama::Window& window = panorama.windows[first + std::min(i + k, count - 1)];
      windows[k] =
          panorama.bins.data() + static_cast<std::size_t>(window.begin) * PanoramaBins::channels;
    }
    float four[4];
    HWY_DYNAMIC_DISPATCH(four_products)
    (view.data(), static_cast<int>(view.size()), windows, four);
    for (std::size_t k = 0; k < 4 && i + k < count; ++k) products[i + k] = four[k];
  }
}

}  // namespace vernier::localise::internal
#endif
