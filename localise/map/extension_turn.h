// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace vernier::localise::internal {

/// The turn of one process, or thread, to extend the map in a file. Others wait for its end and
/// then find the file that it left, so that nothing that was added is lost. The system ends the
/// turn of a process that ends in any way. Where the file cannot be locked nobody waits, and the
/// last one wins.
class ExtensionTurn {
 public:
  explicit ExtensionTurn(const std::filesystem::path& file);
  ~ExtensionTurn();
  ExtensionTurn(const ExtensionTurn&) = delete;
  ExtensionTurn& operator=(const ExtensionTurn&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace vernier::localise::internal
