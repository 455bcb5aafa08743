// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "sim/study/work_units.h"

/// What the ranks of a study tell each other, as JSON texts.
namespace vernier::sim::internal {

/// From a rank at its start: what it is about to work on, and with what.
struct Hello {
  std::string work;             ///< work_fingerprint()
  std::string instruction_set;  ///< of its processor
  std::string host;             ///< name of its machine
};
/// To a rank: there is work; blocks are among it, or queries only.
struct Welcome {
  bool has_blocks = true;
};
/// From a rank that has prepared itself: how many units it computes at a time.
struct Ready {
  int threads = 1;
};
/// To a rank: a unit, under a number.
struct Assigned {
  std::int64_t number = 0;
  WorkUnit unit;
};
/// From a rank: what the unit with this number gave.
struct Computed {
  std::int64_t number = 0;
  UnitResult result;
};
/// From a rank: an Error, or another exception, with all its text in `fault`.
struct Failed {
  std::string place, fault, remedy;
  bool internal = false;
};
/// From a rank that was asked to stop, after its last result: it takes no further units.
struct Left {};
/// To a rank: no more is to be done.
struct End {};

using RankMessage = std::variant<Hello, Welcome, Ready, Assigned, Computed, Failed, Left, End>;

std::string rank_text(const RankMessage& message);
/// Throws Error for a text that rank_text does not write.
RankMessage parse_rank_text(const std::string& text);

/// The exception in flight as a message; to be called in a catch block.
Failed current_failure();

}  // namespace vernier::sim::internal
