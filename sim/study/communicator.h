// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace vernier::sim::internal {

/// A text from another process.
struct Message {
  int from = 0;  ///< its rank
  std::string text;
};

/// Texts between the processes (ranks) that work on one study, as MPI numbers them: 0 hands out. In
/// order and complete between two ranks. Used from one thread.
class Communicator {
 public:
  Communicator() = default;
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  virtual int rank() const = 0;
  virtual int size() const = 0;
  /// Does not wait for the other rank to receive, which this rank's later calls may help.
  virtual void send(int to, const std::string& text) = 0;
  /// The next text, if one has come.
  virtual std::optional<Message> receive() = 0;
};

}  // namespace vernier::sim::internal
