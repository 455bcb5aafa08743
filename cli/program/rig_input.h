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
/// Throws Error (`option`), which lists `supported`, for a name that is none of the above.
RigFormat rig_format(const std::string& name,
                     const std::string& option,
                     const std::string& supported = rig_format_names);

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

/// A rig by what an option `--rig` names: a rig.json, a shipped name, a file or folder of another
/// tool, or several files of one, left first, separated by commas. Warnings and notes go to the
/// session. `images` are one of each camera, left first, or one of all: their sizes are the
/// cameras' where the file does not state any; empty names: none. Throws Error naming the file.
ReadRig read_named_rig(const std::string& name,
                       Session& session,
                       const std::vector<std::string>& images = {});

/// The same; throws Error also unless the rig has two cameras.
ReadRig read_stereo_rig(const std::string& name,
                        Session& session,
                        const std::vector<std::string>& images = {});

/// Warns of cameras so far apart that the file is probably in millimetres; `remedy` is what to do
/// then. A rig.json is in metres.
void warn_of_millimetres(RigFormat format,
                         const Rig& rig,
                         const std::string& remedy,
                         Session& session);

/// The files that read_named_rig() reads, which no output may overwrite.
std::vector<std::filesystem::path> files_of_named_rig(const std::string& name);

/// The files that are read with a rig's files: COLMAP's beside cameras.txt, ASL's in a folder.
std::vector<std::filesystem::path> files_read(RigFormat format,
                                              std::vector<std::filesystem::path> inputs);

}  // namespace vernier::cli
