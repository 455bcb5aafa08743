// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <map>
#include <string>

#include "sim/study/settings_reader.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"

namespace vernier::sim::internal {

/// Reads [system] and [parameters] of a study.
class SystemReader : public SettingsReader {
 public:
  using SettingsReader::SettingsReader;

  /// Throws Error for an unknown system or option, a value out of its range, and a table or key of
  /// the study that the system does not use.
  SystemSettings read(const toml::table& root) const;

  /// Throws Error for a key that cannot be swept though it is of [system].
  void check_sweep_key(const toml::table& root, const std::string& key, const toml::node& at) const;

 private:
  const SystemKind& kind_of(const toml::table& root) const;
  std::string value_of(const toml::node& node, const SystemOption& option) const;
  void read_options(const toml::table& section,
                    const SystemKind& kind,
                    SystemSettings& settings) const;
  void read_names(const toml::node& node, SystemSettings& settings) const;
  void read_parameters(const toml::table& section, SystemSettings& settings) const;
  void check_use(const toml::table& root, const SystemKind& kind) const;
  void refuse(const toml::table& root,
              const char* section,
              const char* key,
              const SystemKind& kind) const;
};

/// Throws Error for an option that no cell of the study uses, as a command where no matcher is a
/// program.
void check_options_are_used(const StudyFile& study);

/// The system's settings by dotted key.
std::map<std::string, std::string> settings_of(const SystemSettings& system);

/// Whether trials are the same whatever the setting is, by its dotted key: what counts as a
/// success.
bool applies_on_reading(const std::string& key);

/// Whether a setting of an experiment, by its dotted key, is of those that the system uses.
bool uses_setting(const SystemKind& kind, const std::string& key);

}  // namespace vernier::sim::internal
