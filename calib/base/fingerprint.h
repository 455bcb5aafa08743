// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace vernier::internal {

/// FNV-1a hash (64 bits, hexadecimal) of a text, to compare contents.
std::string fingerprint(const std::string& text);

}  // namespace vernier::internal
