// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig.h"
#include "cli/program/session.h"
#include "stereo/grey_levels.h"

namespace vernier::cli {

/// Reads an image as grey levels; reports conversions from colour or from more than 8 bits.
GreyLevels read_image(const std::string& file, Session& session);

/// Throws Error if both images are identical.
void check_two_images(const RectifiedPair& pair, const std::string& left, const std::string& right);

/// Reads the raw images of a stereo pair. Throws Error if the rig (`rig_name`) does not have two
/// cameras, an image size differs from its camera's, or both images are identical.
RectifiedPair read_camera_images(const Rig& rig,
                                 const std::string& rig_name,
                                 const std::string& left,
                                 const std::string& right,
                                 Session& session);

}  // namespace vernier::cli
