// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/image_lines.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localise/verification/image_line_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/place/view_camera.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::localise::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::ScalableTag<float>;
using V = hn::Vec<Tag>;

/// A part of a line, from t0 to t1 of it, cut by half planes.
struct Part {
  V t0, t1;
  hn::Mask<Tag> gone;

  /// Keeps where g >= 0, which is linear from g0 at t = 0 to g1 at t = 1.
  void cut(Tag d, V g0, V g1) {
    const V zero = hn::Zero(d);
    const auto out0 = hn::Lt(g0, zero), out1 = hn::Lt(g1, zero);
    gone = hn::Or(gone, hn::And(out0, out1));
    const V at = hn::Div(g0, hn::Sub(g0, g1));  // used where one end is out only
    t0 = hn::IfThenElse(out0, hn::Max(t0, at), t0);
    t1 = hn::IfThenElse(out1, hn::Min(t1, at), t1);
  }
};

/// Lanes that are kept, in front of a vector. (Highway's Compress is slow with GCC, which copies
/// its tables for each call.)
struct KeptLanes {
  decltype(hn::SetTableIndices(Tag(), static_cast<const std::int32_t*>(nullptr))) indices;
  int count = 0;

  KeptLanes(Tag d, hn::Mask<Tag> kept) {
    static_assert(hn::MaxLanes(Tag()) <= 16, "the masks are read as two bytes, rows padded to 16");
    alignas(64) std::int32_t lanes[hn::MaxLanes(Tag())] = {};
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, kept, bytes);
    for (unsigned bits = bytes[0] | bytes[1] << 8; bits != 0; bits &= bits - 1) {
      lanes[count++] = std::countr_zero(bits);
    }
    indices = hn::SetTableIndices(d, lanes);
  }

  /// The others follow in no order.
  V in_front(V column) const { return hn::TableLookupLanes(column, indices); }
};

/// a + t (b - a).
V between(V a, V b, V t) { return hn::MulAdd(t, hn::Sub(b, a), a); }

