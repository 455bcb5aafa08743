// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// A register of doubles with the operators that corner_formulas.h asks for. No include guard:
// included inside the namespace of an instruction set, where `hn` is Highway's.

using PackTag = hn::CappedTag<double, kernel_lanes>;
constexpr int pack_lanes = static_cast<int>(hn::MaxLanes(PackTag()));

struct Pack {
  hn::Vec<PackTag> lanes;

  Pack() = default;
  HWY_INLINE explicit Pack(double all) : lanes(hn::Set(PackTag(), all)) {}
  HWY_INLINE explicit Pack(hn::Vec<PackTag> v) : lanes(v) {}
};

HWY_INLINE Pack operator+(Pack a, Pack b) { return Pack(hn::Add(a.lanes, b.lanes)); }
HWY_INLINE Pack operator-(Pack a, Pack b) { return Pack(hn::Sub(a.lanes, b.lanes)); }
HWY_INLINE Pack operator*(Pack a, Pack b) { return Pack(hn::Mul(a.lanes, b.lanes)); }
HWY_INLINE Pack operator/(Pack a, Pack b) { return Pack(hn::Div(a.lanes, b.lanes)); }
/// a b + c and c - a b, fused where the processor can.
HWY_INLINE Pack mul_add(Pack a, Pack b, Pack c) {
  return Pack(hn::MulAdd(a.lanes, b.lanes, c.lanes));
}
HWY_INLINE Pack minus_mul(Pack a, Pack b, Pack c) {
  return Pack(hn::NegMulAdd(a.lanes, b.lanes, c.lanes));
}
HWY_INLINE Pack at_least(Pack a, Pack b) { return Pack(hn::Max(a.lanes, b.lanes)); }
HWY_INLINE Pack sqrt(Pack a) { return Pack(hn::Sqrt(a.lanes)); }
HWY_INLINE Pack atan(Pack a) { return Pack(hn::Atan(PackTag(), a.lanes)); }
/// 1 / sqrt(a) where a > floor, else not a number, or 0.
HWY_INLINE Pack inverse_root_or_nan(Pack a, Pack floor) {
  const auto sound =
      hn::IfThenElse(hn::Gt(a.lanes, floor.lanes), a.lanes, hn::Set(PackTag(), -1.0));
  return Pack(hn::Div(hn::Set(PackTag(), 1.0), hn::Sqrt(sound)));
}
HWY_INLINE Pack inverse_root_or_zero(Pack a, Pack floor) {
  const auto root = hn::Div(hn::Set(PackTag(), 1.0), hn::Sqrt(a.lanes));
  return Pack(hn::IfThenElseZero(hn::Gt(a.lanes, floor.lanes), root));
}
/// Aligned or not: packed arrays are aligned to 64 bytes, which costs nothing to read unaligned.
HWY_INLINE Pack load(const double* from) { return Pack(hn::LoadU(PackTag(), from)); }
HWY_INLINE void store(Pack a, double* to) { hn::StoreU(a.lanes, PackTag(), to); }
/// Whether a < limit in every lane.
HWY_INLINE bool all_below(Pack a, double limit) {
  return hn::AllTrue(PackTag(), hn::Lt(a.lanes, hn::Set(PackTag(), limit)));
}
HWY_INLINE Pack at_most(Pack a, Pack b) { return Pack(hn::Min(a.lanes, b.lanes)); }
HWY_INLINE Pack magnitude(Pack a) { return Pack(hn::Abs(a.lanes)); }
