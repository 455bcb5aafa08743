// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// What a vertical disparity does to the matches: the right images of a list of pairs
// (docs/matchers.md) moved down by so many pixels, and the edge matcher's errors against the truth
// of the unmoved pair, as one who does not know of it meets them.
//
//     misaligned_rows pairs.toml [--repair]
#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/evaluation/warped_pair.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/rectification/vertical_field.h"
#include "stereo/stereo_truth.h"

int main(int argc, char** argv) {
  using namespace vernier::stereo;
  using namespace vernier::stereo::internal;
  if (argc < 2) return 2;
  const bool repaired = argc > 2 && std::string(argv[2]) == "--repair";
  fmt::print(
      "pair            lower  field rms  used  density  >1 px  smooth >1 px  z rms  in 95 %\n");
  for (const StereoSceneFile& file : read_stereo_scenes(argv[1])) {
    const RectifiedPair pair{read_grey_levels(file.left), read_grey_levels(file.right)};
    const StereoTruth truth = read_stereo_truth(file, pair.left.width_px, pair.left.height_px);
    const std::vector<EdgePoint> edges = canny_edges(pair.left);
    const std::vector<TruthAtEdge> at_edges = truth_at(truth, edges);
    for (const double lower_px : {0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 3.0, 4.0}) {
      RectifiedPair moved = with_shifted_rows(pair, truth, lower_px).pair;
      const VerticalField field = vertical_field(moved, file.range);
      if (repaired) correct_right(field, moved);
      const auto found = edge_matcher().match(moved, edges, file.range);
      const MatcherScore score = evaluate(edges, found, at_edges, pair.left.width_px);
      fmt::print("{:<14} {:6.2f} {:9.2f} {:6} {:8.3f} {:7.3f} {:13.3f} {:6.2f} {:7.3f}\n",
                 file.name, lower_px, field.known ? field.rms_px() : -1, field.used,
                 score.all.density, score.all.bad_1, score.smooth.bad_1, score.z_rms,
                 score.coverage_95);
      std::fflush(stdout);
    }
  }
}
