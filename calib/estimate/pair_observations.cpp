// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/pair_observations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/estimate/rig_part.h"
#include "calib/rig.h"

namespace vernier {
namespace {

std::string row_place(const std::string& place, std::size_t row) {
  return place.empty() ? fmt::format("pair {}", row + 1) : fmt::format("{}:{}", place, row + 2);
}

/// Throws Error unless the image pairs hold every row once, in order, with its noise.
void check_layout(const PairObservations& pairs, const std::string& place) {
  const std::string where = place.empty() ? "pairs" : place;
  std::size_t next = 0;
  for (const ImagePair& image : pairs.image_pairs) {
    if (image.first != next || image.count > pairs.size() - next) {
      throw Error(where,
                  fmt::format("image pair {} has {} rows from {} on, of {}, {} of which are taken",
                              image.number, image.count, image.first, pairs.size(), next),
                  "build them with add_pair");
    }
    next += image.count;
  }
  if (next != pairs.size()) {
    throw Error(
        where, fmt::format("{} of {} rows are of no image pair", pairs.size() - next, pairs.size()),
        "build them with add_pair");
  }
  if (pairs.sigma_px.size() > 1 && pairs.sigma_px.size() != pairs.size()) {
    throw Error(where,
                fmt::format("{} values of noise for {} rows", pairs.sigma_px.size(), pairs.size()),
                "give one per row, or one for all");
  }
}

void check_row(const Eigen::Vector4d& y, const Rig& rig, const std::string& place) {
  if (!y.allFinite()) {
    throw Error(place, "a pixel coordinate is not finite", "remove the line");
  }
  for (int c = 0; c < 2; ++c) {
    const Camera& camera = rig.cameras[static_cast<std::size_t>(c)];
    const Eigen::Vector2d pixel = y.segment<2>(2 * c);
    if (in_image(camera, pixel)) continue;
    throw Error(place,
                fmt::format("({:g}, {:g}) lies outside the {} image of {} x {} pixels", pixel[0],
                            pixel[1], camera.name, camera.size_px[0], camera.size_px[1]),
                "remove the line, or check that images and prior are of the same cameras");
  }
}

/// Rejects repeated matches in an image pair, which would count twice.
void check_duplicates(const PairObservations& pairs, const std::string& place) {
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (const ImagePair& image : pairs.image_pairs) {
    const auto begin = order.begin() + static_cast<std::ptrdiff_t>(image.first);
    const auto end = begin + static_cast<std::ptrdiff_t>(image.count);
    const auto before = [&](std::size_t a, std::size_t b) {
      const Eigen::Vector4d &x = pairs.pixels_px[a], &y = pairs.pixels_px[b];
      const auto differ = std::mismatch(x.begin(), x.end(), y.begin());
      return differ.first == x.end() ? a < b : *differ.first < *differ.second;
    };
    std::sort(begin, end, before);
    const auto same = std::adjacent_find(begin, end, [&](std::size_t a, std::size_t b) {
      return pairs.pixels_px[a] == pairs.pixels_px[b];
    });
    if (same == end) continue;
    throw Error(row_place(place, *(same + 1)),
                place.empty() ? "it repeats " + row_place("", *same)
                              : fmt::format("it repeats line {}", *same + 2),
                "give every match once");
  }
}

}  // namespace

void add_pair(PairObservations& pairs,
              int number,
              const Eigen::Vector4d& pixels_px,
              double sigma_px) {
  if (pairs.image_pairs.empty() || pairs.image_pairs.back().number != number) {
    pairs.image_pairs.push_back({number, pairs.size(), 0});
  }
  ++pairs.image_pairs.back().count;
  const auto sigma = static_cast<float>(sigma_px);
  if (pairs.sigma_px.empty() && pairs.size() > 0) pairs.sigma_px = {1};
  if (pairs.size() == 0) {
    pairs.sigma_px = {sigma};
  } else if (pairs.sigma_px.size() > 1 || pairs.sigma_px[0] != sigma) {
    if (pairs.sigma_px.size() == 1) pairs.sigma_px.resize(pairs.size(), pairs.sigma_px[0]);
    pairs.sigma_px.push_back(sigma);
  }
  pairs.pixels_px.push_back(pixels_px);
}

void append(PairObservations& pairs, const PairObservations& more) {
  std::set<int> taken;
  for (const ImagePair& image : pairs.image_pairs) taken.insert(image.number);
  int next = 0;
  for (const ImagePair& image : more.image_pairs) {
    int number = image.number;
    if (taken.count(number)) {
      while (taken.count(next)) ++next;
      number = next;
    }
    taken.insert(number);
    for (std::size_t i = image.first; i < image.first + image.count; ++i) {
      add_pair(pairs, number, more.pixels_px[i], more.sigma_of(i));
    }
  }
}

PairObservations selected(const PairObservations& pairs, const std::vector<bool>& kept) {
  check_layout(pairs, "");
  if (kept.size() != pairs.size()) {
    throw Error("pairs", fmt::format("{} flags for {} rows", kept.size(), pairs.size()),
                "give one per row");
  }
  PairObservations some;
  for (const ImagePair& image : pairs.image_pairs) {
    for (std::size_t i = image.first; i < image.first + image.count; ++i) {
      if (kept[i]) add_pair(some, image.number, pairs.pixels_px[i], pairs.sigma_of(i));
    }
  }
  return some;
}

void check_pairs(const PairObservations& pairs, const Rig& rig, const std::string& place) {
  internal::require_pair(rig, place.empty() ? "pairs" : place);
  check_layout(pairs, place);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double sigma = pairs.sigma_of(i);
    if (!(sigma > 0 && std::isfinite(sigma))) {
      throw Error(row_place(place, i), fmt::format("its noise of {} px is invalid", sigma),
                  "give a standard deviation above 0");
    }
    check_row(pairs.pixels_px[i], rig, row_place(place, i));
  }
  check_duplicates(pairs, place);
}

}  // namespace vernier
