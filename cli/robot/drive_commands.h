// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/base/json_node.h"
#include "cli/program/namespaces.h"
#include "sim/differential_drive.h"

namespace vernier::cli {

/// The commands of a file, all checked: lines of JSON, or of CSV under a header with the same names
/// (docs/file-formats.md). "-": standard input. Throws Error with file and line.
std::vector<DriveCommand> read_commands(const std::string& file, const DifferentialDrive& drive);

/// What a program says to an observation: a command, or nothing if it is done. Throws Error.
std::optional<DriveCommand> parse_drive_answer(const vernier::internal::JsonNode& answer,
                                               const DifferentialDrive& drive);

}  // namespace vernier::cli
