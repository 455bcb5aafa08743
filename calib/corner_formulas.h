// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// The formulas of a projected corner, written once on a `Scalar` that is a double or a pack of
// doubles. This file has no include guard: it is included inside a namespace, once for doubles
// (distortion.cpp) and once for every instruction set of a kernel (view_kernel.cpp), because a
// template takes the instruction set of the place where it is defined. The including namespace
// supplies, for its Scalar, the operators + - * /, and mul_add(a, b, c) = a b + c, at_least(a, b),
// sqrt and atan.

/// A distorted normalised point and its derivatives. Every model here is the gradient of a
/// potential, so d x_d / d y = d y_d / d x.
template <class Scalar, std::size_t N>
struct DistortedPoint {
  Scalar x, y;                    // distorted normalised coordinates
  Scalar x_by_x, x_by_y, y_by_y;  // symmetric
  std::array<Scalar, N> x_by_k, y_by_k;
};

/// x_d = x g with g a function of r²: the shared part of every radial model.
template <class Scalar, std::size_t N>
inline void scale_radially(
    Scalar x, Scalar y, Scalar g, Scalar g_by_r2, DistortedPoint<Scalar, N>& d) {
  d.x = x * g;
  d.y = y * g;
  const Scalar twice = g_by_r2 + g_by_r2;
  const Scalar tx = twice * x;
  d.x_by_x = mul_add(tx, x, g);
  d.x_by_y = tx * y;
  d.y_by_y = mul_add(twice * y, y, g);
}

/// Sets column i of the derivatives by the coefficients to (x, y) s.
template <class Scalar, std::size_t N>
inline void radial_column(int i, Scalar x, Scalar y, Scalar s, DistortedPoint<Scalar, N>& d) {
  d.x_by_k[i] = x * s;
  d.y_by_k[i] = y * s;
}

/// Adds the decentring terms with p1, p2 = k[2], k[3] and their derivatives.
template <class Scalar, std::size_t N>
inline void add_decentring(Scalar x, Scalar y, Scalar p1, Scalar p2, DistortedPoint<Scalar, N>& d) {
  const Scalar xx = x * x, yy = y * y, xy = x * y, three = Scalar(3.0), two = Scalar(2.0);
  d.x_by_k[2] = xy + xy;
  d.y_by_k[2] = mul_add(three, yy, xx);
  d.x_by_k[3] = mul_add(three, xx, yy);
  d.y_by_k[3] = d.x_by_k[2];
  d.x = mul_add(d.x_by_k[2], p1, mul_add(d.x_by_k[3], p2, d.x));
  d.y = mul_add(d.y_by_k[2], p1, mul_add(d.y_by_k[3], p2, d.y));
  const Scalar p1x = p1 * x, p1y = p1 * y, p2x = p2 * x, p2y = p2 * y;
  d.x_by_x = mul_add(two, mul_add(three, p2x, p1y), d.x_by_x);
  d.x_by_y = mul_add(two, p1x + p2y, d.x_by_y);
  d.y_by_y = mul_add(two, mul_add(three, p1y, p2x), d.y_by_y);
}

template <class Scalar>
inline DistortedPoint<Scalar, 0> distorted(Pinhole, Scalar x, Scalar y, const Scalar*) {
  return {x, y, Scalar(1.0), Scalar(0.0), Scalar(1.0), {}, {}};
}

template <class Scalar>
inline DistortedPoint<Scalar, 1> distorted(Radial1, Scalar x, Scalar y, const Scalar* k) {
  DistortedPoint<Scalar, 1> d;
  const Scalar r2 = mul_add(x, x, y * y);
  scale_radially(x, y, mul_add(k[0], r2, Scalar(1.0)), k[0], d);
  radial_column(0, x, y, r2, d);
  return d;
}

