// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sim/mesh_files/mesh_file.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier::test {

/// What is said of a mesh with this text, its folder left out.
inline std::string mesh_file_message(const std::string& name, const std::string& text) {
  const Folder folder;
  const std::filesystem::path file = folder.write(name, text);
  std::string said = error_message([&] { sim::internal::read_mesh(file); });
  const std::string path = folder.path().string() + "/";
  if (const std::size_t at = said.find(path); at != std::string::npos) said.erase(at, path.size());
  return said;
}

}  // namespace vernier::test
