// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier {

/// A rig file as read, with its warnings: unknown keys, which are kept, and the trust warnings of
/// its calibration.
struct RigFile {
  RigEstimate estimate;
  std::vector<std::string> warnings;
  std::vector<std::string> listed;  ///< its parameter_names; the rest of the rig has no variance
  std::vector<Eigen::Index> listed_places;  ///< their indices among the rig's parameters
};

/// "rig.json: stored warning: ", the beginning of a warning that repeats a trust warning of the
/// file's calibration.
std::string stored_warning_prefix(const std::string& place);

/// The parameters that the file lists, with their covariance, as a prior. Throws Error(`place`) if
/// it has no covariance.
GaussianRigPrior gaussian_rig_prior(const RigFile& file, const std::string& place);

/// Reads a rig.json (format "vernier/rig", version 1; docs/file-formats.md). Required are format,
/// version and cameras; parameter_names, parameters and covariance come together and must agree
/// with the cameras. Parameters that are not listed have no variance; held parameters must be
/// parameters of the rig. Throws Error naming file and key, and the line for malformed JSON.
RigFile read_rig(const std::filesystem::path& file);
RigFile parse_rig(const std::string& text, const std::string& place);

enum class KeepEvidence { yes, no };

/// Text of a rig.json; numbers in the shortest form that reads back equal. Throws Error naming the
/// key if a number is not finite, which JSON cannot represent, and for a covariance that reading
/// refuses: other names than the rig's parameters, not symmetric, a negative variance.
std::string format_rig(const RigEstimate& estimate, KeepEvidence evidence = KeepEvidence::yes);
void write_rig(const RigEstimate& estimate,
               const std::filesystem::path& file,
               KeepEvidence evidence = KeepEvidence::yes);

}  // namespace vernier
