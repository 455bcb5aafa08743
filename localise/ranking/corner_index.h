// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "localise/place.h"
#include "localise/ranking/node_ranker.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// The descriptors of corners scaled to unit length, one a column; a zero column for a corner that
/// has none. `size` is their length; 0: that of the first which is not empty. Throws Error naming
/// the place for another length, and numbers that are not finite.
Eigen::MatrixXf descriptor_columns(std::span<const StereoCorner> corners,
                                   Eigen::Index size,
                                   const std::string& place);

/// Ranks nodes by the words that their corners share with a view's: an inverted index with weights
/// by how rare a word is (tf-idf; Sivic and Zisserman, ICCV 2003), a query's corner standing for
/// its two nearest words (soft assignment; Philbin et al., CVPR 2008).
///
/// The vocabulary is the map's own. Corners are taken in the map's order, at most 65,536 spread
/// over it: one that is less similar than 0.8 to every word so far is a new word, up to 4096
/// (leader clustering). A corner seen again and again is about one word, so that a query costs
/// corners × words, and no more for a large map but for the nodes that share a word.
class CornerIndex {
 public:
  /// Throws Error for a map whose descriptors differ in length or are not finite.
  explicit CornerIndex(const TopologicalMap& map);

  Eigen::Index descriptor_size() const { return words_.rows(); }  ///< 0: the map has none
  int words() const { return static_cast<int>(words_.cols()); }

  /// The `most` nodes with the largest cosine of weighted words above 0, best first; ties keep the
  /// map's order. `descriptors` are of descriptor_columns().
  std::vector<RankedNode> rank(const Eigen::MatrixXf& descriptors, int most) const;

 private:
  struct Posting {
    int node = 0;
    float weight = 0;  ///< of the word in the node, whose weights have unit length
  };
  void make_words(const TopologicalMap& map, Eigen::Index size);
  void make_postings(const TopologicalMap& map);

  Eigen::MatrixXf words_;  // one a column
  std::vector<float> rarity_;
  std::vector<std::vector<Posting>> postings_;  // of each word, by ascending node
  std::size_t nodes_ = 0;
};

}  // namespace vernier::localise::internal
