// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// The simulator's sources in the eleven Middlebury pairs. Nothing in the measuring was fitted to
// them; the limits here are wide and only say that the figures stay what docs/characterise.md has.
#include <gtest/gtest.h>

#include "sim/sources/measured_sources.h"
#include "stereo/edge_matcher.h"
#include "stereo/evaluation/pair_samples.h"
#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/grey_levels.h"
#include "stereo/stereo_truth.h"
#include "tests/support/data_folder.h"
#include "tests/support/foreign_files.h"
#include "tests/support/scene_files.h"
#include "tests/support/stereo_scenes.h"

namespace vernier {

using namespace vernier::sim::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

PairSamples samples_of(const StereoSceneFile& files) {
  const RectifiedPair pair{read_grey_levels(files.left), read_grey_levels(files.right)};
  const StereoTruth truth = read_stereo_truth(files, pair.left.width_px, pair.left.height_px);
  PairSamples samples = pair_samples(pair, truth, files.range, edge_matcher());
  samples.name = files.name;
  return samples;
}

TEST(MeasuredSourcesOfMiddlebury, AreWhatIsDocumented) {
  const auto folder = test::data_folder();
  if (!folder) GTEST_SKIP() << "VERNIER_DATA is not set";
  const test::Folder scratch;
  std::vector<PairSamples> pairs;
  for (const test::StereoScene& scene : test::middlebury_scenes(*folder)) {
    pairs.push_back(samples_of(test::files_of(scene, scratch.path())));
  }
  const MeasuredSources s = measure_sources(pairs);
  const auto expect = [](const char* name, const MeasuredValue& measured, double low, double high) {
    testing::Test::RecordProperty(name, std::to_string(measured.value));
    EXPECT_TRUE(measured.value > low && measured.value < high) << name << " " << measured.value;
    EXPECT_LE(measured.interval.low, measured.value) << name;
    EXPECT_GE(measured.interval.high, measured.value) << name;
  };
  EXPECT_TRUE(s.by_pair);
  expect("edge_loss", s.edge_loss.share, 0.13, 0.19);
  expect("edge_loss_to_left", s.edge_loss.to_left, 0.13, 0.19);
  expect("on_no_edge", s.edge_loss.on_edges, 0.04, 0.09);
  expect("independent_shift_px", s.lateral_shift.independent_px, 0.02, 0.1);
  expect("endpoint_across_px", s.endpoints.across_px, 0.05, 0.1);
  expect("corner_loss", s.corners.loss, 0.12, 0.23);
  expect("corner_mismatch", s.corners.mismatch, 0, 0.02);
  expect("stereo_mismatch", s.stereo_mismatch.share, 0.003, 0.02);
}

}  // namespace
}  // namespace vernier
