// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <string>

#include "calib/error.h"

namespace vernier::test {

/// What the Error of `call` says; empty where it throws none.
inline std::string error_message(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Its place, fault and remedy apart.
inline std::array<std::string, 3> error_parts(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return {error.place(), error.fault(), error.remedy()};
  }
  return {};
}

}  // namespace vernier::test
