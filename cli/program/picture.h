// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// From blue for 0 over green to red for 1, blue-green-red.
cv::Scalar blue_to_red(double share);

/// The bytes of a PNG.
std::string png_of(const cv::Mat& picture);

/// A picture as a PNG, which appears whole or not at all.
void write_png(const cv::Mat& picture, const std::filesystem::path& file);

}  // namespace vernier::cli
