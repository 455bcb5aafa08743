// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Started by itself.
void f() {
  std::thread([] {}).join();
}
