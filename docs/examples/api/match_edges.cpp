// Matches the edges of a rectified pair, with the edge matcher and with one of your own, and scores
// both against the truth.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stereo_truth.h"

namespace {
using namespace vernier::stereo;

/// Your own: the disparity with the least sum of absolute differences over 7 x 7 pixels.
std::vector<EdgeDisparity> match_blocks(const RectifiedPair& pair,
                                        const std::vector<EdgePoint>& edges,
                                        const DisparityRange& range) {
  std::vector<EdgeDisparity> found(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const int x = edges[i].x, y = edges[i].y;
    if (y < 3 || y + 3 >= pair.left.height_px || x + 3 >= pair.left.width_px) continue;
    float least = 1e9f;
    for (int d = range.min_px; d <= range.max_px && x - d >= 3; ++d) {
      float sum = 0;
      for (int k = 0; k < 49; ++k) {
        const int u = x + k % 7 - 3, v = y + k / 7 - 3;
        sum += std::abs(pair.left(u, v) - pair.right(u - d, v));
      }
      if (sum < least) found[i] = {.disparity_px = static_cast<float>(d), .confidence = -sum};
      least = std::min(least, sum);
    }
  }
  return found;
}
}  // namespace

int main() {
  // A textured plane at a disparity of 12.3 px, with noise of two grey levels.
  constexpr int width = 320, height = 240;
  std::mt19937 random(1);
  const auto image = [&](double shift) {
    GreyLevels grey{width, height, std::vector<float>(width * height)};
    for (int i = 0; i < width * height; ++i) {
      const double u = i % width + shift, v = i / width;
      const double stripes = std::tanh(3 * std::sin(0.0011 * u * u + std::sin(0.09 * v)));
      const double waves = std::tanh(3 * std::sin(0.11 * u - 0.07 * v + 0.0004 * v * v));
      const double noise = 7 * (0x1p-32 * random() - 0.5);
      grey.values[i] = static_cast<float>(128 + 40 * stripes + 40 * waves + noise);
    }
    return grey;
  };
  const RectifiedPair pair{image(0), image(12.3f)};
  const StereoTruth truth =
      stereo_truth({width, height, std::vector<float>(width * height, 12.3f)});

  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  for (const Matcher& matcher : {edge_matcher(), Matcher{"blocks", match_blocks}}) {
    const auto found = matcher.match(pair, edges, {.min_px = 0, .max_px = 32});
    const MatcherScore score = evaluate(edges, found, truth_at(truth, edges), width);
    std::printf("%-6s %5d edges, density %.3f, beyond 1 px %4.1f %%, rms of the rest %.3f px\n",
                matcher.name.c_str(), score.all.edges, score.all.density, 100 * score.all.bad_1,
                score.all.rms_inlier_px);
  }
}
