// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calib/base/toml_reader.h"
#include "sim/told/fresh_calibrations.h"

namespace vernier::sim::internal {

/// What a study tells the estimator of its true rig, which is the same in all cells.
struct ToldSettings {
  enum class Error {
    drawn,  ///< truth ⊕ ψ_c times a draw from the covariance of `file`
    given,  ///< truth ⊕ ψ_c times the difference of the rig of `file` from it
  };

  std::string truth;  ///< file of the true rig; empty: rig.file, whose covariance is drawn from
  std::string file;   ///< rig that is told; empty: the true one's, or a fresh calibration
  Error error = Error::drawn;
  std::optional<FreshCalibrationOptions> calibration;
  std::string model;         ///< name of calibration.model; empty: those of the true rig
  std::string observations;  ///< file of real corners; empty: simulated
};

/// Reads [rig] and [calibration] of a study.
class ToldReader : public vernier::internal::TomlReader {
 public:
  using TomlReader::TomlReader;

  ToldSettings read(const toml::table& root) const;
  /// Throws Error for what is missing and not among the keys of the sweep.
  void check_complete(const toml::table& root, const std::vector<std::string>& swept) const;
  /// Throws Error for a rig that is told by file in a study with [calibration].
  void check_told_once(const toml::table& root) const;

 private:
  const toml::table* part(const toml::table& root, const char* name) const;
  double length(const toml::table& section, const char* key, double otherwise, double most) const;
  void read_calibration(const toml::table& section, ToldSettings& settings) const;
  void read_board(const toml::table& section, ToldSettings& settings) const;
};

/// The settings by dotted key: none for a study without rig.truth and [calibration].
std::map<std::string, std::string> settings_of(const ToldSettings& told);

/// The same without the board of simulated views where the corners of a rig file have their own.
std::map<std::string, std::string> shown_settings_of(const ToldSettings& told);

/// Keys of settings that are names of files, whose content counts instead.
bool names_a_file(const std::string& key);

}  // namespace vernier::sim::internal
