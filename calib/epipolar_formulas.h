// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// The Sampson residual of a matched pair of pixels and its gradient, written once on a `Scalar`. No
// include guard: included inside the namespace of an instruction set, after corner_formulas.h, the
// Scalar's operators, dual_number.h and, for the Scalar, inverse_root_or_nan, inverse_root_or_zero
// and all_below(a, limit).
//
// With X the undistorted normalised point of a pixel y, (R, t) the right camera's pose in x_right =
// R x_left + t, and B = dX/dy,
//
//     e = X_rᵀ [t]x R X_l,   g_c = B_cᵀ de/dX_c,   V = |g_l|² + |g_r|²,   r = e / (σ √V)
//
// V is the variance of e for a noise of one pixel; it is differentiated too,
//
//     dr = (de − ρ dV/2) / (σ √V),   ρ = e / V
//
// which needs the second derivatives of the distortion, in two directions only: with A = d distort
// / dX (symmetric in every model here), w = A⁻¹ de/dX and b = B g,
//
//     (de/dX)ᵀ dB g = −wᵀ dA b + wᵀ dS g,   B = A⁻¹ S,   S = diag(1 / f ax, 1 / f)
//
// Sampson 1982; Luong and Faugeras 1996; the residual and its parameters are those of Tina Memo
// 2017-001 (Thacker and Mayhew 1991) on distorted pixels.

/// The intrinsics of one camera.
template <class Scalar>
struct CameraConstants {
  double f, ax, ox, oy;
  Scalar k[9];
};

/// One camera's pixel: where its ray goes, and how the constraint depends on it.
template <class Scalar>
struct Sight {
  Scalar xd, yd;      // distorted normalised coordinates
  Scalar x, y;        // undistorted ones
  Scalar xx, xy, yy;  // of A⁻¹
  Scalar l[2];        // de/dX
  Scalar g[2], b[2];  // as above
  Scalar c[2];        // b_otherᵀ d(de/dX_other)/dX
};

/// Undistorts a pixel by Newton's method. Where it does not converge, or beyond the fold of the
/// model, the result is not a number.
template <class Model, class Scalar>
inline void look_at(
    Model model, const CameraConstants<Scalar>& c, Scalar u, Scalar v, Sight<Scalar>& s) {
  s.xd = (u - Scalar(c.ox)) * Scalar(1 / (c.f * c.ax));
  s.yd = (v - Scalar(c.oy)) * Scalar(1 / c.f);
  s.x = s.xd;
  s.y = s.yd;
  Scalar det(1.0), step2(0.0);
  for (int round = 0; round < 25; ++round) {
    const auto d = distorted(model, s.x, s.y, c.k);
    const Scalar ex = d.x - s.xd, ey = d.y - s.yd;
    det = minus_mul(d.x_by_y, d.x_by_y, d.x_by_x * d.y_by_y);
    const Scalar inverse = Scalar(1.0) / det;
    s.xx = d.y_by_y * inverse;
    s.xy = Scalar(0.0) - d.x_by_y * inverse;
    s.yy = d.x_by_x * inverse;
    const Scalar dx = mul_add(s.xx, ex, s.xy * ey), dy = mul_add(s.xy, ex, s.yy * ey);
    step2 = mul_add(dx, dx, dy * dy);
    if (all_below(step2, 1e-28)) break;
    s.x = s.x - dx;
    s.y = s.y - dy;
  }
  const Scalar sound = inverse_root_or_nan(Scalar(1e-20) - step2, Scalar(0.0)) *
                       inverse_root_or_nan(det, Scalar(0.0));
  s.x = mul_add(sound, Scalar(0.0), s.x);
}

/// g and b of a camera from its l.
template <class Scalar>
inline void weigh(const CameraConstants<Scalar>& c, Sight<Scalar>& s) {
  const Scalar sx(1 / (c.f * c.ax)), sy(1 / c.f);
  s.g[0] = sx * mul_add(s.xx, s.l[0], s.xy * s.l[1]);
  s.g[1] = sy * mul_add(s.xy, s.l[0], s.yy * s.l[1]);
  const Scalar gx = sx * s.g[0], gy = sy * s.g[1];
  s.b[0] = mul_add(s.xx, gx, s.xy * gy);
  s.b[1] = mul_add(s.xy, gx, s.yy * gy);
}

/// The part of a pair's row that belongs to one camera's intrinsics, columns f ax ox oy k1 …, times
/// `scale` = 1 / (σ √V).
template <class Model, class Scalar>
inline void camera_columns(Model model,
                           const CameraConstants<Scalar>& c,
                           const Sight<Scalar>& s,
                           Scalar rho,
                           Scalar scale,
                           Scalar* row) {
  constexpr int n = static_cast<int>(Model::distortion_names.size());
  using Along = Dual<Scalar>;
  Along k[n + 1];
  for (int i = 0; i < n; ++i) k[i] = Along(c.k[i], Scalar(0.0));
  const auto d = distorted(model, Along(s.x, s.b[0]), Along(s.y, s.b[1]), k);
  const Scalar w0 = s.g[0] * Scalar(c.f * c.ax), w1 = s.g[1] * Scalar(c.f);
  const Scalar h0 = mul_add(w0, d.x_by_x.d, w1 * d.x_by_y.d);  // wᵀ dA/dX b
  const Scalar h1 = mul_add(w0, d.x_by_y.d, w1 * d.y_by_y.d);
  const Scalar G0 = mul_add(rho, h0 - s.c[0], s.l[0]), G1 = mul_add(rho, h1 - s.c[1], s.l[1]);
  const Scalar z0 = scale * mul_add(s.xx, G0, s.xy * G1);  // A⁻¹ d/dX
  const Scalar z1 = scale * mul_add(s.xy, G0, s.yy * G1);
  const Scalar bend = rho * scale, zero(0.0);
  const Scalar gx2 = bend * s.g[0] * s.g[0], gy2 = bend * s.g[1] * s.g[1];
  const Scalar x_part = minus_mul(z0, s.xd, gx2), y_part = minus_mul(z1, s.yd, gy2);
  row[0] = (x_part + y_part) * Scalar(1 / c.f);
  row[1] = x_part * Scalar(1 / c.ax);
  row[2] = zero - z0 * Scalar(1 / (c.f * c.ax));
  row[3] = zero - z1 * Scalar(1 / c.f);
  for (int i = 0; i < n; ++i) {
    const Scalar by_k = mul_add(w0, d.x_by_k[i].d, w1 * d.y_by_k[i].d);  // wᵀ dA/dk b
    row[4 + i] = minus_mul(z0, d.x_by_k[i].v, minus_mul(z1, d.y_by_k[i].v, bend * by_k));
  }
}

