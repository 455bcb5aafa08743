// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig.h"
#include "cli/program/session.h"
#include "stereo/grey_levels.h"

namespace vernier::cli {

/// An image as grey levels; what was done to colour or more than 8 bits is said.
GreyLevels read_image(const std::string& file, Session& session);

/// Throws Error where both images are the same one.
void check_two_images(const RectifiedPair& pair, const std::string& left, const std::string& right);

/// The raw images of a pair of cameras. Throws Error where the rig (`rig_name`) is none, a file is
/// not of its camera's size or both are the same image.
RectifiedPair read_camera_images(const Rig& rig,
                                 const std::string& rig_name,
                                 const std::string& left,
                                 const std::string& right,
                                 Session& session);

}  // namespace vernier::cli
