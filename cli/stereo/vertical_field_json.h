// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/program/session.h"
#include "stereo/rectification/vertical_field.h"

namespace vernier::cli {

/// A vertical field as JSON (docs/rectification.md); unknown values are null.
Json vertical_field_json(const VerticalField& field, bool repaired);

/// Why a misaligned pair is not to be trusted, to be followed by what to do.
std::string misalignment(const VerticalField& field);

}  // namespace vernier::cli
