// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/stretch_kernel.h"
#include "stereo/matching/stretch_filter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

// As in calib/solver/view_kernel.cpp.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stereo/matching/stretch_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vernier::stereo::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

const hn::ScalableTag<std::int32_t> wide;
const hn::RebindToFloat<decltype(wide)> real;
using Wide = decltype(hn::Zero(wide));

#if HWY_TARGET == HWY_SCALAR
/// A pair of numbers in place of a vector of pairs.
struct Pairs {
  std::int16_t first, second;
};
Pairs load_pairs(const std::int16_t* from) { return {from[0], from[1]}; }
Pairs pairs_in(Wide v) {
  const std::int32_t bits = hn::GetLane(v);
  return {static_cast<std::int16_t>(bits), static_cast<std::int16_t>(bits >> 16)};
}
/// Adds the sums of the products of pairs to those of `even` and `odd`.
Wide add_products(Pairs a, Pairs b, Wide even, Wide& /*odd*/) {
  return hn::Add(even, hn::Set(wide, a.first * b.first + a.second * b.second));
}
Wide in_order(Wide even, Wide /*odd*/) { return even; }
Pairs low_halves(Wide a, Wide b) {
  return {static_cast<std::int16_t>(hn::GetLane(a)), static_cast<std::int16_t>(hn::GetLane(b))};
}
#else
const hn::Repartition<std::int16_t, decltype(wide)> narrow;
using Pairs = decltype(hn::Zero(narrow));
HWY_INLINE Pairs load_pairs(const std::int16_t* from) { return hn::LoadU(narrow, from); }
HWY_INLINE Pairs pairs_in(Wide v) { return hn::BitCast(narrow, v); }
HWY_INLINE Wide add_products(Pairs a, Pairs b, Wide even, Wide& odd) {
  return hn::ReorderWidenMulAccumulate(wide, a, b, even, odd);
}
HWY_INLINE Wide in_order(Wide even, Wide odd) { return hn::RearrangeToOddPlusEven(even, odd); }
HWY_INLINE Pairs low_halves(Wide a, Wide b) {
  return hn::OddEven(pairs_in(hn::ShiftLeft<16>(b)), pairs_in(a));
}
#endif

/// Weighted pairs of pixels.
HWY_INLINE Wide sample(const std::int16_t* pairs, Wide weights) {
  Wide odd = hn::Zero(wide);
  const Wide even = add_products(load_pairs(pairs), pairs_in(weights), hn::Zero(wide), odd);
  return in_order(even, odd);
}

HWY_INLINE std::int32_t pair_of(std::int16_t near, std::int16_t far) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint16_t>(near)) |
                                   static_cast<std::uint32_t>(static_cast<std::uint16_t>(far))
                                       << 16);
}

/// Adds the sums of a row's samples at V vectors of right centres.
template <int V>
HWY_INLINE void add_sums_of(
    const std::int16_t* pairs, const StretchWarp& warp, int row, float* sums, float* squares) {
  const int stride = StretchWarp::row_stride(warp.rows);
  const auto lanes = static_cast<int>(hn::Lanes(wide));
  Wide sum[V], square[V], square_odd[V];
  for (int v = 0; v < V; ++v) sum[v] = square[v] = square_odd[v] = hn::Zero(wide);
  for (int i = 0; i < warp.width; i += 2) {
    const auto k = static_cast<std::size_t>(i * stride + row);
    const bool two = i + 1 < warp.width;
    const std::size_t next = two ? k + static_cast<std::size_t>(stride) : k;
    const auto weights = hn::Set(wide, pair_of(warp.near[k], warp.far[k]));
    const auto others = hn::Set(wide, two ? pair_of(warp.near[next], warp.far[next]) : 0);
    const std::int16_t* const at = pairs + 2 * warp.place[k];
    const std::int16_t* const beside = pairs + 2 * warp.place[next];
    for (int v = 0; v < V; ++v) {
      const Wide one = sample(at + 2 * v * lanes, weights);
      const Wide other = sample(beside + 2 * v * lanes, others);
      sum[v] = hn::Add(sum[v], hn::Add(one, other));
      const Pairs both = low_halves(one, other);
      square[v] = add_products(both, both, square[v], square_odd[v]);
    }
  }
  for (int v = 0; v < V; ++v) {
    const auto add = [&](float* to, Wide values) HWY_ATTR {
      to += v * lanes;
      hn::StoreU(hn::Add(hn::LoadU(real, to), hn::ConvertTo(real, values)), real, to);
    };
    add(sums, sum[v]);
    add(squares, in_order(square[v], square_odd[v]));
  }
}

