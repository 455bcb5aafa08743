// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// A value and its derivative along one direction, on any Scalar with the operators that
// corner_formulas.h asks for. No include guard: included after the Scalar's operators, inside the
// same namespace.

template <class Scalar>
struct Dual {
  Scalar v, d;

  Dual() = default;
  explicit Dual(double constant) : v(constant), d(0.0) {}
  Dual(Scalar value, Scalar derivative) : v(value), d(derivative) {}
};

template <class Scalar>
inline Dual<Scalar> operator+(Dual<Scalar> a, Dual<Scalar> b) {
  return {a.v + b.v, a.d + b.d};
}
template <class Scalar>
inline Dual<Scalar> operator-(Dual<Scalar> a, Dual<Scalar> b) {
  return {a.v - b.v, a.d - b.d};
}
template <class Scalar>
inline Dual<Scalar> operator*(Dual<Scalar> a, Dual<Scalar> b) {
  return {a.v * b.v, mul_add(a.v, b.d, a.d * b.v)};
}
template <class Scalar>
inline Dual<Scalar> operator/(Dual<Scalar> a, Dual<Scalar> b) {
  const Scalar q = a.v / b.v;
  return {q, (a.d - q * b.d) / b.v};
}
template <class Scalar>
inline Dual<Scalar> mul_add(Dual<Scalar> a, Dual<Scalar> b, Dual<Scalar> c) {
  return {mul_add(a.v, b.v, c.v), mul_add(a.v, b.d, mul_add(a.d, b.v, c.d))};
}
/// Where the floor is used its derivative is; both are nearly zero there.
template <class Scalar>
inline Dual<Scalar> at_least(Dual<Scalar> a, Dual<Scalar> floor) {
  return {at_least(a.v, floor.v), a.d};
}
template <class Scalar>
inline Dual<Scalar> sqrt(Dual<Scalar> a) {
  const Scalar root = sqrt(a.v);
  return {root, a.d / (root + root)};
}
template <class Scalar>
inline Dual<Scalar> atan(Dual<Scalar> a) {
  return {atan(a.v), a.d / mul_add(a.v, a.v, Scalar(1.0))};
}
