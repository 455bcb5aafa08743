// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace vernier::cli {

/// The program and the machine that it runs on, in a line: "vernier 0.1, Intel Xeon …, 8 cores,
/// AVX3".
std::string program_and_machine();

}  // namespace vernier::cli