void predict(const SpaceLines& lines,
             float x_m,
             float y_m,
             float cosine,
             float sine,
             const ViewCamera& camera,
             PredictedLines& predicted) {
  constexpr float steep_most = 0.5f, flat_least = 0.25f;  // of |dx|
  constexpr float steep_query = steep_below;              // where the same line of a query goes
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto set = [&](float x) { return hn::Set(d, x); };
  const V zero = hn::Zero(d), one = set(1), c = set(cosine), s = set(sine), x0 = set(x_m),
          y0 = set(y_m), h = set(camera.height_m), cp = set(camera.cos_pitch),
          sp = set(camera.sin_pitch), f = set(camera.f_px),
          eye_u = set(camera.f_px * camera.eye_m.x()), eye_v = set(camera.f_px * camera.eye_m.y()),
          eye_left = set(camera.of_right_px.min().x()),
          eye_right = set(camera.of_right_px.max().x()),
          eye_top = set(camera.of_right_px.min().y()),
          eye_bottom = set(camera.of_right_px.max().y()), left = set(camera.left_px),
          right = set(camera.right_px), top = set(camera.top_px), bottom = set(camera.bottom_px),
          near = set(nearest_compared_m);
  const ViewCamera::Borders cuts = camera.cuts;
  int steep = 0, flat = 0;
  for (int i = 0; i < static_cast<int>(lines.size); i += lanes) {
    // Camera coordinates of an end: x right, y down, z forward.
    const auto seen = [&](const float* px, const float* py, const float* pz, V& x, V& y, V& z) {
      const V wx = hn::Sub(hn::LoadU(d, px + i), x0), wy = hn::Sub(hn::LoadU(d, py + i), y0);
      const V up = hn::Sub(hn::LoadU(d, pz + i), h);
      const V forward = hn::MulAdd(c, wx, hn::Mul(s, wy));
      x = hn::NegMulAdd(c, wy, hn::Mul(s, wx));
      z = hn::NegMulAdd(sp, up, hn::Mul(cp, forward));
      y = hn::Neg(hn::MulAdd(sp, forward, hn::Mul(cp, up)));
    };
    V xa, ya, za, xb, yb, zb;
    seen(lines.ax.data(), lines.ay.data(), lines.az.data(), xa, ya, za);
    seen(lines.bx.data(), lines.by.data(), lines.bz.data(), xb, yb, zb);
    Part part{zero, one, hn::Lt(one, zero)};
    part.cut(d, hn::Sub(za, near), hn::Sub(zb, near));
    if (hn::AllTrue(d, part.gone)) continue;
    const auto image = [&](V t, V& u, V& v, V& w) {
      w = hn::Div(one, hn::Max(between(za, zb, t), set(0.5f * nearest_compared_m)));
      u = hn::Mul(hn::Mul(f, between(xa, xb, t)), w);
      v = hn::Mul(hn::Mul(f, between(ya, yb, t)), w);
    };
    V ua, va, wa, ub, vb, wb;
    image(part.t0, ua, va, wa);
    image(part.t1, ub, vb, wb);
    part.t0 = zero;
    part.t1 = one;
    part.cut(d, hn::Sub(right, ua), hn::Sub(right, ub));
    part.cut(d, hn::Sub(va, top), hn::Sub(vb, top));
    part.cut(d, hn::Sub(bottom, va), hn::Sub(bottom, vb));
    if (cuts.own_left) part.cut(d, hn::Sub(ua, left), hn::Sub(ub, left));
    // The right eye sees it displaced against the baseline.
    if (cuts.left || cuts.right) {
      const V uc = hn::NegMulAdd(eye_u, wa, ua), ud = hn::NegMulAdd(eye_u, wb, ub);
      if (cuts.left) part.cut(d, hn::Sub(uc, eye_left), hn::Sub(ud, eye_left));
      if (cuts.right) part.cut(d, hn::Sub(eye_right, uc), hn::Sub(eye_right, ud));
    }
    if (cuts.top || cuts.bottom) {
      const V vc = hn::NegMulAdd(eye_v, wa, va), vd = hn::NegMulAdd(eye_v, wb, vb);
      if (cuts.top) part.cut(d, hn::Sub(vc, eye_top), hn::Sub(vd, eye_top));
      if (cuts.bottom) part.cut(d, hn::Sub(eye_bottom, vc), hn::Sub(eye_bottom, vd));
    }
    const V u = between(ua, ub, part.t0), v = between(va, vb, part.t0),
            w = between(wa, wb, part.t0);
    const V du = hn::Sub(between(ua, ub, part.t1), u), dv = hn::Sub(between(va, vb, part.t1), v);
    const V dw = hn::Sub(between(wa, wb, part.t1), w);
    const V length = hn::Sqrt(hn::MulAdd(du, du, hn::Mul(dv, dv)));
    const auto kept = hn::AndNot(
        part.gone, hn::And(hn::Gt(part.t1, part.t0), hn::Ge(length, set(shortest_compared_px))));
    if (hn::AllFalse(d, kept)) continue;
    const V per_length = hn::Div(one, hn::Max(length, set(1e-6f)));
    const V dx = hn::Mul(du, per_length), dy = hn::Mul(dv, per_length);
    const V sigma = hn::LoadU(d, lines.sigma_m.data() + i);
    const V counted = hn::LoadU(d, lines.counted.data() + i);
    const auto is_steep = hn::Lt(hn::Abs(dx), set(steep_most));
    const auto seen_as_steep = hn::Lt(hn::Abs(dx), set(steep_query));
    const auto store = [&](ImageLines& out, int& size, hn::Mask<Tag> which, V counts) {
      const KeptLanes chosen(d, which);
      const auto put = [&](V column, std::vector<float>& to) {
        hn::StoreU(chosen.in_front(column), d, to.data() + size);
      };
      put(u, out.u);
      put(v, out.v);
      put(w, out.w);
      put(dw, out.dw);
      put(dx, out.dx);
      put(dy, out.dy);
      put(per_length, out.per_length);
      put(hn::Mul(sigma, sigma), out.variance_m2);
      put(counts, out.counted);
      put(length, out.length_px);
      size += chosen.count;
    };
    store(predicted.steep, steep, hn::And(kept, is_steep),
          hn::IfThenElseZero(seen_as_steep, counted));
    store(predicted.flat, flat, hn::And(kept, hn::Gt(hn::Abs(dx), set(flat_least))),
          hn::IfThenElseZero(hn::Not(seen_as_steep), counted));
  }
  predicted.steep.size = steep;
  predicted.flat.size = flat;
}

