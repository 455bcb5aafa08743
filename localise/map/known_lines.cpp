// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/map/known_lines.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localise/map/known_lines.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#ifndef VERNIER_LOCALISE_MAP_KNOWN_LINES_COLUMNS
#define VERNIER_LOCALISE_MAP_KNOWN_LINES_COLUMNS
namespace vernier::localise::internal {

/// Of the known lines, as the kernel reads them.
struct KnownColumns {
  const float *ax, *ay, *az, *ux, *uy, *uz, *length, *sigma;
  std::size_t size;
};

/// The line that is looked for.
struct SoughtLine {
  float mx, my, mz, ux, uy, uz, half, excess, sigma;
};

}  // namespace vernier::localise::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace vernier::localise::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

bool any_contains(const KnownColumns& known, const SoughtLine& line) {
  constexpr float least_cosine = 0.985f, aside_m = 0.05f, sigmas = 0.25f;
  const hn::ScalableTag<float> d;
  const auto set = [&](float x) { return hn::Set(d, x); };
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < known.size; i += lanes) {
    const auto ux = hn::LoadU(d, known.ux + i), uy = hn::LoadU(d, known.uy + i),
               uz = hn::LoadU(d, known.uz + i);
    const auto dot = [&](auto x, auto y, auto z) {
      return hn::MulAdd(ux, x, hn::MulAdd(uy, y, hn::Mul(uz, z)));
    };
    const auto parallel =
        hn::Ge(hn::Abs(dot(set(line.ux), set(line.uy), set(line.uz))), set(least_cosine));
    if (hn::AllFalse(d, parallel)) continue;
    const auto rx = hn::Sub(set(line.mx), hn::LoadU(d, known.ax + i));
    const auto ry = hn::Sub(set(line.my), hn::LoadU(d, known.ay + i));
    const auto rz = hn::Sub(set(line.mz), hn::LoadU(d, known.az + i));
    const auto along = dot(rx, ry, rz);
    const auto within = hn::And(
        hn::Ge(along, set(line.half - line.excess)),
        hn::Le(along, hn::Add(hn::LoadU(d, known.length + i), set(line.excess - line.half))));
    const auto across =
        hn::Sub(hn::MulAdd(rx, rx, hn::MulAdd(ry, ry, hn::Mul(rz, rz))), hn::Mul(along, along));
    const auto aside = hn::MulAdd(
        set(sigmas), hn::Add(hn::LoadU(d, known.sigma + i), set(line.sigma)), set(aside_m));
    const auto near = hn::Lt(across, hn::Mul(aside, aside));
    if (!hn::AllFalse(d, hn::And(parallel, hn::And(within, near)))) return true;
  }
  return false;
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::localise::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::localise::internal {

HWY_EXPORT(any_contains);

namespace {
/// |uz| of 45 degrees parts the lines that are looked for; known ones are in both sets if they may
/// be parallel to either (10 degrees, and some more).
constexpr float parting = 0.70711f, steep_from = 0.55f, level_to = 0.83f;
}  // namespace

void KnownLines::Columns::add(const Eigen::Vector3f& a,
                              const Eigen::Vector3f& u,
                              float length,
                              float sigma) {
  constexpr std::size_t lanes = 16;  // of the widest instruction set
  const std::size_t room = (size / lanes + 1) * lanes;
  if (ax.size() < room) {
    // Lines without direction, to which none is parallel.
    for (auto* column : {&ax, &ay, &az, &ux, &uy, &uz, &length_m, &sigma_m}) {
      column->resize(2 * room, 0.0f);
    }
  }
  const float values[] = {a.x(), a.y(), a.z(), u.x(), u.y(), u.z(), length, sigma};
  std::size_t k = 0;
  for (auto* column : {&ax, &ay, &az, &ux, &uy, &uz, &length_m, &sigma_m}) {
    (*column)[size] = values[k++];
  }
  ++size;
}

void KnownLines::add(const Eigen::Vector3f& a_m, const Eigen::Vector3f& b_m, float sigma_m) {
  const float length = (b_m - a_m).norm();
  const Eigen::Vector3f u = (b_m - a_m) / std::max(length, 1e-6f);
  if (std::abs(u.z()) >= steep_from) steep_.add(a_m, u, length, sigma_m);
  if (std::abs(u.z()) <= level_to) level_.add(a_m, u, length, sigma_m);
}

bool KnownLines::contain(const Eigen::Vector3f& a_m,
                         const Eigen::Vector3f& b_m,
                         float sigma_m) const {
  constexpr float excess_share = 0.15f, excess_m = 0.1f;
  const float length = (b_m - a_m).norm();
  const Eigen::Vector3f u = (b_m - a_m) / std::max(length, 1e-6f), m = 0.5f * (a_m + b_m);
  const Columns& set = std::abs(u.z()) >= parting ? steep_ : level_;
  const KnownColumns known{set.ax.data(),       set.ay.data(),      set.az.data(),
                           set.ux.data(),       set.uy.data(),      set.uz.data(),
                           set.length_m.data(), set.sigma_m.data(), set.size};
  const SoughtLine sought{m.x(),  m.y(), m.z(),         u.x(),
                          u.y(),  u.z(), 0.5f * length, excess_share * length + excess_m,
                          sigma_m};
  return HWY_DYNAMIC_DISPATCH(any_contains)(known, sought);
}

}  // namespace vernier::localise::internal
#endif
