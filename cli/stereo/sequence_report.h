// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/program/session.h"
#include "sim/sequence/measured_sequence.h"

namespace vernier::cli {

Json sequence_json(const sim::internal::MeasuredSequence& sequence);
std::string sequence_text(const sim::internal::MeasuredSequence& sequence);

}  // namespace vernier::cli