void add_row_sums(const std::int16_t* pairs,
                  const StretchWarp& warp,
                  int row,
                  int n,
                  float* sums,
                  float* squares) {
  const auto lanes = static_cast<int>(hn::Lanes(wide));
  constexpr int at_once = 4;
  int x = 0;
  for (; x + at_once * lanes <= n; x += at_once * lanes) {
    add_sums_of<at_once>(pairs + 2 * x, warp, row, sums + x, squares + x);
  }
  for (; x < n; x += lanes) add_sums_of<1>(pairs + 2 * x, warp, row, sums + x, squares + x);
}

/// One vector of rows at a time.
void spread_weights(const StretchWarp& warp, const std::int16_t* left, std::int32_t* weights) {
  const hn::CappedTag<std::int16_t, 16> rows;
  const int stride = StretchWarp::row_stride(warp.rows);
  for (int j = 0; j < warp.rows; j += static_cast<int>(hn::Lanes(rows))) {
    auto* to = reinterpret_cast<std::int16_t*>(weights + j);
    auto here = hn::Zero(rows), next = hn::Zero(rows), before = hn::Zero(rows);
    int place = warp.first_offset;
    const auto advance = [&]() HWY_ATTR {
      if ((place - warp.first_offset) % 2 == 1) {
        hn::StoreInterleaved2(before, here, rows, to);
        to += 2 * stride;
      }
      before = here;
      here = next;
      next = hn::Zero(rows);
      ++place;
    };
    for (int i = 0; i < warp.width; ++i) {
      const auto k = static_cast<std::size_t>(i * stride);
      while (place < warp.place[k]) advance();
      const auto values = hn::LoadU(rows, left + k + static_cast<std::size_t>(j));
      here = hn::Add(here, hn::Mul(values, hn::Set(rows, warp.near[k])));
      next = hn::Add(next, hn::Mul(values, hn::Set(rows, warp.far[k])));
    }
    while (place < warp.first_offset + 2 * warp.pairs) advance();
  }
}

void block_weights(const StretchWarp& warp, const std::int16_t* left, std::int32_t* weights) {
  if (warp.spread) {
    spread_weights(warp, left, weights);
    return;
  }
  const int count = warp.width * StretchWarp::row_stride(warp.rows);
  const std::int16_t *const near = warp.near.data(), *const far = warp.far.data();
  for (int k = 0; k < count; ++k) {
    weights[k] = pair_of(static_cast<std::int16_t>(left[k] * near[k]),
                         static_cast<std::int16_t>(left[k] * far[k]));
  }
}

void window_sums(const WindowRows& rows, int n, float count, float* sums, float* inverse) {
  // Blocks with a variance below 0.01 have no texture.
  constexpr float min_variance = 0.01f * StretchWarp::steps * StretchWarp::steps;
  const auto least = hn::Set(real, count * min_variance);
  const auto all = hn::Set(real, count), one = hn::Set(real, 1.0f);
  for (int x = 0; x < n; x += static_cast<int>(hn::Lanes(real))) {
    auto sum = hn::Zero(real), square = hn::Zero(real);
    for (std::size_t j = 0; j < rows.sums.size(); ++j) {
      sum = hn::Add(sum, hn::LoadU(real, rows.sums[j] + x));
      square = hn::Add(square, hn::LoadU(real, rows.squares[j] + x));
    }
    const auto spread = hn::Sub(square, hn::Div(hn::Mul(sum, sum), all));
    hn::StoreU(sum, real, sums + x);
    hn::StoreU(hn::Div(one, hn::Sqrt(hn::Max(spread, least))), real, inverse + x);
  }
}

/// Scores of V vectors of right centres from `first` on.
template <int V>
HWY_INLINE void scores_of(const BlockSearch& search, int first, float* scores) {
  const StretchWarp& warp = search.warp;
  const int stride = StretchWarp::row_stride(warp.rows);
  const auto lanes = static_cast<int>(hn::Lanes(wide));
  Wide even[V], odd[V];
  for (int v = 0; v < V; ++v) even[v] = odd[v] = hn::Zero(wide);
  const std::int32_t* weights = search.weights;
  for (int plane = 0; plane < search.planes; ++plane, weights += warp.pairs * stride) {
    const std::int16_t* const centre = search.right.row(plane, search.top) + 2 * first;
    for (int t = 0; t < warp.pairs; ++t) {
      const std::int32_t* const weight = weights + t * stride;
      const int* const jump = warp.jump.data() + t * stride;
      for (int j = 0; j < warp.rows; ++j) {
        const auto factors = pairs_in(hn::Set(wide, weight[j]));
        const std::int16_t* const at = centre + 2 * static_cast<std::ptrdiff_t>(jump[j]);
        for (int v = 0; v < V; ++v) {
          even[v] = add_products(load_pairs(at + 2 * v * lanes), factors, even[v], odd[v]);
        }
      }
    }
  }
  const auto mean = hn::Set(real, search.mean);
  for (int v = 0; v < V; ++v) {
    const auto sum = hn::ConvertTo(real, in_order(even[v], odd[v]));
    const int x = first + v * lanes;
    const auto centred = hn::Sub(sum, hn::Mul(mean, hn::LoadU(real, search.sums + x)));
    hn::StoreU(hn::Mul(centred, hn::LoadU(real, search.inverse + x)), real, scores + v * lanes);
  }
}

