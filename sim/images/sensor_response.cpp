// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/sensor_response.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/images/poisson.h"
#include "stereo/grey_levels.h"

namespace vernier::sim::internal {

using stereo::GreyLevels;
using vernier::internal::DrawSource;
using vernier::internal::RandomStream;

namespace {

std::vector<float> gaussian(double sigma) {
  const int reach = static_cast<int>(std::ceil(4 * sigma));
  std::vector<double> weights;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    sum += weights.back();
  }
  std::vector<float> kernel;
  for (const double w : weights) kernel.push_back(static_cast<float>(w / sum));
  return kernel;
}

/// Convolves lines of `length` values `step` apart, `lines` of them `pitch` apart.
void convolve(std::vector<float>& values,
              const std::vector<float>& kernel,
              std::size_t lines,
              std::size_t pitch,
              std::size_t length,
              std::size_t step) {
  const std::size_t reach = kernel.size() / 2;
  std::vector<float> padded(length + 2 * reach);
  for (std::size_t line = 0; line < lines; ++line) {
    float* const first = values.data() + line * pitch;
    for (std::size_t i = 0; i < padded.size(); ++i) {
      const std::size_t at = std::min(i < reach ? 0 : i - reach, length - 1);
      padded[i] = first[at * step];
    }
    for (std::size_t i = 0; i < length; ++i) {
      float sum = 0;
      for (std::size_t k = 0; k < kernel.size(); ++k) sum += kernel[k] * padded[i + k];
      first[i * step] = sum;
    }
  }
}

void vignette(GreyLevels& image, const Camera& camera, double vignetting) {
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      const auto ray = try_unproject(camera, {static_cast<double>(x), static_cast<double>(y)});
      const double cos2 = ray ? 1 / ray->squaredNorm() : 0;  // the ray's z is 1
      image.values[static_cast<std::size_t>(y) * image.width_px + x] *=
          static_cast<float>(1 - vignetting * (1 - cos2 * cos2));
    }
  }
}

}  // namespace

void check_sensor(const SensorOptions& o) {
  const auto require = [](bool fine, const char* fault, const char* remedy) {
    if (!fine) throw Error("sensor", fault, remedy);
  };
  require(o.point_spread_px >= 0 && o.point_spread_px <= 20,
          "the point spread is not in [0, 20] px", "use 0.6, say");
  require(o.vignetting >= 0 && o.vignetting <= 1, "the vignetting is not in [0, 1]",
          "use 0.3, say");
  require(o.exposure >= 0 && o.exposure <= 1e6, "the exposure is not in [0, 1e6]",
          "use 0 for an automatic one");
  require(o.full_well_e >= 10 && o.full_well_e <= 1e8,
          "the full well is not in [10, 1e8] electrons", "use 10000, say");
  require(o.read_noise_e >= 0 && o.read_noise_e <= o.full_well_e,
          "the read noise is negative or above the full well", "use 8 electrons, say");
  require(o.gamma >= 0.1 && o.gamma <= 10, "gamma is not in [0.1, 10]", "use 1 or 2.2");
}

GreyLevels through_lens(const GreyLevels& radiance,
                        const Camera& camera,
                        const SensorOptions& options) {
  check_sensor(options);
  GreyLevels image = radiance;
  const auto width = static_cast<std::size_t>(image.width_px);
  const auto height = static_cast<std::size_t>(image.height_px);
  if (options.point_spread_px > 0) {
    const std::vector<float> kernel = gaussian(options.point_spread_px);
    convolve(image.values, kernel, height, width, width, 1);
    convolve(image.values, kernel, width, 1, height, width);
  }
  if (options.vignetting > 0) vignette(image, camera, options.vignetting);
  return image;
}

double automatic_exposure(const GreyLevels& behind_lens) {
  constexpr double share = 0.95, level = 0.8;
  std::vector<float> values = behind_lens.values;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * (values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at > 0 ? level / *at : 1;
}

GreyLevels sensed(const GreyLevels& behind_lens,
                  const SensorOptions& options,
                  const SensorDraws& draws) {
  check_sensor(options);
  constexpr double white = 255;
  GreyLevels image = behind_lens;
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    double electrons = options.full_well_e * options.exposure * behind_lens.values[i];
    if (options.noise) {
      RandomStream stream({draws.seed, draws.image, static_cast<std::uint32_t>(i),
                           static_cast<std::uint32_t>(DrawSource::sensor_noise), draws.eye, 0});
      // Far above the full well nothing changes.
      electrons = draw_poisson(stream, std::min(electrons, 4 * options.full_well_e));
      electrons += options.read_noise_e * stream.normal();
    }
    const double share = std::clamp(electrons / options.full_well_e, 0.0, 1.0);
    const double grey = white * (options.gamma == 1 ? share : std::pow(share, 1 / options.gamma));
    image.values[i] = static_cast<float>(options.whole_levels ? std::round(grey) : grey);
  }
  return image;
}

}  // namespace vernier::sim::internal
