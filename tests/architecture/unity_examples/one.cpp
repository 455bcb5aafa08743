// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Names that unity_test.py must find twice; never compiled.
namespace vernier {
namespace {

using Same = int;
using Bins = int;
constexpr double first_m = 1, second_m = 2;
int table[3] = {1, 2, 3};
auto chosen = 5;
constexpr double of_header = 2;
constexpr std::array<std::pair<int, int>, 1> beside{{{1, 0}}};
struct Part {};
class OfHeader {};
int qualified(const std::string& x) { return x.size(); }
int overloaded(int x) { return x; }
int with_default(int x, const char* y = "") { return x; }

}  // namespace
}  // namespace vernier