template <class Scalar>
inline DistortedPoint<Scalar, 4> distorted(OpenCv4, Scalar x, Scalar y, const Scalar* k) {
  DistortedPoint<Scalar, 4> d;
  const Scalar r2 = mul_add(x, x, y * y);
  const Scalar g = mul_add(r2, mul_add(r2, k[1], k[0]), Scalar(1.0));
  scale_radially(x, y, g, mul_add(r2 + r2, k[1], k[0]), d);
  radial_column(0, x, y, r2, d);
  radial_column(1, x, y, r2 * r2, d);
  add_decentring(x, y, k[2], k[3], d);
  return d;
}

template <class Scalar>
inline DistortedPoint<Scalar, 5> distorted(OpenCv5, Scalar x, Scalar y, const Scalar* k) {
  DistortedPoint<Scalar, 5> d;
  const Scalar r2 = mul_add(x, x, y * y), r4 = r2 * r2;
  const Scalar g = mul_add(r2, mul_add(r2, mul_add(r2, k[4], k[1]), k[0]), Scalar(1.0));
  const Scalar g_by_r2 = mul_add(r2, mul_add(Scalar(3.0) * r2, k[4], k[1] + k[1]), k[0]);
  scale_radially(x, y, g, g_by_r2, d);
  radial_column(0, x, y, r2, d);
  radial_column(1, x, y, r4, d);
  radial_column(4, x, y, r4 * r2, d);
  add_decentring(x, y, k[2], k[3], d);
  return d;
}

template <class Scalar>
inline DistortedPoint<Scalar, 8> distorted(OpenCv8, Scalar x, Scalar y, const Scalar* k) {
  DistortedPoint<Scalar, 8> d;
  const Scalar one(1.0), three(3.0);
  const Scalar r2 = mul_add(x, x, y * y), r4 = r2 * r2, r6 = r4 * r2;
  const Scalar top = mul_add(r2, mul_add(r2, mul_add(r2, k[4], k[1]), k[0]), one);
  const Scalar bottom = mul_add(r2, mul_add(r2, mul_add(r2, k[7], k[6]), k[5]), one);
  const Scalar inverse = one / bottom;
  const Scalar g = top * inverse;
  const Scalar top_by_r2 = mul_add(r2, mul_add(three * r2, k[4], k[1] + k[1]), k[0]);
  const Scalar bottom_by_r2 = mul_add(r2, mul_add(three * r2, k[7], k[6] + k[6]), k[5]);
  scale_radially(x, y, g, (top_by_r2 - g * bottom_by_r2) * inverse, d);
  const Scalar xi = x * inverse, yi = y * inverse, minus_g = Scalar(0.0) - g;
  radial_column(0, xi, yi, r2, d);
  radial_column(1, xi, yi, r4, d);
  radial_column(4, xi, yi, r6, d);
  radial_column(5, xi, yi, minus_g * r2, d);
  radial_column(6, xi, yi, minus_g * r4, d);
  radial_column(7, xi, yi, minus_g * r6, d);
  add_decentring(x, y, k[2], k[3], d);
  return d;
}

template <class Scalar>
inline DistortedPoint<Scalar, 4> distorted(Fisheye4, Scalar x, Scalar y, const Scalar* k) {
  DistortedPoint<Scalar, 4> d;
  const Scalar one(1.0), two(2.0);
  // On the axis θ_d / r = 1 to rounding from r = 1e-8 down, and the derivative by r² is
  // multiplied by x xᵀ: a floor under r² changes nothing there and divides by no zero.
  const Scalar r2 = at_least(mul_add(x, x, y * y), Scalar(1e-16)), r = sqrt(r2);
  const Scalar t = atan(r), t2 = t * t;
  const Scalar poly =
      mul_add(t2, mul_add(t2, mul_add(t2, mul_add(t2, k[3], k[2]), k[1]), k[0]), one);
  const Scalar slope = mul_add(
      t2, mul_add(t2, mul_add(t2, Scalar(8.0) * k[3], Scalar(6.0) * k[2]), Scalar(4.0) * k[1]),
      two * k[0]);  // d poly / d θ over θ
  const Scalar t_over_r = t / r, g = t_over_r * poly;
  const Scalar theta_d_by_r = mul_add(t2, slope, poly) / (one + r2);
  scale_radially(x, y, g, (theta_d_by_r - g) / (two * r2), d);
  Scalar power = t_over_r;
  for (int i = 0; i < 4; ++i) {
    power = power * t2;
    radial_column(i, x, y, power, d);
  }
  return d;
}

