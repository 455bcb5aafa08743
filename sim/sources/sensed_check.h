// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/error.h"
#include "sim/sense.h"

namespace vernier::sim::internal {

/// The observation. Throws Error if a source of one's own has failed, so that it is worth nothing.
inline const StereoObservation& require_sensed(const StereoObservation& seen) {
  if (!seen.failure.empty()) {
    throw Error("source of one's own", seen.failure, "correct it (docs/own-source.md)");
  }
  return seen;
}

}  // namespace vernier::sim::internal
