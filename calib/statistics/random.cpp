// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/random.h"

#include <Random123/philox.h>

#include <algorithm>
#include <cmath>

#include "calib/error.h"

namespace vernier::internal {

constexpr std::uint32_t first_prior = 0xffff0000;  // among the features

RandomCounter of_view(RandomCounter place, int frame, int camera) {
  const std::uint64_t identity =
      std::uint64_t{64} * static_cast<std::uint32_t>(frame) + static_cast<std::uint32_t>(camera);
  place.feature = static_cast<std::uint32_t>(identity);
  place.frame = static_cast<std::uint32_t>(identity >> 32);
  // The views whose places are those of priors go where no view is.
  if (place.frame == 0 && place.feature >= first_prior) place.frame = 1u << 21;
  return place;
}

RandomCounter of_prior(RandomCounter place, std::uint32_t number) {
  place.feature = first_prior + number;
  return place;
}

RandomStream::RandomStream(const RandomCounter& place)
    : key_{static_cast<std::uint32_t>(place.seed), static_cast<std::uint32_t>(place.seed >> 32)},
      counter_{place.trial, place.feature, place.source << 24 | place.eye << 22 | place.frame, 0} {
  if (place.source >= 1u << 8 || place.eye >= 1u << 2 || place.frame >= 1u << 22) {
    throw Error("random draw", "source, eye or frame is beyond its bits", "8, 2 and 22 bits");
  }
}

double RandomStream::uniform() {
  if (used_ > 2) {
    const auto block = r123::Philox4x32()({{counter_[0], counter_[1], counter_[2], counter_[3]}},
                                          {{key_[0], key_[1]}});
    for (int i = 0; i < 4; ++i) words_[i] = block[i];
    ++counter_[3];
    used_ = 0;
  }
  const std::uint64_t bits =
      (static_cast<std::uint64_t>(words_[used_ + 1]) << 32 | words_[used_]) >> 11;
  used_ += 2;
  return (static_cast<double>(bits) + 0.5) * 0x1p-53;
}

double RandomStream::uniform(double low, double high) { return low + (high - low) * uniform(); }

double RandomStream::normal() { return normal_quantile(uniform()); }

std::uint32_t RandomStream::below(std::uint32_t n) {
  return std::min(n - 1, static_cast<std::uint32_t>(uniform() * n));
}

Eigen::VectorXd RandomStream::normals(int n) {
  Eigen::VectorXd z(n);
  for (int i = 0; i < n; ++i) z[i] = normal();
  return z;
}

double normal_quantile(double p) {
  const auto ratio = [](const std::array<double, 8>& a, const std::array<double, 8>& b, double r) {
    double top = a[7], bottom = b[7];
    for (int i = 6; i >= 0; --i) {
      top = top * r + a[i];
      bottom = bottom * r + b[i];
    }
    return top / bottom;
  };
  // Coefficients of AS 241 (Applied Statistics 37, 1988), PPND16: centre, middle, tail.
  static constexpr std::array<double, 8> a{3.3871328727963666080e0, 1.3314166789178437745e2,
                                           1.9715909503065514427e3, 1.3731693765509461125e4,
                                           4.5921953931549871457e4, 6.7265770927008700853e4,
                                           3.3430575583588128105e4, 2.5090809287301226727e3};
  static constexpr std::array<double, 8> b{1.0,
                                           4.2313330701600911252e1,
                                           6.8718700749205790830e2,
                                           5.3941960214247511077e3,
                                           2.1213794301586595867e4,
                                           3.9307895800092710610e4,
                                           2.8729085735721942674e4,
                                           5.2264952788528545610e3};
  static constexpr std::array<double, 8> c{1.42343711074968357734e0,  4.63033784615654529590e0,
                                           5.76949722146069140550e0,  3.64784832476320460504e0,
                                           1.27045825245236838258e0,  2.41780725177450611770e-1,
                                           2.27238449892691845833e-2, 7.74545014278341407640e-4};
  static constexpr std::array<double, 8> d{1.0,
                                           2.05319162663775882187e0,
                                           1.67638483018380384940e0,
                                           6.89767334985100004550e-1,
                                           1.48103976427480074590e-1,
                                           1.51986665636164571966e-2,
                                           5.47593808499534494600e-4,
                                           1.05075007164441684324e-9};
  static constexpr std::array<double, 8> e{6.65790464350110377720e0,  5.46378491116411436990e0,
                                           1.78482653991729133580e0,  2.96560571828504891230e-1,
                                           2.65321895265761230930e-2, 1.24266094738807843860e-3,
                                           2.71155556874348757815e-5, 2.01033439929228813265e-7};
  static constexpr std::array<double, 8> f{1.0,
                                           5.99832206555887937690e-1,
                                           1.36929880922735805310e-1,
                                           1.48753612908506148525e-2,
                                           7.86869131145613259100e-4,
                                           1.84631831751005468180e-5,
                                           1.42151175831644588870e-7,
                                           2.04426310338993978564e-15};

  const double q = p - 0.5;
  if (std::abs(q) <= 0.425) return q * ratio(a, b, 0.180625 - q * q);
  const double r = std::sqrt(-std::log(q < 0 ? p : 1 - p));
  const double z = r <= 5 ? ratio(c, d, r - 1.6) : ratio(e, f, r - 5);
  return q < 0 ? -z : z;
}

}  // namespace vernier::internal
