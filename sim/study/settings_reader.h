// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <toml++/toml.h>

#include <filesystem>
#include <string>

#include "calib/base/toml_reader.h"
#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/pgh.h"
#include "localise/place.h"
#include "sim/corner_appearance.h"
#include "sim/experiment.h"
#include "sim/sources.h"

namespace vernier::sim::internal {

/// Sets "section.entry" of a study to a value of its sweep.
void set_swept(toml::table& study, const std::string& key, const toml::node& value);

/// Reads the settings of an experiment from the tables of a study file.
class SettingsReader : public vernier::internal::TomlReader {
 public:
  using TomlReader::TomlReader;

  /// The tables [study] (seed and protocol), [sources], [corners], [camera], [map], [localiser]
  /// and [histograms] of a study; `sources` are those that it starts from.
  ExperimentSettings read_settings(const toml::table& root, const SourceSettings& sources) const;

  void read_sources(const toml::table& table, SourceSettings& sources) const;

 protected:
  /// A table of the root, or null if absent.
  const toml::table* section(const toml::table& root, const char* name) const {
    const toml::node* node = root.get(name);
    return node ? &table(*node, fmt::format("[{}]", name)) : nullptr;
  }
  double number_in(const toml::node& node, const std::string& what, double low, double high) const;
  template <class Parse>
  auto word(const toml::node& node, const std::string& what, Parse parse) const {
    const std::string said = text(node, what);
    try {
      return parse(said);
    } catch (const Error& error) {
      fail(node, error.place() + ": " + error.fault(), error.remedy());
    }
  }

  /// A command line of a program.
  std::string command(const toml::node& node, const std::string& what) const;

 private:
  void read_own_sources(const toml::table& table, SourceSettings& sources) const;
  void read_camera(const toml::table& table, localise::CameraMount& mount) const;
  void read_map(const toml::table& table, ExperimentSettings& settings) const;
  void read_corners(const toml::table& table, AppearanceOptions& appearance) const;
  void read_localiser(const toml::table& table, ExperimentSettings& settings) const;
  void read_views(const toml::table& table, localise::LocaliserOptions& options) const;
  /// Options of pairwise geometric histograms, as a study names them.
  void read_histograms(const toml::table& table, localise::PghOptions& options) const;
  void read_program(const toml::table& table, ExperimentSettings& settings) const;
};

/// Applies a file whose table [sources] holds settings as a study's does, such as `characterise`
/// writes, to `sources`. Throws Error with file and line for anything else in it, and for a `file`
/// of its own.
void read_sources_file(const std::filesystem::path& file, SourceSettings& sources);

}  // namespace vernier::sim::internal
