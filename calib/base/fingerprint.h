// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace vernier::internal {

/// A short fingerprint of a text (FNV-1a, 64 bits, hexadecimal), to tell contents apart.
std::string fingerprint(const std::string& text);

}  // namespace vernier::internal