template <class Scalar>
struct Vector {
  Scalar x, y, z;
};
template <class Scalar>
inline Vector<Scalar> cross(const Vector<Scalar>& a, const Vector<Scalar>& b) {
  return {minus_mul(a.z, b.y, a.y * b.z), minus_mul(a.x, b.z, a.z * b.x),
          minus_mul(a.y, b.x, a.x * b.y)};
}
template <class Scalar>
inline Scalar dot(const Vector<Scalar>& a, const Vector<Scalar>& b) {
  return mul_add(a.x, b.x, mul_add(a.y, b.y, a.z * b.z));
}

/// T_right_left.
template <class Scalar>
struct PairPose {
  Scalar R[9];  // row by row
  Vector<Scalar> t;
};
template <class Scalar>
inline Vector<Scalar> turned(const PairPose<Scalar>& T, const Vector<Scalar>& v) {
  return {dot({T.R[0], T.R[1], T.R[2]}, v), dot({T.R[3], T.R[4], T.R[5]}, v),
          dot({T.R[6], T.R[7], T.R[8]}, v)};
}
template <class Scalar>
inline Vector<Scalar> turned_back(const PairPose<Scalar>& T, const Vector<Scalar>& v) {
  return {dot({T.R[0], T.R[3], T.R[6]}, v), dot({T.R[1], T.R[4], T.R[7]}, v),
          dot({T.R[2], T.R[5], T.R[8]}, v)};
}

/// What both cameras share of a pair.
template <class Scalar>
struct PairTerms {
  Scalar residual, rho, scale;
};

/// The residual, from the two rays; fills what camera_columns() needs and the six columns of the
/// pose's left tangent (rotation, translation) of the row.
template <class Scalar>
inline PairTerms<Scalar> pair_terms(const PairPose<Scalar>& T,
                                    const CameraConstants<Scalar>& left,
                                    const CameraConstants<Scalar>& right,
                                    Scalar weight,
                                    Sight<Scalar>& l,
                                    Sight<Scalar>& r,
                                    Scalar* pose_columns) {
  const Scalar one(1.0), zero(0.0);
  const Vector<Scalar> Xr{r.x, r.y, one};
  const Vector<Scalar> q = turned(T, {l.x, l.y, one});  // R X_l
  const Vector<Scalar> Er = cross(T.t, q);              // E X_l
  const Vector<Scalar> m = cross(Xr, T.t);
  const Vector<Scalar> El = turned_back(T, m);  // Eᵀ X_r
  const Scalar e = dot(Xr, Er);
  l.l[0] = El.x;
  l.l[1] = El.y;
  r.l[0] = Er.x;
  r.l[1] = Er.y;
  weigh(left, l);
  weigh(right, r);
  const Scalar V =
      mul_add(l.g[0], l.g[0], mul_add(l.g[1], l.g[1], mul_add(r.g[0], r.g[0], r.g[1] * r.g[1])));
  const Scalar inverse_root = inverse_root_or_zero(V, Scalar(1e-300));
  const Vector<Scalar> bl = turned(T, {l.b[0], l.b[1], zero}), br{r.b[0], r.b[1], zero};
  const Vector<Scalar> brt = cross(br, T.t), cl = turned_back(T, brt), cr = cross(T.t, bl);
  l.c[0] = cl.x;
  l.c[1] = cl.y;
  r.c[0] = cr.x;
  r.c[1] = cr.y;
  PairTerms<Scalar> terms;
  terms.scale = weight * inverse_root;
  terms.residual = e * terms.scale;
  terms.rho = e * inverse_root * inverse_root;
  const Vector<Scalar> e_by_w = cross(q, m), e_by_t = cross(q, Xr);
  const Vector<Scalar> left_w = cross(bl, m), left_t = cross(bl, Xr);
  const Vector<Scalar> right_w = cross(q, brt), right_t = cross(q, br);
  const auto column = [&](Scalar by, Scalar a, Scalar b) {
    return terms.scale * minus_mul(terms.rho, a + b, by);
  };
  pose_columns[0] = column(e_by_w.x, left_w.x, right_w.x);
  pose_columns[1] = column(e_by_w.y, left_w.y, right_w.y);
  pose_columns[2] = column(e_by_w.z, left_w.z, right_w.z);
  pose_columns[3] = column(e_by_t.x, left_t.x, right_t.x);
  pose_columns[4] = column(e_by_t.y, left_t.y, right_t.y);
  pose_columns[5] = column(e_by_t.z, left_t.z, right_t.z);
  return terms;
}
