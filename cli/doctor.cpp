// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <ceres/version.h>
#include <sqlite3.h>
#include <tbb/version.h>

#include <Eigen/Core>
#include <cstdlib>
#include <opencv2/core/version.hpp>
#include <thread>

#include "calib/mrcal/mrcal_problem.h"
#include "calib/mrcal/mrcal_uncertainty.h"
#include "cli/session.h"
#include "cli/share_folder.h"
#include "localise/bhattacharyya.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

/// One thing looked for.
struct Finding {
  std::string what, value;
  bool found = true;
};

Finding file_finding(const std::string& what, const fs::path& path, const std::string& remedy) {
  const bool there = fs::exists(path);
  return {what, there ? "found" : "missing: " + remedy, there};
}

/// The sample images where Debian installs them, or unpacked below the current folder.
Finding image_finding() {
  const fs::path below = "usr/share/doc/opencv-doc/examples/data";
  for (const fs::path& folder : {"/" / below, "build/opencv-doc" / below}) {
    if (fs::exists(folder / "left01.jpg")) {
      return {"real chessboard pairs", "found in " + folder.string()};
    }
  }
  return {"real chessboard pairs",
          "missing: install Debian's opencv-doc, or unpack it into build/opencv-doc", false};
}

Finding library_finding() {
  const bool there = mrcal_available();
  return {"mrcal, C library",
          there ? mrcal_version()
                : "missing: install Debian's libmrcal-dev and build again, for vernier check",
          there};
}

Finding python_finding(const fs::path& share) {
  const std::string version = mrcal_python_version(share / "python" / "mrcal_uncertainty.py");
  return {"mrcal, Python",
          version.empty() ? "missing: install Debian's python3-mrcal, for vernier check" : version,
          !version.empty()};
}

std::vector<Finding> findings() {
  const fs::path share = share_folder();
  const char* data = std::getenv("VERNIER_DATA");
  const bool plotly = fs::exists(share / "page" / "plotly-cartesian.min.js") ||
                      fs::exists(share / "page" / "node_modules" / "plotly.js-cartesian-dist-min");
  return {
      {"vernier", VERNIER_VERSION},
      {"compiler", __VERSION__},
      {"instruction set of kernels", std::string(target_name())},
      {"processors", std::to_string(std::thread::hardware_concurrency())},
      {"Ceres", CERES_VERSION_STRING},
      {"Eigen",
       fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"OpenCV", CV_VERSION},
      {"oneTBB", fmt::format("{}.{}", TBB_VERSION_MAJOR, TBB_VERSION_MINOR)},
      {"SQLite", sqlite3_libversion()},
      {"shipped data",
       share.empty() ? "missing: set VERNIER_SHARE" : share.lexically_normal().string(),
       !share.empty()},
      file_finding("world workshop", share / "worlds" / "workshop.world.toml", "install again"),
      file_finding("rig nominal", share / "rigs" / "nominal.rig.json", "install again"),
      file_finding("report page", share / "page" / "report.html", "install again"),
      {"report plots (plotly)",
       plotly ? "found" : "missing: run npm ci in cli/page; pages hold tables only", plotly},
      library_finding(),
      python_finding(share),
      image_finding(),
      {"VERNIER_DATA",
       data ? (fs::is_directory(data) ? "found" : "names no folder")
            : "not set: tests on larger data sets are skipped",
       data != nullptr && fs::is_directory(data)},
  };
}

void run(Session& session) {
  Json json = Json::array();
  std::string text;
  for (const Finding& finding : findings()) {
    json.push_back({{"what", finding.what}, {"value", finding.value}, {"found", finding.found}});
    text += fmt::format("{} {:<28} {}\n", finding.found ? " " : "-", finding.what, finding.value);
  }
  session.result({{"findings", json}}, text);
}

}  // namespace

void add_doctor(CLI::App& app, Session& session) {
  CLI::App* verb =
      add_verb(app, session, "doctor", "what this build and this machine have", "vernier doctor");
  verb->callback([&session] { session.action = [&session] { run(session); }; });
}

}  // namespace vernier::cli
