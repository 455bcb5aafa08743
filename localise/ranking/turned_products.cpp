// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/view_descriptor.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localise/ranking/turned_products.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace vernier::localise::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Dot products of one stored descriptor with five turns of the query, the first at `query`.
void five_products(const std::uint16_t* stored, const float* query, int n, float* products) {
  constexpr std::ptrdiff_t step = DescriptorBins::channels;
  const hn::ScalableTag<float> d;
  const hn::RebindToUnsigned<decltype(d)> whole;
  const hn::Rebind<std::uint16_t, decltype(d)> half;
  const int lanes = static_cast<int>(hn::Lanes(d));
  auto s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0, s4 = s0;
  for (int i = 0; i < n; i += lanes) {
    const auto a =
        hn::BitCast(d, hn::ShiftLeft<16>(hn::PromoteTo(whole, hn::LoadU(half, stored + i))));
    s0 = hn::MulAdd(a, hn::LoadU(d, query + i), s0);
    s1 = hn::MulAdd(a, hn::LoadU(d, query + i + step), s1);
    s2 = hn::MulAdd(a, hn::LoadU(d, query + i + 2 * step), s2);
    s3 = hn::MulAdd(a, hn::LoadU(d, query + i + 3 * step), s3);
    s4 = hn::MulAdd(a, hn::LoadU(d, query + i + 4 * step), s4);
  }
  const auto sum = [&](auto v) { return hn::GetLane(hn::SumOfLanes(d, v)); };
  products[0] = sum(s0);
  products[1] = sum(s1);
  products[2] = sum(s2);
  products[3] = sum(s3);
  products[4] = sum(s4);
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::localise::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::localise::internal {

HWY_EXPORT(five_products);

void turned_products(std::span<const float> query,
                     std::span<const std::uint16_t> stored,
                     const DescriptorBins& bins,
                     std::span<TurnedProduct> products) {
  constexpr int turns = 2 * most_turn_bins + 1;
  static_assert(turns % 5 == 0);
  // With empty bearings on both sides: the k-th turn begins k bearings later, and a query that is
  // turned by t bins sees the node's bearing b at b - t.
  const auto margin = static_cast<std::size_t>(most_turn_bins) * DescriptorBins::channels;
  std::vector<float> wide(query.size() + 2 * margin, 0.0f);
  std::copy(query.begin(), query.end(), wide.begin() + static_cast<std::ptrdiff_t>(margin));
  const auto size = static_cast<std::size_t>(bins.size());
  for (std::size_t i = 0; i < products.size(); ++i) {
    products[i] = {-1, 0};
    for (int first = 0; first < turns; first += 5) {
      float five[5];
      HWY_DYNAMIC_DISPATCH(five_products)
      (stored.data() + i * size, wide.data() + first * DescriptorBins::channels, bins.size(), five);
      for (int k = 0; k < 5; ++k) {
        if (five[k] > products[i].product) products[i] = {five[k], most_turn_bins - first - k};
      }
    }
  }
}

}  // namespace vernier::localise::internal
#endif
