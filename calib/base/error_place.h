// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "calib/error.h"

namespace vernier::internal {

/// The error with `file` before its place, unless its place begins with it or is an option of the
/// command line.
inline Error error_of(const std::string& file, const Error& error) {
  if (error.place().rfind(file, 0) == 0 || error.place().rfind("--", 0) == 0) return error;
  return {file + ": " + error.place(), error.fault(), error.remedy()};
}

/// What `work` returns; every Error it throws names `file`, whose content it works with.
template <class Work>
decltype(auto) with_errors_of(const std::string& file, Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const Error& error) {
    throw error_of(file, error);
  }
}

}  // namespace vernier::internal