float block_scores(const BlockSearch& search, float* scores) {
  const auto lanes = static_cast<int>(hn::Lanes(wide));
  const int vectors = (search.n + lanes - 1) / lanes;
  int v = 0;
  for (; v + 4 <= vectors; v += 4) {
    scores_of<4>(search, search.first + v * lanes, scores + v * lanes);
  }
  const int first = search.first + v * lanes;
  float* const rest = scores + v * lanes;
  if (vectors - v == 3) scores_of<3>(search, first, rest);
  if (vectors - v == 2) scores_of<2>(search, first, rest);
  if (vectors - v == 1) scores_of<1>(search, first, rest);
  for (int k = search.n; k < vectors * lanes; ++k) scores[k] = -1e30f;
  auto most = hn::LoadU(real, scores);
  for (int k = lanes; k < search.n; k += lanes) most = hn::Max(most, hn::LoadU(real, scores + k));
  return hn::GetLane(hn::MaxOfLanes(real, most));
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::stereo::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::stereo::internal {

HWY_EXPORT(add_row_sums);
HWY_EXPORT(block_weights);
HWY_EXPORT(window_sums);
HWY_EXPORT(block_scores);

void add_row_sums(const std::int16_t* pairs,
                  const StretchWarp& warp,
                  int row,
                  int n,
                  float* sums,
                  float* squares) {
  HWY_DYNAMIC_DISPATCH(add_row_sums)(pairs, warp, row, n, sums, squares);
}

void window_sums(const WindowRows& rows, int n, float count, float* sums, float* inverse) {
  HWY_DYNAMIC_DISPATCH(window_sums)(rows, n, count, sums, inverse);
}

void block_weights(const StretchWarp& warp, const std::int16_t* left, std::int32_t* weights) {
  HWY_DYNAMIC_DISPATCH(block_weights)(warp, left, weights);
}

float block_scores(const BlockSearch& search, float* scores) {
  return HWY_DYNAMIC_DISPATCH(block_scores)(search, scores);
}

StretchWarp::StretchWarp(double stretch_, double shear_, int width_, int rows_, int row_pairs)
    : stretch(stretch_), shear(shear_), width(width_), rows(rows_) {
  const int stride = row_stride(rows);
  for (int i = 0; i < width; ++i) {
    for (int j = 0; j < stride; ++j) {
      const bool there = j < rows;
      const double at = stretch * (i - width / 2) + (there ? shear * (j - rows / 2) : 0);
      const auto sixteenths = static_cast<int>(std::lround(steps * at));
      const int before = sixteenths >= 0 ? sixteenths / steps : -((steps - 1 - sixteenths) / steps);
      const auto part = static_cast<std::int16_t>(sixteenths - steps * before);
      place.push_back(before);
      near.push_back(there ? static_cast<std::int16_t>(steps - part) : std::int16_t{0});
      far.push_back(there ? part : std::int16_t{0});
    }
  }
  first_offset = place.front();
  const int places = place.back() + 2 - first_offset;
  spread = shear == 0 && (places + 1) / 2 < width;
  pairs = spread ? (places + 1) / 2 : width;
  for (int t = 0; t < pairs; ++t) {
    for (int j = 0; j < stride; ++j) {
      const int offset =
          spread ? first_offset + 2 * t : place[static_cast<std::size_t>(t * stride + j)];
      jump.push_back(j * row_pairs + offset);
    }
  }
}

PairedRows::PairedRows(const FilteredImage& image)
    : rows_(image.height + 2 * image.margin_y),
      margin_x_(image.margin_x),
      margin_y_(image.margin_y),
      stride_(2 * image.stride()),
      values_(stride_ * static_cast<std::size_t>(rows_ * image.planes)) {
  const std::size_t count = image.values.size();
  for (std::size_t k = 0; k + 1 < count; ++k) {
    values_[2 * k] = image.values[k];
    values_[2 * k + 1] = image.values[k + 1];
  }
  values_[2 * count - 2] = values_[2 * count - 1] = image.values[count - 1];
}

}  // namespace vernier::stereo::internal
#endif  // HWY_ONCE
