// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/view_kernel.h"

// Machines have AVX-512, AVX2 or, rarely, only SSE2; targets in between gain nothing here. The
// formulas keep packs in arrays, which vectors without a fixed size (SVE, RVV) do not allow.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calib/solver/view_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <array>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace vernier::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "calib/camera/corner_formulas.inc"
#include "calib/solver/pack.inc"

/// Corners whose rows fit the first-level cache together: 16 x 2 x 14 columns x 64 bytes.
constexpr int chunk_corners = 16;

/// Index of the sum for the product of columns i <= j of the row of u (or v): see corner_rows().
constexpr std::size_t sum_index(bool v, int i, int j, int columns) {
  const auto place = [v](int c) { return c < 2 ? 2 * c + (v ? 1 : 0) : c + 2; };
  return packed_index(place(i), place(j), columns + 2) * kernel_lanes;
}

enum class Rows { u, v, both };

/// Adds to `sums` the products of columns I0 … I0 + H - 1 by J0 … J0 + W - 1 over `n` corners.
template <Rows which, int columns, int I0, int J0, int H, int W>
HWY_INLINE void add_tile(const Pack* rows, int n, double* sums) {
  const auto each = [](auto&& f) HWY_ATTR {
    [&]<std::size_t... E>(std::index_sequence<E...>) HWY_ATTR {
      (f(std::integral_constant<int, int(E) / W>{}, std::integral_constant<int, int(E) % W>{}),
       ...);
    }
    (std::make_index_sequence<H * W>{});
  };
  Pack sum[H * W];
  each([&](auto i, auto j) HWY_ATTR {
    if constexpr (I0 + i <= J0 + j) {
      sum[i * W + j] = load(sums + sum_index(which == Rows::v, I0 + i, J0 + j, columns));
    }
  });
  for (int k = 0; k < n; ++k, rows += 2 * columns) {
    if constexpr (which != Rows::v) {
      each([&](auto i, auto j) HWY_ATTR {
        if constexpr (I0 + i <= J0 + j) {
          sum[i * W + j] = mul_add(rows[I0 + i], rows[J0 + j], sum[i * W + j]);
        }
      });
    }
    if constexpr (which != Rows::u) {
      each([&](auto i, auto j) HWY_ATTR {
        if constexpr (I0 + i <= J0 + j) {
          sum[i * W + j] = mul_add(rows[columns + I0 + i], rows[columns + J0 + j], sum[i * W + j]);
        }
      });
    }
  }
  each([&](auto i, auto j) HWY_ATTR {
    if constexpr (I0 + i <= J0 + j) {
      store(sum[i * W + j], sums + sum_index(which == Rows::v, I0 + i, J0 + j, columns));
    }
  });
}

/// Tiles of one row of blocks, from column J0 on.
template <Rows which, int columns, int I0, int H, int J0, int step>
HWY_INLINE void add_tile_row(const Pack* rows, int n, double* sums) {
  if constexpr (J0 < columns) {
    constexpr int W = J0 + step <= columns ? step : columns - J0;
    add_tile<which, columns, I0, J0, H, W>(rows, n, sums);
    add_tile_row<which, columns, I0, H, J0 + W, step>(rows, n, sums);
  }
}

/// The triangle of columns that both rows share, from I0 on.
template <int columns, int I0, int step>
HWY_INLINE void add_triangle(const Pack* rows, int n, double* sums) {
  if constexpr (I0 < columns) {
    constexpr int H = I0 + step <= columns ? step : columns - I0;
    add_tile_row<Rows::both, columns, I0, H, I0, step>(rows, n, sums);
    add_triangle<columns, I0 + H, step>(rows, n, sums);
  }
}

template <class Model>
HWY_INLINE CornerView<Model, Pack> load_view(const ViewLanes& views, int lane) {
  CornerView<Model, Pack> c;
  for (int i = 0; i < 9; ++i) c.R[i] = load(views.pose + i * kernel_lanes + lane);
  for (int i = 0; i < 3; ++i) c.t[i] = load(views.pose + (9 + i) * kernel_lanes + lane);
  c.fx = Pack(views.intrinsics[0]);
  c.fy = Pack(views.intrinsics[1]);
  c.ox = Pack(views.intrinsics[2]);
  c.oy = Pack(views.intrinsics[3]);
  for (int i = 0; i < CornerView<Model, Pack>::distortions; ++i) {
    c.k[i] = Pack(views.intrinsics[4 + i]);
  }
  return c;
}

