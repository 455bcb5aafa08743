// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier {

/// A rig file as read, with what deserves a warning: unknown keys, which are kept, and
/// what its calibration doubts.
struct RigFile {
  RigEstimate estimate;
  std::vector<std::string> warnings;
  std::vector<std::string> listed;  ///< its parameter_names; the rest of the rig has no variance
  std::vector<Eigen::Index> listed_places;  ///< where they stand among the rig's parameters
};

/// "rig.json says of itself: ", how a warning begins that repeats a doubt of the file's
/// calibration.
std::string stored_warning_prefix(const std::string& place);

/// What the file says about the parameters it lists, as a prior. Throws Error(`place`) where it
/// has no covariance.
GaussianRigPrior gaussian_rig_prior(const RigFile& file, const std::string& place);

/// Reads a rig.json (format "vernier/rig", version 1; docs/file-formats.md). Needed are format,
/// version and cameras; parameter_names, parameters and covariance come together and must agree
/// with the cameras. Parameters that are not listed have no variance; what is held must be one of
/// the rig's. Throws Error naming file and key, and the line for malformed JSON.
RigFile read_rig(const std::filesystem::path& file);
RigFile parse_rig(const std::string& text, const std::string& place);

enum class KeepEvidence { yes, no };

/// Text of a rig.json; numbers in the shortest form that reads back equal. Throws Error naming the
/// key where a number is not finite, which JSON cannot say.
std::string format_rig(const RigEstimate& estimate, KeepEvidence evidence = KeepEvidence::yes);
void write_rig(const RigEstimate& estimate,
               const std::filesystem::path& file,
               KeepEvidence evidence = KeepEvidence::yes);

}  // namespace vernier
