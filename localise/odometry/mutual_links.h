// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "localise/odometry.h"

namespace vernier::localise::internal {

/// The most similar corner of the other moment, and the lead over the second.
struct BestPartner {
  int index = -1;
  float similarity = -2, second = -2;

  void offer(int candidate, float value) {
    if (value > similarity) {
      second = similarity;
      similarity = value;
      index = candidate;
    } else if (value > second) {
      second = value;
    }
  }
};

/// What similarity(i, j) returns for a pair that may not be linked.
constexpr float no_similarity = -2;

/// Links each other's best, similar enough and with the lead that is asked for. similarity(i, j) is
/// that of corner i of `from` corners with corner j of `to` corners, in [-1, 1].
template <typename Similarity>
std::vector<CornerLink> mutual_links(std::size_t from,
                                     std::size_t to,
                                     const CornerLinkOptions& options,
                                     const Similarity& similarity) {
  std::vector<BestPartner> forward(from), backward(to);
  for (std::size_t i = 0; i < from; ++i) {
    for (std::size_t j = 0; j < to; ++j) {
      const float value = similarity(i, j);
      if (value == no_similarity) continue;
      forward[i].offer(static_cast<int>(j), value);
      backward[j].offer(static_cast<int>(i), value);
    }
  }
  const auto is_clear = [&](const BestPartner& best) {
    return best.index >= 0 && best.similarity >= options.min_similarity &&
           best.similarity - best.second >= options.min_margin;
  };
  std::vector<CornerLink> links;
  for (std::size_t i = 0; i < from; ++i) {
    const BestPartner& best = forward[i];
    if (!is_clear(best)) continue;
    const BestPartner& back = backward[static_cast<std::size_t>(best.index)];
    if (back.index == static_cast<int>(i) && is_clear(back)) {
      links.push_back({static_cast<int>(i), best.index});
    }
  }
  return links;
}

}  // namespace vernier::localise::internal
