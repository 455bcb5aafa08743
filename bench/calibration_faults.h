// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"

namespace vernier::bench {

/// Views of a board with what they show: the truth of a simulation, or the solution of a real set.
/// Faults move the corners by the difference between two predictions, so noise and model errors
/// stay those of the set.
struct CalibrationCase {
  BoardObservations observations;
  BoardState truth;
  CalibrationOptions options;
};

/// A fault of one class, in several sizes.
struct CalibrationFault {
  std::string name;
  std::string unit;
  std::vector<double> sizes;
  std::vector<std::string> words;  ///< a message with one of these names the fault
  std::function<void(CalibrationCase&, double size, std::mt19937_64&)> apply;
};

std::vector<CalibrationFault> calibration_faults();

/// A simulated pair of cameras with views of a board. Everything is drawn from the seed: image
/// size, focal length, lens model, baseline, board, 8 to 60 views, noise of 0.05 to 0.4 px,
/// distance.
CalibrationCase simulated_case(std::uint64_t seed);

/// The frames of a set whose place (0, 1, …, n − 1) is `kept`.
CalibrationCase subset_of(const CalibrationCase& whole,
                          const std::function<bool(std::size_t place, std::size_t n)>& kept);

}  // namespace vernier::bench
