// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/frame_kernel.h"

#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/solver/pose_factor.h"
#include "calib/solver/view_kernel.h"

// As in view_kernel.cpp.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calib/solver/frame_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vernier::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "calib/solver/pack.inc"

HWY_INLINE Pack get(const Lanes& from, int lane) { return load(from.of + lane); }
HWY_INLINE void set(Lanes& to, int lane, Pack a) { store(a, to.of + lane); }
HWY_INLINE void add(Lanes& to, int lane, Pack a) { store(load(to.of + lane) + a, to.of + lane); }

/// row Ad: converts a row of derivatives by the camera's twist to one by the board's.
HWY_INLINE void times_adjoint(const CameraTransform& place, const Pack (&in)[6], Pack (&out)[6]) {
  if (place.pose < 0) {  // the identity
    for (int k = 0; k < 6; ++k) out[k] = in[k];
    return;
  }
  for (int j = 0; j < 3; ++j) {
    Pack w(0.0), v(0.0);
    for (int i = 0; i < 3; ++i) {
      w = mul_add(in[i], Pack(place.R[3 * i + j]), w);
      w = mul_add(in[3 + i], Pack(place.tR[3 * i + j]), w);
      v = mul_add(in[3 + i], Pack(place.R[3 * i + j]), v);
    }
    out[j] = w;
    out[3 + j] = v;
  }
}

/// The sums of one frame and lane pack during assembly.
struct Frame {
  Pack C[6][6];  // upper triangle of BᵀB
  Pack b[6];     // Bᵀr
  Lanes* Z;      // rows of AᵀB, then of Z
};

/// Adds camera `place`: its own blocks to the total, those of the board's pose to the frame.
void add_camera(const CameraTransform& place,
                const double* sums,
                int parameters,
                int lane,
                Frame& frame,
                ReducedSums& total) {
  const int n = place.count, residual = n + (place.warp < 0 ? 6 : 8), columns = residual + 1;
  const auto sum = [&](int i, int j) HWY_ATTR {
    return load(sums + packed_index(i < j ? i : j, i < j ? j : i, columns) * kernel_lanes + lane);
  };
  const auto index = [&](int i) {  // of a column among all parameters, -1 for none
    if (i < n) return place.intrinsics + i;
    if (i < n + 6) return place.pose < 0 ? -1 : place.pose + i - n;
    return place.warp + i - n - 6;
  };
  for (int i = 0; i < residual; ++i) {
    if (index(i) < 0) continue;
    for (int j = i; j < residual; ++j) {
      if (index(j) < 0) continue;
      add(total.information[packed_index(index(i), index(j), parameters)], lane, sum(i, j));
    }
    add(total.diagonal[index(i)], lane, sum(i, i));
    add(total.gradient[index(i)], lane, sum(i, residual));
  }
  add(total.chi2, lane, sum(residual, residual));

  for (int i = 0; i < residual; ++i) {
    Pack by_twist[6], row[6];
    for (int k = 0; k < 6; ++k) by_twist[k] = sum(i, n + k);
    times_adjoint(place, by_twist, row);
    if (index(i) >= 0) {
      Lanes* to = frame.Z + 6 * index(i);  // the warp's row gathers all cameras
      for (int k = 0; k < 6; ++k) add(to[k], lane, row[k]);
    }
    if (i < n || i >= n + 6) continue;
    // A row of C Ad: Adᵀ from the left gathers these.
    Pack unit[6], weight[6];
    for (int k = 0; k < 6; ++k) unit[k] = Pack(k == i - n ? 1.0 : 0.0);
    times_adjoint(place, unit, weight);
    const Pack r = sum(i, residual);
    for (int a = 0; a < 6; ++a) {
      for (int c = a; c < 6; ++c) frame.C[a][c] = mul_add(weight[a], row[c], frame.C[a][c]);
      frame.b[a] = mul_add(weight[a], r, frame.b[a]);
    }
  }
}

/// C = L Lᵀ, then y and Z, all written to the factor.
void factor_frame(Frame& frame, int parameters, int lane, Lanes* factor) {
  Pack L[6][6];
  for (int j = 0; j < 6; ++j) {
    for (int i = j; i < 6; ++i) {
      Pack s = frame.C[j][i];
      for (int k = 0; k < j; ++k) s = minus_mul(L[i][k], L[j][k], s);
      L[i][j] = i == j ? inverse_root_or_nan(s, frame.C[j][j] * Pack(min_pose_pivot)) : s * L[j][j];
    }
  }
  const auto forward = [&](Pack(&x)[6]) HWY_ATTR {
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < i; ++k) x[i] = minus_mul(L[i][k], x[k], x[i]);
      x[i] = x[i] * L[i][i];
    }
  };
  for (int i = 0, at = 0; i < 6; ++i) {
    for (int k = 0; k <= i; ++k) set(factor[at++], lane, L[i][k]);
  }
  forward(frame.b);
  for (int k = 0; k < 6; ++k) set(factor[21 + k], lane, frame.b[k]);
  for (int i = 0; i < parameters; ++i) {
    Pack z[6];
    for (int k = 0; k < 6; ++k) z[k] = get(frame.Z[6 * i + k], lane);
    forward(z);
    for (int k = 0; k < 6; ++k) set(frame.Z[6 * i + k], lane, z[k]);
  }
}

