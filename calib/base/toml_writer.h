// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <string>

namespace vernier::internal {

/// TOML text of a table, which parse_toml() reads as the same: lists on one line, tables under
/// headers. toml++ 3.3 writes tables too, but its measure of a list's width is undefined for
/// numbers below 0.1. The table holds no dates or times.
std::string toml_text(const toml::table& root);

}  // namespace vernier::internal
