// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/base/output_files.h"
#include "calib/rig.h"
#include "cli/program/namespaces.h"
#include "sim/images/image_truth.h"
#include "sim/images/rendered_pair.h"
#include "sim/images/true_edges.h"

namespace vernier::cli {

/// One pose, rendered, with its truth.
struct RenderedView {
  RenderedPair pair;
  PairTruth truth;
  TrueEdges edges;
};

/// Names of the files of one pose, in its folder.
const std::vector<std::filesystem::path>& view_file_names();

/// Adds the files of one pose (docs/images.md) in a folder.
void add_view_files(OutputFiles& outputs,
                    const std::filesystem::path& folder,
                    const RectifiedView& view,
                    const RenderedView& rendered);

/// The entry of pairs.toml for a pose whose files are in `folder`, relative to the list.
std::string pair_toml(const std::string& name, const std::string& folder, const PairTruth& truth);

}  // namespace vernier::cli