LineMatch best_match(const QueryLine& query,
                     ImageLines& lines,
                     const ViewCamera& camera,
                     const LineTolerance& tolerance) {
  // Beyond these a line is another one; a line within agreeing_energy covers what it agrees with.
  constexpr float furthest_px = 60, most_sine = 0.25f, gap_px = 8, most_energy = 26,
                  most_offset_energy = 20, agreeing_energy = 9.2f;
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto set = [&](float x) { return hn::Set(d, x); };
  const float half = 0.5f * query.length_px, fB = camera.disparity_px_m();
  const V zero = hn::Zero(d), one = set(1), least_along = set(-half - gap_px),
          beyond = set(half + gap_px);
  V least = set(most_energy), which = set(-1), index = hn::Iota(d, 0);
  for (int i = 0; i < lines.size;
       i += lanes, index = hn::Add(index, set(static_cast<float>(lanes)))) {
    const V dx = hn::LoadU(d, lines.dx.data() + i), dy = hn::LoadU(d, lines.dy.data() + i);
    const V ru = hn::Sub(set(query.u), hn::LoadU(d, lines.u.data() + i));
    const V rv = hn::Sub(set(query.v), hn::LoadU(d, lines.v.data() + i));
    const V length = hn::LoadU(d, lines.length_px.data() + i);
    const V offset = hn::NegMulAdd(ru, dy, hn::Mul(rv, dx));
    const V along = hn::MulAdd(ru, dx, hn::Mul(rv, dy));
    const V sine = hn::Abs(hn::NegMulAdd(set(query.dy), dx, hn::Mul(set(query.dx), dy)));
    const auto near =
        hn::And(hn::And(hn::Lt(hn::Abs(offset), set(furthest_px)), hn::Lt(sine, set(most_sine))),
                hn::And(hn::Gt(along, least_along), hn::Lt(along, hn::Add(length, beyond))));
    if (hn::AllFalse(d, near)) continue;
    const V t =
        hn::Min(hn::Max(hn::Mul(along, hn::LoadU(d, lines.per_length.data() + i)), zero), one);
    const V w = hn::MulAdd(t, hn::LoadU(d, lines.dw.data() + i), hn::LoadU(d, lines.w.data() + i));
    const V position = hn::Mul(set(camera.f_px * tolerance.offset_m), w);
    const V offset_variance =
        hn::MulAdd(position, position, set(tolerance.offset_px * tolerance.offset_px));
    const V squared = hn::Div(hn::Mul(offset, offset), offset_variance);
    const V offset_energy = hn::Mul(squared, squared);
    const V angle_sigma =
        hn::Add(set(tolerance.angle_rad),
                hn::Div(set(tolerance.angle_px), hn::Min(set(query.length_px), length)));
    const V angle = hn::Div(sine, angle_sigma);
    const V bw = hn::Mul(set(fB), w), disparity = hn::Mul(set(fB), hn::Sub(w, set(query.w)));
    const V share = hn::Mul(set(tolerance.disparity_share), bw), range = hn::Mul(bw, w);
    const V line_variance = hn::Mul(
        set(0.5f), hn::Add(set(query.variance_m2), hn::LoadU(d, lines.variance_m2.data() + i)));
    const V disparity_variance =
        hn::MulAdd(hn::Mul(range, range), line_variance,
                   hn::MulAdd(share, share, set(tolerance.disparity_px * tolerance.disparity_px)));
    const V disparity_energy = hn::Min(hn::Div(hn::Mul(disparity, disparity), disparity_variance),
                                       set(tolerance.most_disparity_energy));
    const V energy = hn::IfThenElse(
        hn::And(near, hn::Lt(offset_energy, set(most_offset_energy))),
        hn::Add(hn::MulAdd(angle, angle, offset_energy), disparity_energy), set(1e9f));
    const auto better = hn::Lt(energy, least);
    least = hn::Min(least, energy);
    which = hn::IfThenElse(better, index, which);
    const auto agrees = hn::Lt(energy, set(agreeing_energy));
    if (!hn::AllFalse(d, agrees)) {
      const V covered = hn::Sub(hn::Min(length, hn::Add(along, set(half))),
                                hn::Max(zero, hn::Sub(along, set(half))));
      float* sum = lines.covered_px.data() + i;
      hn::StoreU(hn::Add(hn::LoadU(d, sum), hn::IfThenElseZero(agrees, hn::Max(covered, zero))), d,
                 sum);
    }
  }
  HWY_ALIGN float energies[HWY_MAX_BYTES / sizeof(float)];
  HWY_ALIGN float indices[HWY_MAX_BYTES / sizeof(float)];
  hn::Store(least, d, energies);
  hn::Store(which, d, indices);
  LineMatch best{most_energy, -1};
  for (int k = 0; k < lanes; ++k) {
    const int line = static_cast<int>(indices[k]);
    if (line < 0) continue;
    if (energies[k] < best.energy || (energies[k] == best.energy && line < best.line)) {
      best = {energies[k], line};
    }
  }
  return best;
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::localise::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::localise::internal {

HWY_EXPORT(predict);
HWY_EXPORT(best_match);

void predict(const SpaceLines& lines,
             const Pose2D& pose,
             const ViewCamera& camera,
             PredictedLines& predicted) {
  for (ImageLines* set : {&predicted.steep, &predicted.flat}) set->make_room(lines.size);
  HWY_DYNAMIC_DISPATCH(predict)
  (lines, static_cast<float>(pose.x_m), static_cast<float>(pose.y_m),
   static_cast<float>(std::cos(pose.heading_rad)), static_cast<float>(std::sin(pose.heading_rad)),
   camera, predicted);
  for (ImageLines* set : {&predicted.steep, &predicted.flat}) set->end();
}

LineMatch best_match(const QueryLine& query,
                     ImageLines& lines,
                     const ViewCamera& camera,
                     const LineTolerance& tolerance) {
  return HWY_DYNAMIC_DISPATCH(best_match)(query, lines, camera, tolerance);
}

}  // namespace vernier::localise::internal
#endif
