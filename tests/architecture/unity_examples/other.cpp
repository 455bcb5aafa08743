// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Names that unity_test.py must find twice; never compiled.
namespace vernier {
namespace {

using Same = int;
using Bins = long;
constexpr double second_m = 3;
int table[3] = {1, 2, 3};
auto chosen = 6;
int beside(int x) { return x; }
struct Part {};
int qualified(const string& x) { return x.size(); }
int overloaded(double x) { return static_cast<int>(x); }
long with_default(int x, const char* name = "x") { return x; }

}  // namespace
}  // namespace vernier
