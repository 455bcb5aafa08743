// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "cli/program/namespaces.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// The formats in which rigs are read.
enum class RigFormat { vernier, mrcal, opencv, kalibr, ros, colmap, asl, kitti };

inline constexpr const char* rig_format_names =
    "vernier, mrcal, opencv, kalibr, ros, colmap, asl, kitti";
std::string_view name(RigFormat format);
/// Throws Error (`option`) for a name that is none of the above.
RigFormat rig_format(const std::string& name, const std::string& option);

/// The format of an input from its name and, for .yaml, .yml and .txt, its content. Throws Error if
/// undetermined.
RigFormat input_format(const std::filesystem::path& input);

/// The one format of the files of a rig. Throws Error if it is undetermined or not one.
RigFormat input_format(const std::vector<std::filesystem::path>& inputs);

/// The rig that was read, with notes for the user.
struct ReadRig {
  RigEstimate estimate;
  std::vector<std::string> notes;
  std::optional<Pose> T_body_first = {};  ///< of the first camera on its carrier, where stated
};

ReadRig read_rig_as(RigFormat format,
                    const std::vector<std::filesystem::path>& inputs,
                    const ImportOptions& options);

/// Warns of cameras that are so far from the first that the file may be in millimetres, and says to
/// "add" --unit-m 0.001, or in other words to `do_what` with it.
void warn_of_far_cameras(const Rig& rig, const std::string& do_what, const Session& session);

/// A rig by what an option `--rig` names: a rig.json, a shipped name, a file or folder of another
/// tool, or several files of one, left first, separated by commas. Warnings and notes go to the
/// session. `image` is a file whose size is that of all cameras where the format does not state
/// one; empty: none. Throws Error naming the file.
ReadRig read_named_rig(const std::string& name, Session& session, const std::string& image = "");

/// The same; throws Error also unless the rig has two cameras.
ReadRig read_stereo_rig(const std::string& name, Session& session, const std::string& image = "");

/// The files that read_named_rig() reads, which no output may overwrite.
std::vector<std::filesystem::path> files_of_named_rig(const std::string& name);

/// The files that are read with a rig's files: COLMAP's beside cameras.txt, ASL's in a folder.
std::vector<std::filesystem::path> files_read(RigFormat format,
                                              std::vector<std::filesystem::path> inputs);

}  // namespace vernier::cli