/// The two rows of one corner from the packed arrays.
template <bool Warp, class Model>
HWY_INLINE void load_rows(const CornerView<Model, Pack>& c,
                          const ViewLanes& views,
                          int corner,
                          int lane,
                          Pack* u,
                          Pack* v) {
  const double* target = views.target + corner * target_stride(Warp) + lane;
  const double* pixels = views.pixels + corner * pixel_stride + lane;
  Pack X[3] = {load(target), load(target + kernel_lanes), load(target + 2 * kernel_lanes)};
  const Pack weight = load(target + 3 * kernel_lanes);
  Pack shape[2];
  if constexpr (Warp) {
    for (int s = 0; s < 2; ++s) {
      shape[s] = load(target + (4 + s) * kernel_lanes);
      X[2] = mul_add(shape[s], Pack(views.warp_m[s]), X[2]);
    }
  }
  const Pack pixel[2] = {load(pixels), load(pixels + kernel_lanes)};
  corner_rows<Warp>(Model{}, c, X, shape, weight, pixel, u, v);
}

template <class Model, bool Warp>
void sum_model(const ViewLanes& views, double* sums) {
  constexpr int columns = CornerView<Model, Pack>::distortions + (Warp ? 11 : 9);
  constexpr int step = HWY_TARGET == HWY_AVX3 ? 4 : 3;  // 32 registers or 16
  constexpr std::size_t size = packed_size(columns + 2) * kernel_lanes;
  for (std::size_t i = 0; i < size; ++i) sums[i] = 0;
  Pack rows[chunk_corners * 2 * columns];
  for (int lane = 0; lane < kernel_lanes; lane += pack_lanes) {
    const auto c = load_view<Model>(views, lane);
    for (int first = 0; first < views.corners; first += chunk_corners) {
      const int n = views.corners - first < chunk_corners ? views.corners - first : chunk_corners;
      for (int k = 0; k < n; ++k) {
        load_rows<Warp>(c, views, first + k, lane, rows + 2 * k * columns,
                        rows + (2 * k + 1) * columns);
      }
      add_tile_row<Rows::u, columns, 0, 2, 0, 2 * step>(rows, n, sums + lane);
      add_tile_row<Rows::v, columns, 0, 2, 0, 2 * step>(rows, n, sums + lane);
      add_triangle<columns, 2, step>(rows, n, sums + lane);
    }
  }
}

template <class Model, bool Warp>
void residuals_model(const ViewLanes& views, double* chi2) {
  constexpr int columns = CornerView<Model, Pack>::distortions + (Warp ? 11 : 9);
  for (int lane = 0; lane < kernel_lanes; lane += pack_lanes) {
    const auto c = load_view<Model>(views, lane);
    Pack sum(0.0), u[columns], v[columns];
    for (int k = 0; k < views.corners; ++k) {
      load_rows<Warp>(c, views, k, lane, u, v);
      sum = mul_add(u[columns - 1], u[columns - 1], mul_add(v[columns - 1], v[columns - 1], sum));
    }
    store(sum, chi2 + lane);
  }
}

void sum_views(const ViewLanes& views, double* sums) {
  std::visit(
      [&](auto model) {
        using Model = decltype(model);
        views.warp ? sum_model<Model, true>(views, sums) : sum_model<Model, false>(views, sums);
      },
      *views.model);
}

void sum_residuals(const ViewLanes& views, double* chi2) {
  std::visit(
      [&](auto model) {
        using Model = decltype(model);
        views.warp ? residuals_model<Model, true>(views, chi2)
                   : residuals_model<Model, false>(views, chi2);
      },
      *views.model);
}

void factor_views(int n, double* sums) {
  const auto at = [&](int i, int j) { return sums + packed_index(i, j, n) * kernel_lanes; };
  for (int lane = 0; lane < kernel_lanes; lane += pack_lanes) {
    for (int i = 0; i < n; ++i) {
      // A pivot below n ε of the column's own square is rounding.
      const Pack full = load(at(i, i) + lane);
      Pack pivot = full;
      for (int k = 0; k < i; ++k) {
        const Pack U = load(at(k, i) + lane);
        pivot = minus_mul(U, U, pivot);
      }
      const Pack inverse = inverse_root_or_zero(pivot, full * Pack(n * 0x1p-52));
      for (int j = i; j < n; ++j) {
        Pack sum = load(at(i, j) + lane);
        for (int k = 0; k < i; ++k) {
          sum = minus_mul(load(at(k, i) + lane), load(at(k, j) + lane), sum);
        }
        store(sum * inverse, at(i, j) + lane);
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::internal {

HWY_EXPORT(sum_views);
HWY_EXPORT(sum_residuals);
HWY_EXPORT(factor_views);

void sum_views(const ViewLanes& views, double* sums) {
  HWY_DYNAMIC_DISPATCH(sum_views)(views, sums);
}

void sum_residuals(const ViewLanes& views, double* chi2) {
  HWY_DYNAMIC_DISPATCH(sum_residuals)(views, chi2);
}

void factor_views(int columns, double* sums) { HWY_DYNAMIC_DISPATCH(factor_views)(columns, sums); }

}  // namespace vernier::internal
#endif
