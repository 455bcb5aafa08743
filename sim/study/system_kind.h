// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/experiment.h"

namespace vernier::sim::internal {

class SystemUnderTest;
struct SystemSetup;

/// A key of [system] that a kind of system has of its own.
struct SystemOption {
  enum class Type {
    number,   ///< `low` to `high`
    whole,    ///< the same, without fraction
    word,     ///< one of `words`
    text,     ///< anything
    command,  ///< words of a command line
    names,    ///< list of names of what a trial measures, each once; not swept
  };

  std::string name;
  Type type = Type::number;
  std::string usual = {};  ///< default, as in SystemSettings; empty: it must be given
  double low = 0, high = 0;
  std::vector<std::string> words = {};
  /// A word of another option with which alone this one counts: "matcher", "program".
  std::pair<std::string, std::string> only_with = {};
};

/// What a trial of a kind measures beside its error.
struct MeasuredQuantity {
  std::string name;             ///< column
  std::string meaning;          ///< in words, for the report
  bool of_either_sign = false;  ///< tables tell its RMS, not its median
};

/// What a study tries: the table [system] of its file.
struct SystemSettings {
  std::string name = "localiser";
  double success_error = success_radius_m;        ///< an answer is right up to this error
  std::map<std::string, std::string> options;     ///< those of its kind that count, as text
  std::map<std::string, std::string> parameters;  ///< of [parameters], as JSON
  std::vector<std::string> measured_names;        ///< of TrialResult::measured

  bool is_localiser() const { return name == "localiser"; }
  /// Of options that count.
  double number(const std::string& option) const;
  int whole(const std::string& option) const;
  const std::string& text(const std::string& option) const;
  /// The program that it runs; empty if it runs none.
  std::string command() const;
};

/// Which of the sources of error act on a system.
enum class SourcesUsed { none, calibration, all };

/// A kind of system that studies can try.
struct SystemKind {
  std::string name;
  std::string noun;         ///< in messages: "a calibration"
  std::string error_name;   ///< column of its error, with the unit: "depth_error_m"
  std::string error_title;  ///< the same on axes: "depth error"
  std::string unit;         ///< "m"; empty: none
  double success_error = std::numeric_limits<double>::quiet_NaN();  ///< default; NaN: to be given
  double largest_error = std::numeric_limits<double>::infinity();   ///< 1 for a share
  std::vector<SystemOption> options = {};
  std::vector<MeasuredQuantity> measured = {};  ///< options of type `names` add to them
  /// Tables of a study file that it uses besides [study], [system], [rig], [sweep] and [tune].
  std::vector<std::string> sections = {};
  SourcesUsed sources = SourcesUsed::none;
  bool uses_protocol = false;  ///< study.protocol
  bool tells_rigs = false;     ///< the estimator may be told another rig than the true one
  /// Its trials are calibrations, with or without [calibration]: one that fails is a result.
  bool calibrates = false;
  bool is_program = false;  ///< a user's program and no more: one start tries it for all its cells
  bool uses_opencv =
      false;        ///< which is then held to one thread, as a study has threads of its own
  int version = 0;  ///< of its results: raised when the same settings give others
  /// Null for localisers, which the engine runs itself, as their cells share maps.
  std::function<std::unique_ptr<SystemUnderTest>(const SystemSetup&)> make = {};

  bool uses(std::string_view section) const;
};

/// Makes a kind known to studies, once at the start of a program; replaces one of the same name.
/// Not while studies are read or run.
void register_system(SystemKind kind);

/// Throws std::out_of_range if there is none of the name.
const SystemKind& system_kind(const std::string& name);

/// Ascending, "localiser" among them.
std::vector<std::string> system_names();

}  // namespace vernier::sim::internal