/// A camera and where it sees the board, as the rows below need them.
template <class Model, class Scalar>
struct CornerView {
  static constexpr int distortions = static_cast<int>(Model::distortion_names.size());
  Scalar R[9], t[3];      // of T_camera_board, row by row
  Scalar fx, fy, ox, oy;  // fx = f ax, fy = f
  Scalar k[distortions + 1];
};

/// One corner's two rows of the weighted system, columns
///
///     f_x | f_y,  o_x | o_y,  k1 …,  twist of T_camera_board (6),  warp (2, if Warp),  residual
///
/// where u's row has the first of each pair and v's row the second. The twist (w, v) moves a point
/// of the camera's frame to x + w × x + v. `X` is the target point, `shape` the derivatives of its
/// z by the two warps, `weight` 1 / σ.
template <bool Warp, class Model, class Scalar>
inline void corner_rows(Model model,
                        const CornerView<Model, Scalar>& c,
                        const Scalar (&X)[3],
                        const Scalar (&shape)[2],
                        Scalar weight,
                        const Scalar (&pixel)[2],
                        Scalar* u,
                        Scalar* v) {
  constexpr int n = CornerView<Model, Scalar>::distortions, twist = 2 + n;
  constexpr int residual = twist + (Warp ? 8 : 6);
  const Scalar px = mul_add(c.R[0], X[0], mul_add(c.R[1], X[1], mul_add(c.R[2], X[2], c.t[0])));
  const Scalar py = mul_add(c.R[3], X[0], mul_add(c.R[4], X[1], mul_add(c.R[5], X[2], c.t[1])));
  const Scalar pz = mul_add(c.R[6], X[0], mul_add(c.R[7], X[1], mul_add(c.R[8], X[2], c.t[2])));
  const Scalar iz = Scalar(1.0) / pz, x = px * iz, y = py * iz;
  const auto d = distorted(model, x, y, c.k);
  const Scalar fx = c.fx * weight, fy = c.fy * weight;
  u[0] = d.x * weight;
  v[0] = d.y * weight;
  u[1] = v[1] = weight;
  for (int i = 0; i < n; ++i) {
    u[2 + i] = fx * d.x_by_k[i];
    v[2 + i] = fy * d.y_by_k[i];
  }
  const auto pose = [&](Scalar by_x, Scalar by_y, Scalar* row) {
    const Scalar by_z = Scalar(0.0) - mul_add(by_x, x, by_y * y);  // all three over z, times iz
    row[twist] = y * by_z - by_y;
    row[twist + 1] = by_x - x * by_z;
    row[twist + 2] = x * by_y - y * by_x;
    row[twist + 3] = by_x * iz;
    row[twist + 4] = by_y * iz;
    row[twist + 5] = by_z * iz;
    if constexpr (Warp) {
      const Scalar by_height =
          mul_add(row[twist + 3], c.R[2], mul_add(row[twist + 4], c.R[5], row[twist + 5] * c.R[8]));
      row[twist + 6] = by_height * shape[0];
      row[twist + 7] = by_height * shape[1];
    }
  };
  pose(fx * d.x_by_x, fx * d.x_by_y, u);
  pose(fy * d.x_by_y, fy * d.y_by_y, v);
  u[residual] = (mul_add(c.fx, d.x, c.ox) - pixel[0]) * weight;
  v[residual] = (mul_add(c.fy, d.y, c.oy) - pixel[1]) * weight;
}
