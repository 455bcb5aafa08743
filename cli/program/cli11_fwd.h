// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// CLI11's classes by name. CLI/CLI.hpp costs three seconds in each source that includes it; only
/// the sources that add options do.
namespace CLI {
class App;
class Option;
class ParseError;
}  // namespace CLI
