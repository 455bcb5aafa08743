// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// One, and a name that says nothing.
void f() { run({.threads = 1}); }
