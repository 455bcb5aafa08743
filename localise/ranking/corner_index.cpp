// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/corner_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "localise/place.h"
#include "localise/ranking/node_ranker.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

namespace {

using Eigen::Index;
using Eigen::MatrixXf;

constexpr float same_word = 0.8F;   ///< least similarity to a word that it makes needless
constexpr float least_word = 0.3F;  ///< what is less similar to a word has nothing of it
constexpr Index most_words = 4096;
constexpr std::size_t most_examples = 65'536;

std::string place_of(std::size_t node) { return "map node " + std::to_string(node); }

std::size_t corners_of(const TopologicalMap& map) {
  std::size_t corners = 0;
  for (const MapNode& node : map.nodes) corners += node.view.corners.size();
  return corners;
}

/// Length of the first descriptor that is not empty; 0 without one.
Index size_in(std::span<const StereoCorner> corners) {
  for (const StereoCorner& corner : corners) {
    if (corner.descriptor.size() > 0) return corner.descriptor.size();
  }
  return 0;
}

/// The two nearest words of a corner and their similarities.
struct NearWords {
  std::array<Index, 2> word{-1, -1};
  std::array<float, 2> similarity{least_word, least_word};

  void offer(Index candidate, float value) {
    if (value > similarity[0]) {
      word = {candidate, word[0]};
      similarity = {value, similarity[0]};
    } else if (value > similarity[1]) {
      word[1] = candidate;
      similarity[1] = value;
    }
  }
};

std::vector<NearWords> near_words(const MatrixXf& words, const MatrixXf& descriptors) {
  const MatrixXf similar = words.transpose() * descriptors;
  std::vector<NearWords> near(static_cast<std::size_t>(descriptors.cols()));
  for (Index i = 0; i < similar.cols(); ++i) {
    for (Index w = 0; w < similar.rows(); ++w) near[i].offer(w, similar(w, i));
  }
  return near;
}

}  // namespace

MatrixXf descriptor_columns(std::span<const StereoCorner> corners,
                            Index size,
                            const std::string& place) {
  if (size == 0) size = size_in(corners);
  MatrixXf columns = MatrixXf::Zero(size, static_cast<Index>(corners.size()));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::VectorXf& descriptor = corners[i].descriptor;
    if (descriptor.size() == 0) continue;
    if (descriptor.size() != size) {
      throw Error(place,
                  "a descriptor has " + std::to_string(descriptor.size()) +
                      " entries, others have " + std::to_string(size),
                  "describe all corners in the same way");
    }
    if (!descriptor.allFinite()) {
      throw Error(place, "a descriptor has an entry that is not finite", "leave the corner out");
    }
    const float length = descriptor.norm();
    if (length > 0 && std::isfinite(length)) {
      columns.col(static_cast<Index>(i)) = descriptor / length;
    }
  }
  return columns;
}

CornerIndex::CornerIndex(const TopologicalMap& map) : nodes_(map.nodes.size()) {
  Index size = 0;
  for (const MapNode& node : map.nodes) {
    size = size_in(node.view.corners);
    if (size > 0) break;
  }
  make_words(map, size);
  make_postings(map);
}

void CornerIndex::make_words(const TopologicalMap& map, Index size) {
  const std::size_t stride = std::max<std::size_t>(1, corners_of(map) / most_examples);
  MatrixXf words(size, most_words);
  Index made = 0;
  std::size_t at = 0;
  for (std::size_t n = 0; n < map.nodes.size(); ++n) {
    const MatrixXf columns = descriptor_columns(map.nodes[n].view.corners, size, place_of(n));
    for (Index i = 0; i < columns.cols(); ++i) {
      if (at++ % stride != 0 || made == most_words || columns.col(i).isZero(0)) continue;
      if (made > 0 && (words.leftCols(made).transpose() * columns.col(i)).maxCoeff() >= same_word) {
        continue;
      }
      words.col(made++) = columns.col(i);
    }
  }
  words_ = words.leftCols(made);
}

void CornerIndex::make_postings(const TopologicalMap& map) {
  const auto words = static_cast<std::size_t>(words_.cols());
  postings_.resize(words);
  rarity_.assign(words, 0);
  if (words == 0) return;
  for (std::size_t n = 0; n < map.nodes.size(); ++n) {
    const MatrixXf columns =
        descriptor_columns(map.nodes[n].view.corners, words_.rows(), place_of(n));
    std::map<Index, float> counts;
    for (const NearWords& near : near_words(words_, columns)) {
      if (near.word[0] >= 0) ++counts[near.word[0]];
    }
    for (const auto& [word, count] : counts) {
      postings_[word].push_back({static_cast<int>(n), count});
    }
  }
  std::vector<double> squares(nodes_, 0);
  for (std::size_t w = 0; w < words; ++w) {
    const double nodes = static_cast<double>(nodes_), having = postings_[w].size();
    rarity_[w] = static_cast<float>(having > 0 ? std::log1p(nodes / having) : 0);
    for (Posting& posting : postings_[w]) {
      posting.weight *= rarity_[w];
      squares[posting.node] += static_cast<double>(posting.weight) * posting.weight;
    }
  }
  for (auto& of_word : postings_) {
    for (Posting& posting : of_word) {
      posting.weight /= static_cast<float>(std::sqrt(squares[posting.node]));
    }
  }
}

std::vector<RankedNode> CornerIndex::rank(const MatrixXf& descriptors, int most) const {
  std::vector<RankedNode> ranked;
  if (words_.cols() == 0 || descriptors.cols() == 0) return ranked;
  std::map<Index, float> weights;
  for (const NearWords& near : near_words(words_, descriptors)) {
    const float sum = near.similarity[0] + near.similarity[1];
    for (std::size_t k = 0; k < near.word.size(); ++k) {
      if (near.word[k] >= 0) weights[near.word[k]] += near.similarity[k] / sum;
    }
  }
  double squares = 0;
  for (auto& [word, weight] : weights) {
    weight *= rarity_[word];
    squares += static_cast<double>(weight) * weight;
  }
  std::vector<double> scores(nodes_, 0);
  for (const auto& [word, weight] : weights) {
    for (const Posting& posting : postings_[word]) {
      scores[posting.node] += static_cast<double>(weight) * posting.weight;
    }
  }
  for (std::size_t n = 0; n < nodes_; ++n) {
    if (scores[n] > 0) ranked.push_back({static_cast<int>(n), scores[n] / std::sqrt(squares), {}});
  }
  return best_of(std::move(ranked), most);
}

}  // namespace vernier::localise::internal
