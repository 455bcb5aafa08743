// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/uncertainty_source.h"

#include <memory>
#include <vector>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "sim/sources.h"
#include "sim/sources/source_factories.h"
#include "stereo/segment.h"

namespace vernier::sim {

using namespace internal;
using namespace stereo;

ImageSegment image_of(const Rig& rig, const SensedEdge& edge, int eye) {
  const auto pixel = [&](const Eigen::Vector3d& x, int end) -> Eigen::Vector2d {
    return project(rig.cameras[eye], rig.T_camera_first[eye] * x) + edge.offset_px[eye][end];
  };
  return {pixel(edge.truth.a_m, 0), pixel(edge.truth.b_m, 1)};
}

std::vector<std::unique_ptr<UncertaintySource>> standard_sources(const SourceSettings& s,
                                                                 double min_length_px) {
  if (!s.command.empty()) {
    throw Error("sources.command", "is there without a rig", "use standard_sources with a rig");
  }
  std::vector<std::unique_ptr<UncertaintySource>> sources;
  if (s.unseen > 0) sources.push_back(make_unseen_edges(s));
  if (s.missed > 0) sources.push_back(make_missed_edges(s));
  if (s.clutter > 0) sources.push_back(make_clutter(s, min_length_px));
  if (s.lateral_shift_px > 0) sources.push_back(make_lateral_shift(s));
  if (s.merge_px > 0) sources.push_back(make_line_merging(s));
  if (s.edge_loss > 0) sources.push_back(make_edge_loss(s, min_length_px));
  if (s.endpoint_sigma_px > 0) sources.push_back(make_endpoint_error(s));
  if (s.epipolar_reject_deg > 0) sources.push_back(make_epipolar_rejection(s));
  if (s.stereo_mismatch > 0) sources.push_back(make_stereo_mismatch(s));
  if (s.corner_loss > 0) sources.push_back(make_corner_loss(s));
  if (s.corner_sigma_px > 0) sources.push_back(make_corner_error(s));
  if (s.corner_mismatch > 0) sources.push_back(make_corner_mismatch(s));
  for (const OwnSource& own : s.own) sources.push_back(make_own(own));
  return sources;
}

std::vector<std::unique_ptr<UncertaintySource>> standard_sources(const SourceSettings& s,
                                                                 double min_length_px,
                                                                 const Rig& rig) {
  if (s.command.empty()) return standard_sources(s, min_length_px);
  SourceSettings all_but_program = s;
  all_but_program.command.clear();
  auto sources = standard_sources(all_but_program, min_length_px);
  sources.push_back(make_program_source(s, rig));
  return sources;
}

}  // namespace vernier::sim
