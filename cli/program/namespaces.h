// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vernier::internal {}
namespace vernier::stereo::internal {}
namespace vernier::localise::internal {}
namespace vernier::sim::internal {}

namespace vernier::cli {

// The program uses the whole library, including internals.
using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;
using namespace vernier::localise;
using namespace vernier::localise::internal;
using namespace vernier::sim;
using namespace vernier::sim::internal;

}  // namespace vernier::cli
