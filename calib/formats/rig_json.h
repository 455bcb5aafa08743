// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calib/base/json_node.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

/// Internal to calib/: JSON of the parts of a rig file. Not installed.
namespace vernier::internal::rig_json {

using Json = nlohmann::ordered_json;

using Node = JsonNode;

/// Parses the text of a rig file (calib/base/json_reader.h). Throws Error, also if it is of another
/// format.
Json parse_rig_json(const std::string& text, const std::string& place);

Json to_json(const Eigen::VectorXd& v);
Json to_json(const Eigen::MatrixXd& m);

/// Throws Error if a value is beyond `most` in magnitude.
void check_bounded(const Eigen::MatrixXd& values, double most, const Node& node);

/// Cameras with their poses, within the limits of calib/camera/rig_limits.h.
Json cameras_json(const Rig& rig);
Rig parse_cameras(const Node& node);

/// Index of the camera of that name. Throws Error if the rig has none.
int camera_index(const Node& name, const Rig& rig);

/// The strings listed under `key`; empty if it is missing.
std::vector<std::string> parse_texts(const Node& node, const std::string& key);

Json summary_json(const CalibrationSummary& summary, const Rig& rig);
CalibrationSummary parse_summary(const Node& node, const Rig& rig);

/// Throws Error if the summary at `node` cannot be that of the evidence: its counts, the corners
/// and pairs it names, and its sum of squared residuals.
void check_summary(const CalibrationSummary& summary,
                   const CalibrationEvidence& evidence,
                   const Node& node);

Json to_json(const PairOutlier& outlier);
PairOutlier parse_pair_outlier(const Node& node);

/// Boards and pairs; priors have the form of rig files (calib/formats/rig_file.cpp).
Json evidence_json(const CalibrationEvidence& evidence, const Rig& rig);
CalibrationEvidence parse_evidence(const Node& node, const Rig& rig);

}  // namespace vernier::internal::rig_json
