// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/epipolar_kernel.h"

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/solver/frame_kernel.h"
#include "calib/solver/loss.h"
#include "calib/solver/view_kernel.h"

#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calib/solver/epipolar_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace vernier::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "calib/camera/corner_formulas.inc"
#include "calib/solver/dual_number.inc"
#include "calib/solver/epipolar_formulas.inc"
#include "calib/solver/pack.inc"

using Constants = CameraConstants<Pack>;
using NoiseFreeView = void (*)(const Constants&, Pack, Pack, EpipolarRay<Pack>&);
using Columns = void (*)(const Constants&, const EpipolarRay<Pack>&, Pack, Pack, Pack*);

template <class Model>
void look_model(const Constants& c, Pack u, Pack v, EpipolarRay<Pack>& s) {
  look_at(Model{}, c, u, v, s);
}
template <class Model>
void columns_model(
    const Constants& c, const EpipolarRay<Pack>& s, Pack rho, Pack scale, Pack* row) {
  camera_columns(Model{}, c, s, rho, scale, row);
}

/// One camera with its model resolved.
struct Side {
  Constants constants;
  NoiseFreeView look;
  Columns columns;
  int count;  // of its columns
};

Side side_of(const EpipolarView& view, int c) {
  Side side;
  side.constants.f = view.f_px[c];
  side.constants.ax = view.ax[c];
  side.constants.ox = view.ox_px[c];
  side.constants.oy = view.oy_px[c];
  for (int i = 0; i < max_distortion_count; ++i) side.constants.k[i] = Pack(view.k[c][i]);
  side.count = parameter_count(view.models[c]);
  std::visit(
      [&](auto model) {
        side.look = look_model<decltype(model)>;
        side.columns = columns_model<decltype(model)>;
      },
      view.models[c]);
  return side;
}

struct Geometry {
  Side left, right;
  PairPose<Pack> pose;

  explicit Geometry(const EpipolarView& view) : left(side_of(view, 0)), right(side_of(view, 1)) {
    for (int i = 0; i < 9; ++i) pose.R[i] = Pack(view.R[i]);
    pose.t = {Pack(view.t[0]), Pack(view.t[1]), Pack(view.t[2])};
  }

  /// The row of one pack of pairs; returns the residual, which is also its last column.
  HWY_INLINE Pack row(const Lanes* packed, int lane, Pack* row) const {
    EpipolarRay<Pack> l, r;
    left.look(left.constants, load(packed[0].of + lane), load(packed[1].of + lane), l);
    right.look(right.constants, load(packed[2].of + lane), load(packed[3].of + lane), r);
    Pack* const pose_columns = row + left.count + right.count;
    const auto terms = pair_terms(pose, left.constants, right.constants, load(packed[4].of + lane),
                                  l, r, pose_columns);
    left.columns(left.constants, l, terms.rho, terms.scale, row);
    right.columns(right.constants, r, terms.rho, terms.scale, row + left.count);
    pose_columns[6] = terms.residual;
    return terms.residual;
  }

  HWY_INLINE Pack residual(const Lanes* packed, int lane) const {
    EpipolarRay<Pack> l, r;
    left.look(left.constants, load(packed[0].of + lane), load(packed[1].of + lane), l);
    right.look(right.constants, load(packed[2].of + lane), load(packed[3].of + lane), r);
    Pack unused[6];
    return pair_terms(pose, left.constants, right.constants, load(packed[4].of + lane), l, r,
                      unused)
        .residual;
  }
};

/// The loss of a pack of residuals.
struct PackLoss {
  Pack cost, weight;
};
HWY_INLINE PackLoss loss_of(const Loss& loss, Pack r) {
  const Pack one(1.0), c(loss.limit), gain(loss.gain), r2 = r * r, zero(0.0);
  if (loss.shape == LossShape::square) return {gain * r2, gain};
  if (loss.shape == LossShape::huber) {
    const Pack a = magnitude(r), inside = at_most(a, c);
    return {gain * inside * (a + a - inside), gain * at_most(one, c / a)};
  }
  const Pack t = at_least(zero, one - r2 / (c * c));
  return {gain * c * c * Pack(1.0 / 3.0) * (one - t * t * t), gain * t * t};
}

constexpr int tile = 4;   // columns of a square of sums
constexpr int chunk = 8;  // packs of rows that fit the first-level cache
/// Two cameras, a pose of 6, the residual; padded.
constexpr int max_columns =
    (2 * (core_parameter_count + max_distortion_count) + 7 + tile - 1) / tile * tile;

