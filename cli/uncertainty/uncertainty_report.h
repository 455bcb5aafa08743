// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/covariance.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/triangulation.h"
#include "calib/triangulation_uncertainty.h"
#include "calib/uncertainty/sampled_propagation.h"
#include "stereo/rectification/vertical_disparity.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

struct UncertaintyRequest {
  std::vector<double> distances_m{1, 5};  ///< along the ray; may include infinity
  int columns = 60, rows = 45;            ///< of the grids
  double pair_sigma_px = 0;               ///< noise of a matched pixel coordinate
  SamplingOptions sampling;
};

/// A reference pixel for single values: the image centre, or a corner moved inwards by a tenth of
/// the image size.
struct Place {
  std::string name;
  Eigen::Vector2d pixel_px;
};

struct ProjectionFigure {
  Place place;
  std::optional<Eigen::Matrix2d> linear;  ///< px²; empty if the pixel has no ray
  SampledPixel sampled;
};

struct ProjectionReport {
  std::string camera;
  PointFixedTo fixed_to = PointFixedTo::boards;
  double distance_m = 0;  ///< infinity for points fixed to the camera (not used)
  ProjectionGrid grid;
  double mean_sd_px = 0, worst_sd_px = 0;  ///< over the grid, in the worst direction of each point
  Eigen::Vector2d worst_at_px{0, 0};
  std::vector<ProjectionFigure> figures;
};

struct TriangulationReport {
  std::string camera;  ///< the second camera of the pair
  TriangulationFrame frame = TriangulationFrame::rig;
  double distance_m = 0;
  Place place;
  PixelPair pair;
  TriangulatedPoint linear;
  SampledPoint sampled;        ///< calibration error only
  SampledPoint sampled_total;  ///< including matching noise
};

struct DisparityFigure {
  Place place;
  double linear_sd_px = 0;
  SampledDisparity sampled;
};

struct DisparityReport {
  std::string camera;
  double distance_m = 0;
  VerticalDisparityMap map;
  double worst_sd_px = 0;
  std::vector<DisparityFigure> figures;  ///< only points visible in both cameras
};

struct DepthReport {
  std::string camera;
  std::vector<DepthUncertainty> ranges;
};

/// All results of `vernier uncertainty`.
struct UncertaintyReport {
  CovarianceKind kind = CovarianceKind::mvb;
  UncertaintyRequest request;
  double board_sigma_px = 0;  ///< 0 if the boards are unknown
  std::vector<ProjectionReport> projection;
  std::vector<TriangulationReport> triangulation;
  std::vector<DisparityReport> vertical_disparity;
  std::vector<DepthReport> depth;
  std::vector<std::string> notes;  ///< what could not be computed, and why
};

/// Computed from `estimate.covariance` (for the bound, store it there).
UncertaintyReport uncertainty_report(const RigEstimate& estimate,
                                     const UncertaintyRequest& request,
                                     const std::string& place);

}  // namespace vernier::cli
