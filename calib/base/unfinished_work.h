// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <mutex>

namespace vernier::internal {

/// What a process must clean up if it ends early: temporary files and folders, running programs.
/// It is global, as signals are; a program that ends by a signal calls
/// abandon_unfinished_work().

enum class Unfinished {
  file,          ///< removed
  folder,        ///< removed with its content
  empty_folder,  ///< removed if it is empty
};

/// Call it before the file or folder is made, so that no moment is missed.
void note_unfinished(const std::filesystem::path& path, Unfinished kind);
void forget_unfinished(const std::filesystem::path& path) noexcept;

/// A running program, which leads a process group of its own.
void note_child(pid_t child);
void forget_child(pid_t child) noexcept;

/// While it is held, abandon_unfinished_work() waits: for the renames of one set of outputs, which
/// must not be cut in two, and for the start of a program.
std::unique_lock<std::recursive_mutex> hold_off_abandoning();

/// Kills the programs, with what they started, and removes the files and folders noted; needs no
/// memory but for folders with content. From then on every other function of this header blocks for
/// ever, so that other threads make nothing new while the process ends.
void abandon_unfinished_work() noexcept;

}  // namespace vernier::internal
