// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/cli11_fwd.h"
#include "cli/program/session.h"
#include "cli/simulation/source_options.h"
#include "localise/place.h"
#include "localise/view_file.h"

namespace vernier::cli {

/// Where views come from: a simulated robot, a file of features, or pairs of images.
struct ViewOptions {
  std::string world, features, left, right, poses, rig;
  double height_m = 1.2, pitch_deg = 0;
  int max_disparity_px = 0;
  SourceOptions sources;  ///< of a simulated robot
  std::uint64_t seed = 1;
  bool corners = false;  ///< of a simulated robot or images: views hold corners

  CameraMount mount() const;
  /// The rig's name; "nominal" for a simulated robot if none is given.
  std::string rig_or_default() const { return rig.empty() ? "nominal" : rig; }
};

void add_view_options(CLI::App& verb, ViewOptions& options);

/// Throws Error unless exactly one kind of view is given, with what it needs.
void check(const ViewOptions& options, const CLI::App& verb);

/// The views of a file or of images, with poses where they are known. `names` are those of the
/// views for messages and tables.
struct NamedViews {
  std::vector<RecordedLooks> views;
  std::vector<std::string> names;
};
NamedViews read_recorded(const ViewOptions& options, Session& session);

}  // namespace vernier::cli