void subtract_frame(const Frame& frame, int parameters, int lane, ReducedSums& total) {
  for (int i = 0; i < parameters; ++i) {
    Pack z[6];
    for (int k = 0; k < 6; ++k) z[k] = get(frame.Z[6 * i + k], lane);
    Lanes* row = &total.information[packed_index(i, i, parameters)];
    for (int j = i; j < parameters; ++j, ++row) {
      Pack s = get(*row, lane);
      for (int k = 0; k < 6; ++k) s = minus_mul(z[k], get(frame.Z[6 * j + k], lane), s);
      set(*row, lane, s);
    }
    Pack g = get(total.gradient[i], lane);
    for (int k = 0; k < 6; ++k) g = minus_mul(z[k], frame.b[k], g);
    set(total.gradient[i], lane, g);
  }
  Pack drop = get(total.frames_drop, lane);
  for (int k = 0; k < 6; ++k) drop = mul_add(frame.b[k], frame.b[k], drop);
  set(total.frames_drop, lane, drop);
}

void eliminate_frames(const std::vector<CameraTransform>& places,
                      const std::vector<const double*>& sums,
                      const Lanes& absent,
                      double damping,
                      Lanes* factor,
                      ReducedSums& total) {
  const int parameters = static_cast<int>(total.gradient.size());
  for (int lane = 0; lane < kernel_lanes; lane += pack_lanes) {
    Frame frame;
    for (int a = 0; a < 6; ++a) {
      for (int c = 0; c < 6; ++c) frame.C[a][c] = Pack(0.0);
      frame.b[a] = Pack(0.0);
    }
    frame.Z = factor + 27;
    for (int i = 0; i < 6 * parameters; ++i) set(frame.Z[i], lane, Pack(0.0));
    for (std::size_t c = 0; c < places.size(); ++c) {
      if (sums[c]) add_camera(places[c], sums[c], parameters, lane, frame, total);
    }
    for (int a = 0; a < 6; ++a) {
      frame.C[a][a] = frame.C[a][a] * Pack(1 + damping) + get(absent, lane);
    }
    factor_frame(frame, parameters, lane, factor);
    subtract_frame(frame, parameters, lane, total);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::internal {

HWY_EXPORT(eliminate_frames);

void eliminate_frames(const std::vector<CameraTransform>& places,
                      const std::vector<const double*>& sums,
                      const Lanes& absent,
                      double damping,
                      Lanes* factor,
                      ReducedSums& total) {
  HWY_DYNAMIC_DISPATCH(eliminate_frames)(places, sums, absent, damping, factor, total);
}

std::vector<CameraTransform> camera_transforms(const Rig& rig, bool warp) {
  std::vector<CameraTransform> places(rig.cameras.size());
  for (std::size_t c = 0; c < places.size(); ++c) {
    const int camera = static_cast<int>(c);
    CameraTransform& place = places[c];
    place.intrinsics = intrinsics_index(rig, camera);
    place.count = static_cast<int>(rig.cameras[c].parameters.size());
    if (warp) place.warp = parameter_count(rig);
    if (c == 0) continue;
    place.pose = pose_index(rig, camera);
    using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const Pose& T = rig.T_camera_first[c];
    Eigen::Map<RowMajor3>(place.R) = T.R;
    Eigen::Map<RowMajor3>(place.tR) = hat(T.t) * T.R;
  }
  return places;
}

void frame_steps(const Lanes* factor, const Eigen::VectorXd& step, Lanes (&twists)[6]) {
  const auto add = [](const Lanes& a, const Lanes& b, Lanes& sum) {
    for (int l = 0; l < kernel_lanes; ++l) sum.of[l] += a.of[l] * b.of[l];
  };
  for (int k = 0; k < 6; ++k) {
    Lanes sum = factor[21 + k];
    for (Eigen::Index i = 0; i < step.size(); ++i) {
      const Lanes& z = factor[27 + 6 * i + k];
      for (int l = 0; l < kernel_lanes; ++l) sum.of[l] += z.of[l] * step[i];
    }
    for (int l = 0; l < kernel_lanes; ++l) twists[k].of[l] = -sum.of[l];
  }
  const auto L = [&](int i, int k) -> const Lanes& { return factor[i * (i + 1) / 2 + k]; };
  for (int i = 5; i >= 0; --i) {
    Lanes sum;
    for (int k = i + 1; k < 6; ++k) add(L(k, i), twists[k], sum);
    for (int l = 0; l < kernel_lanes; ++l) {
      twists[i].of[l] = (twists[i].of[l] - sum.of[l]) * L(i, i).of[l];
    }
  }
}

}  // namespace vernier::internal
#endif
