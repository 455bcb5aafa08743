// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sense.h"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "sim/uncertainty_source.h"
#include "stereo/rectification.h"

namespace vernier::sim {

using namespace stereo;

namespace {

/// Throws Error for what a sensor cannot be made of.
std::vector<std::unique_ptr<UncertaintySource>> checked_sources(const SourceSettings& settings,
                                                                double min_length_px,
                                                                const Rig& rig) {
  check(settings, "sources");
  if (!(min_length_px >= 0) || !std::isfinite(min_length_px)) {
    throw Error("sensor", "the least length of a line is negative or not finite",
                "give it in pixels");
  }
  return standard_sources(settings, min_length_px, rig);
}

}  // namespace

Sensor::Sensor(const Rig& true_rig, const SourceSettings& settings, double min_length_px)
    : rig_(true_rig),
      rectification_(rectification(true_rig)),
      sources_(checked_sources(settings, min_length_px, true_rig)) {}

StereoObservation Sensor::sense(const NoiseFreeView& look,
                                const SensingDraw& draw,
                                const AfterSource& after) const {
  SensedView view;
  view.edges.reserve(look.edges.size());
  for (const VisibleEdge& edge : look.edges) view.edges.emplace_back().truth = edge;
  for (const VisibleCorner& corner : look.corners) {
    const auto pixel = [&](int eye) {
      return project(rig_.cameras[eye], rig_.T_camera_first[eye] * corner.at_m);
    };
    view.corners.push_back({corner, {pixel(0), pixel(1)}, false});
  }
  const SensingContext context{rig_,       rectification_, draw.seed,
                               draw.trial, draw.frame,     {look.pose.x_m, look.pose.y_m}};
  for (const auto& source : sources_) {
    source->apply(context, view);
    if (after) after(*source, view);
    if (!view.failure.empty()) break;
  }

  StereoObservation sighting;
  sighting.segments.reserve(view.edges.size());
  for (const SensedEdge& edge : view.edges) {
    if (!edge.in_stereo) {
      sighting.left_only.push_back(image_of(rig_, edge, 0));
      continue;
    }
    sighting.segments.push_back(
        {image_of(rig_, edge, 0), image_of(rig_, edge, 1), edge.truth.feature * 2 + edge.piece});
    sighting.true_edges.push_back(edge.truth);
  }
  sighting.corners = std::move(view.corners);
  sighting.failure = std::move(view.failure);
  return sighting;
}

}  // namespace vernier::sim
