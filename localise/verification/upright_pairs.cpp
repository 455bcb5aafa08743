// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/upright_pairs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localise/verification/upright_pairs.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "localise/verification/floor_plan_votes.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::localise::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::size_t uprights_within(const UprightColumns& uprights,
                            const UprightColumns::Strip& strip,
                            const PlanUpright& upright,
                            std::int32_t* indices) {
  const hn::CappedTag<float, 16> d;
  const auto set = [&](float value) { return hn::Set(d, value); };
  const auto ux = set(strip.ux), uy = set(strip.uy);
  std::size_t found = 0;
  for (std::size_t i = 0; i < uprights.size; i += hn::Lanes(d)) {
    const auto low = hn::LoadU(d, uprights.low_m.data() + i);
    const auto high = hn::LoadU(d, uprights.high_m.data() + i);
    const auto x = hn::LoadU(d, uprights.x_m.data() + i);
    const auto y = hn::LoadU(d, uprights.y_m.data() + i);
    const auto along = hn::Add(hn::Mul(ux, x), hn::Mul(uy, y));
    const auto across = hn::Sub(hn::Mul(ux, y), hn::Mul(uy, x));
    const auto is_near =
        hn::And(hn::And(hn::Ge(along, set(strip.along_low)), hn::Le(along, set(strip.along_high))),
                hn::Le(hn::Abs(hn::Sub(across, set(strip.across))), set(strip.across_most)));
    const auto common =
        hn::Sub(hn::Min(set(upright.high_m), high), hn::Max(set(upright.low_m), low));
    const auto shorter = hn::Min(set(upright.high_m - upright.low_m), hn::Sub(high, low));
    const auto agree = hn::Ge(common, hn::Mul(set(least_common_height), shorter));
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, hn::And(is_near, agree), bytes);
    for (unsigned bits = bytes[0] | bytes[1] << 8; bits != 0; bits &= bits - 1) {
      indices[found++] = static_cast<std::int32_t>(i) + std::countr_zero(bits);
    }
  }
  return found;
}

std::size_t cells_of_shifts(const PairColumns& pairs,
                            float cosine,
                            float sine,
                            int side,
                            std::int32_t* cells,
                            std::int32_t* indices) {
  const hn::CappedTag<float, 16> d;
  const hn::RebindToSigned<decltype(d)> whole;
  const auto c = hn::Set(d, cosine), s = hn::Set(d, sine);
  const int half = (side - 3) / 2;
  const auto most = hn::Set(d, static_cast<float>(half) + 0.5f);
  const auto first = hn::Set(d, static_cast<float>(half) + 1.5f);  // above 0.5 with x and y
  std::size_t found = 0;
  for (std::size_t i = 0; i < pairs.query_x.size(); i += hn::Lanes(d)) {
    const auto qx = hn::LoadU(d, pairs.query_x.data() + i);
    const auto qy = hn::LoadU(d, pairs.query_y.data() + i);
    const auto x =
        hn::Sub(hn::LoadU(d, pairs.node_x.data() + i), hn::Sub(hn::Mul(c, qx), hn::Mul(s, qy)));
    const auto y =
        hn::Sub(hn::LoadU(d, pairs.node_y.data() + i), hn::Add(hn::Mul(s, qx), hn::Mul(c, qy)));
    const auto within = hn::And(hn::Lt(hn::Abs(x), most), hn::Lt(hn::Abs(y), most));
    const auto column = hn::ConvertTo(whole, hn::Add(x, first));
    const auto row = hn::ConvertTo(whole, hn::Add(y, first));
    const auto cell = hn::Add(hn::Mul(row, hn::Set(whole, side)), column);
    alignas(64) std::int32_t all[hn::MaxLanes(d)];
    hn::Store(cell, whole, all);
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, within, bytes);
    for (unsigned bits = bytes[0] | bytes[1] << 8; bits != 0; bits &= bits - 1, ++found) {
      const int lane = std::countr_zero(bits);
      indices[found] = static_cast<std::int32_t>(i) + lane;
      cells[found] = all[lane];
    }
  }
  return found;
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::localise::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::localise::internal {

HWY_EXPORT(uprights_within);
HWY_EXPORT(cells_of_shifts);

namespace {
constexpr std::size_t widest = 16;
constexpr float far_away = 1e9f;
}  // namespace

UprightColumns::UprightColumns(std::span<const PlanUpright> uprights) : size(uprights.size()) {
  const std::size_t padded = (size + widest - 1) / widest * widest;
  for (std::vector<float>* column : {&x_m, &y_m, &low_m, &high_m}) {
    column->assign(padded, far_away);
  }
  for (std::size_t i = 0; i < size; ++i) {
    x_m[i] = uprights[i].x_m;
    y_m[i] = uprights[i].y_m;
    low_m[i] = uprights[i].low_m;
    high_m[i] = uprights[i].high_m;
  }
}

std::span<const std::int32_t> UprightColumns::within(const Strip& strip,
                                                     const PlanUpright& upright,
                                                     std::vector<std::int32_t>& room) const {
  room.resize(x_m.size());
  const std::size_t found =
      HWY_DYNAMIC_DISPATCH(uprights_within)(*this, strip, upright, room.data());
  return std::span(room).first(found);
}

void PairColumns::add(float qx, float qy, float nx, float ny) {
  query_x.push_back(qx);
  query_y.push_back(qy);
  node_x.push_back(nx);
  node_y.push_back(ny);
}

void PairColumns::pad() {
  while (query_x.size() % widest != 0) add(0, 0, far_away, far_away);
}

std::size_t PairColumns::shift_cells(float cosine,
                                     float sine,
                                     int side,
                                     std::vector<std::int32_t>& cells,
                                     std::vector<std::int32_t>& indices) const {
  cells.resize(query_x.size());
  indices.resize(query_x.size());
  return HWY_DYNAMIC_DISPATCH(cells_of_shifts)(*this, cosine, sine, side, cells.data(),
                                               indices.data());
}

}  // namespace vernier::localise::internal
#endif
