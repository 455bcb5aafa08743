// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <ceres/version.h>
#include <sqlite3.h>
#include <tbb/version.h>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core/version.hpp>
#include <string>
#include <thread>
#include <vector>

#include "calib/base/image_file.h"
#include "calib/base/instruction_set.h"
#include "calib/error.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/mrcal/mrcal_uncertainty.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/report/report_data.h"
#include "cli/verbs.h"
#include "sim/images/ray_scene.h"
#include "sim/mesh_files/mesh_file.h"
#include "sim/mpi/mpi_ranks.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

#ifdef __clang__
constexpr const char* compiler_name = __VERSION__;  // with the compiler's name
#else
constexpr const char* compiler_name = "GCC " __VERSION__;
#endif

/// One checked item.
struct Finding {
  std::string what, value;
  bool found = true;
};

Finding shipped_finding(const std::string& what, const fs::path& name) {
  const bool there = !shipped_file(name).empty();
  return {what, there ? "found" : "missing: reinstall vernier", there};
}

/// The page's template, and the script that is made of others when Vernier is built.
Finding page_finding() {
  const fs::path page = shipped_file("page/report.html");
  if (page.empty() || has_script(page.parent_path())) {
    return shipped_finding("report page", "page/report.html");
  }
  return {"report page",
          "no page script, because esbuild was missing: run scripts/install_packages.sh, "
          "reconfigure and "
          "rebuild",
          false};
}

Finding plots_finding() {
  const fs::path page = shipped_file("page/report.html");
  const bool there = !page.empty() && has_plots(page.parent_path());
  return {"report plots (plotly)",
          there ? "found"
                : "missing: pages have tables only; esbuild or plotly.js was missing, or "
                  "-DVERNIER_PAGE_PLOTS=OFF set; run scripts/install_packages.sh, reconfigure "
                  "and rebuild",
          there};
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

/// They are loaded at the first image, which may be hours into a run.
Finding codecs_finding() {
  try {
    decode_image(vernier::internal::png_of(cv::Mat::zeros(1, 1, CV_8U)), 0, "");
    return {"OpenCV, image codecs", "found"};
  } catch (const Error& error) {
    return {"OpenCV, image codecs", error.what(), false};
  }
}

Finding assimp_finding() {
  const std::string version = assimp_version();
  return {"assimp",
          !version.empty() ? version
                           : "missing: install Debian's libassimp-dev and rebuild; used by vernier "
                             "world import for OBJ, DAE, IFC and others",
          !version.empty()};
}

Finding embree_finding() {
  const std::string version = embree_version();
  return {"Embree",
          !version.empty() ? version
                           : "missing: install Debian's libembree-dev and rebuild; used by vernier "
                             "render",
          !version.empty()};
}

Finding mpi_finding() {
  const std::string version = mpi_version();
  return {"MPI",
          !version.empty()
              ? version
              : "missing: install Debian's libopenmpi-dev and rebuild; used by vernier "
                "study under mpirun",
          !version.empty()};
}

Finding world_view_finding() {
  const bool there = !shipped_file("page/three.js").empty();
  return {"three.js",
          there ? "found"
                : "missing: install Debian's libjs-three and esbuild, configure and "
                  "rebuild; used by vernier world view",
          there};
}

Finding library_finding() {
  const bool there = mrcal_available();
  return {"mrcal, C library",
          there ? mrcal_version()
                : "missing: install Debian's libmrcal-dev and rebuild; used by vernier check",
          there};
}

Finding python_finding() {
  const fs::path script = shipped_script("mrcal_uncertainty.py");
  if (script.is_relative()) {
    return {"mrcal, Python",
            "missing: share/vernier/python/" + script.string() + "; reinstall vernier", false};
  }
  const std::string version = mrcal_python_version(script);
  return {
      "mrcal, Python",
      version.empty() ? "missing: install Debian's python3-mrcal; used by vernier check" : version,
      !version.empty()};
}

Finding share_finding() {
  const std::vector<fs::path> folders = share_folders();
  if (folders.empty()) return {"shipped data", "missing: set VERNIER_SHARE", false};
  std::string names;
  for (const fs::path& folder : folders) {
    names += (names.empty() ? "" : ", then ") + folder.lexically_normal().string();
  }
  return {"shipped data", names};
}

std::vector<Finding> findings() {
  const char* data = std::getenv("VERNIER_DATA");
  return {
      {"vernier", VERNIER_VERSION},
      {"compiler", compiler_name},
      {"instruction set of kernels", std::string(instruction_set())},
      {"processors", std::to_string(std::thread::hardware_concurrency())},
      {"Ceres", CERES_VERSION_STRING},
      {"Eigen",
       fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"OpenCV", CV_VERSION},
      {"oneTBB", fmt::format("{}.{}", TBB_VERSION_MAJOR, TBB_VERSION_MINOR)},
      {"SQLite", sqlite3_libversion()},
      share_finding(),
      shipped_finding("world workshop", "worlds/workshop.world.toml"),
      shipped_finding("rig nominal", "rigs/nominal.rig.json"),
      page_finding(),
      plots_finding(),
      library_finding(),
      codecs_finding(),
      assimp_finding(),
      embree_finding(),
      mpi_finding(),
      world_view_finding(),
      python_finding(),
      image_finding(),
      {"VERNIER_DATA",
       data ? (fs::is_directory(data) ? "found" : "not a folder")
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
      add_verb(app, session, "doctor",
               "show build settings, library versions and optional components", "vernier doctor");
  verb->callback([&session] { session.action = [&session] { run(session); }; });
}

}  // namespace vernier::cli
