// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace vernier::internal {

/// A connection to a program that is about to start, both ends closed by the destructor. It is a
/// socket, so that sending to a program that has ended is an error and no signal. Our end does not
/// block; neither has the number of a standard stream, nor is it inherited.
class ProgramStream {
 public:
  ProgramStream();  ///< throws Error if none can be made
  ~ProgramStream();
  ProgramStream(const ProgramStream&) = delete;
  ProgramStream& operator=(const ProgramStream&) = delete;

  int ours() const { return ends_[0]; }  ///< -1 once closed
  int theirs() const { return ends_[1]; }
  void close_ours();
  void close_theirs();

 private:
  std::array<int, 2> ends_{-1, -1};
};

}  // namespace vernier::internal