/// Adds the products of columns i … i + 3 by j … j + 3 over `n` packs of rows.
HWY_INLINE void add_tile(
    const Pack* rows, const Pack* weighted, int stride, int n, int i, int j, double* sums) {
  constexpr int height = HWY_TARGET == HWY_AVX3 ? 4 : 2;
  for (int h = 0; h < tile; h += height) {
    Pack sum[height * tile];
    for (int e = 0; e < height * tile; ++e) sum[e] = load(sums + (h * tile + e) * kernel_lanes);
    for (int k = 0; k < n; ++k) {
      const Pack* a = weighted + k * stride + i + h;
      const Pack* b = rows + k * stride + j;
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < tile; ++x) sum[y * tile + x] = mul_add(a[y], b[x], sum[y * tile + x]);
      }
    }
    for (int e = 0; e < height * tile; ++e) store(sum[e], sums + (h * tile + e) * kernel_lanes);
  }
}

double sum_pairs(const EpipolarView& view,
                 const Lanes* packed,
                 std::size_t eights,
                 const Loss& loss,
                 double* sums) {
  const Geometry geometry(view);
  const int columns = epipolar_columns(view), stride = (columns + tile - 1) / tile * tile;
  const int tiles = stride / tile;
  Pack rows[chunk * max_columns], weighted[chunk * max_columns];
  for (Pack& p : rows) p = Pack(0.0);
  for (Pack& p : weighted) p = Pack(0.0);
  constexpr int tile_size = tile * tile * kernel_lanes;
  std::vector<double> by_lane(static_cast<std::size_t>(tiles * (tiles + 1) / 2 * tile_size), 0.0);
  Lanes cost;
  for (int lane = 0; lane < kernel_lanes; lane += pack_lanes) {
    Pack total(0.0);
    for (std::size_t first = 0; first < eights; first += chunk) {
      const int n = static_cast<int>(std::min<std::size_t>(chunk, eights - first));
      for (int k = 0; k < n; ++k) {
        Pack* const row = rows + k * stride;
        const Pack r = geometry.row(
            packed + (first + static_cast<std::size_t>(k)) * packed_pair_lanes, lane, row);
        const PackLoss of = loss_of(loss, r);
        total = total + of.cost;
        for (int i = 0; i < columns; ++i) weighted[k * stride + i] = of.weight * row[i];
      }
      double* at = by_lane.data() + lane;
      for (int i = 0; i < tiles; ++i) {
        for (int j = i; j < tiles; ++j, at += tile_size) {
          add_tile(rows, weighted, stride, n, i * tile, j * tile, at);
        }
      }
    }
    store(total, cost.of + lane);
  }
  const double* at = by_lane.data();
  for (int i = 0; i < tiles; ++i) {
    for (int j = i; j < tiles; ++j) {
      for (int e = 0; e < tile * tile; ++e, at += kernel_lanes) {
        const int row = i * tile + e / tile, column = j * tile + e % tile;
        if (row > column || column >= columns) continue;
        double sum = 0;
        for (int l = 0; l < kernel_lanes; ++l) sum += at[l];
        sums[packed_index(row, column, columns)] += sum;
      }
    }
  }
  double total = 0;
  for (const double c : cost.of) total += c;
  return total;
}

void pair_residuals(const EpipolarView& view,
                    const Lanes* packed,
                    std::size_t eights,
                    double* residuals) {
  const Geometry geometry(view);
  for (std::size_t e = 0; e < eights; ++e) {
    for (int lane = 0; lane < kernel_lanes; lane += pack_lanes) {
      store(geometry.residual(packed + e * packed_pair_lanes, lane),
            residuals + e * kernel_lanes + lane);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::internal {

HWY_EXPORT(sum_pairs);
HWY_EXPORT(pair_residuals);

EpipolarView::EpipolarView(const Rig& rig) : k{} {
  for (int c = 0; c < 2; ++c) {
    const Camera& camera = rig.cameras[static_cast<std::size_t>(c)];
    models[c] = camera.model;
    f_px[c] = camera.f_px();
    ax[c] = camera.ax();
    ox_px[c] = camera.ox_px();
    oy_px[c] = camera.oy_px();
    const auto n = camera.parameters.size() - core_parameter_count;
    for (Eigen::Index i = 0; i < n; ++i) k[c][i] = camera.parameters[core_parameter_count + i];
  }
  const Pose& T = rig.T_camera_first[1];
  for (int i = 0; i < 9; ++i) R[i] = T.R(i / 3, i % 3);
  for (int i = 0; i < 3; ++i) t[i] = T.t[i];
}

double sum_pairs(const EpipolarView& view,
                 const Lanes* packed,
                 std::size_t eights,
                 const Loss& loss,
                 double* sums) {
  return HWY_DYNAMIC_DISPATCH(sum_pairs)(view, packed, eights, loss, sums);
}

void pair_residuals(const EpipolarView& view,
                    const Lanes* packed,
                    std::size_t eights,
                    double* residuals) {
  HWY_DYNAMIC_DISPATCH(pair_residuals)(view, packed, eights, residuals);
}

}  // namespace vernier::internal
#endif  // HWY_ONCE
