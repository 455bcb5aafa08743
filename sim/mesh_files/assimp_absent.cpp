// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <vector>

#include "calib/error.h"
#include "sim/import/mesh.h"
#include "sim/mesh_files/mesh_file.h"

namespace vernier::sim::internal {

Mesh read_with_assimp(const std::filesystem::path& file, const std::vector<std::string>&) {
  throw Error(file.string(), "cannot be read, because assimp was missing when Vernier was built",
              "install Debian's libassimp-dev and rebuild, or convert it to PLY");
}

std::string assimp_version() { return ""; }

}  // namespace vernier::sim::internal
