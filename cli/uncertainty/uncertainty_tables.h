// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/projection_uncertainty.h"
#include "calib/triangulation_uncertainty.h"
#include "cli/program/session.h"
#include "cli/uncertainty/uncertainty_report.h"

namespace vernier::cli {

/// Grid contents in the JSON: full covariances, or standard deviations to five digits (for a page).
enum class GridDetail { covariances, deviations };

Json uncertainty_json(const UncertaintyReport& report, GridDetail detail);

/// Human-readable tables with values as linear / sampled.
std::string uncertainty_text(const UncertaintyReport& report);

/// Writes uncertainty.json (grids as deviations), projection.csv, triangulation.csv,
/// vertical_disparity.csv, depth.csv, and for every map a CSV of its grid and an SVG picture.
/// Returns the file names.
std::vector<std::string> write_uncertainty(const UncertaintyReport& report,
                                           const std::filesystem::path& folder);

/// A distance in file names and tables: "1m", "inf".
std::string distance_label(double distance_m);
std::string_view fixed_to_label(PointFixedTo fixed_to);
std::string_view frame_label(TriangulationFrame frame);

}  // namespace vernier::cli
