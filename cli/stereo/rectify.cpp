// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/output_files.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/estimate/rig_part.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "cli/program/camera_images.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/picture.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/stereo/side_by_side.h"
#include "cli/stereo/vertical_field_json.h"
#include "stereo/grey_levels.h"
#include "stereo/image/matrix_of.h"
#include "stereo/rectification.h"
#include "stereo/rectification/raw_pixels.h"
#include "stereo/rectification/rectification_covariance.h"
#include "stereo/rectification/vertical_field.h"
#include "stereo/rectified_images.h"

namespace vernier::cli {
namespace {

constexpr int grid_columns = 40, grid_rows = 30;  // for averaging standard deviations
constexpr double default_disparity = 0.05;        // fraction of the width, if no depth is given
constexpr int width_by_disparity = 4;             // width divided by the largest disparity

struct RectifyArguments {
  std::string rig, left, right, output, size;
  RectifiedGeometryOptions geometry;
  VerticalFieldOptions field;
  double at_m = 0;
  int max_disparity_px = 0;
  bool repair = false, masks = false;
  int threads = 0;
};

/// Effect of the rig's covariance over the left image, for points at one depth.
struct Deviations {
  double at_m = 0, disparity_px = 0;
  int pixels = 0;  ///< grid pixels visible in both cameras
  double rms_disparity_px = 0, rms_vertical_px = 0;
};

std::optional<Deviations> deviations(const RigEstimate& estimate,
                                     const RectifiedGeometry& geometry,
                                     double at_m) {
  if (!estimate.covariance) return std::nullopt;
  const RectificationUncertainty uncertainty(estimate.rig, estimate.covariance->matrix, geometry);
  const RawPixels left(estimate.rig, geometry, 0), right(estimate.rig, geometry, 1);
  Deviations d;
  d.at_m = at_m > 0 ? at_m : geometry.depth_m(default_disparity * geometry.size_px[0]);
  d.disparity_px = geometry.disparity_px(d.at_m);
  Eigen::Vector2d sum(0, 0);
  for (int j = 0; j < grid_rows; ++j) {
    for (int i = 0; i < grid_columns; ++i) {
      const Eigen::Vector2d at((geometry.size_px[0] - 1.0) * i / (grid_columns - 1),
                               (geometry.size_px[1] - 1.0) * j / (grid_rows - 1));
      const Eigen::Vector2d other = at - Eigen::Vector2d(d.disparity_px, 0);
      if (!left.in_image_at(at) || !right.in_image_at(other)) continue;
      const auto covariance = uncertainty.covariance_px2(at, d.disparity_px);
      if (!covariance) continue;
      sum += covariance->diagonal();
      ++d.pixels;
    }
  }
  d.rms_disparity_px = std::sqrt(sum[0] / d.pixels);
  d.rms_vertical_px = std::sqrt(sum[1] / d.pixels);
  return d;
}

/// Rectified images and their vertical alignment.
struct Rectified {
  RectifiedGeometry geometry;
  RectifiedImages images;
  VerticalField field;
};

int most_disparity_px(const RectifiedGeometry& geometry, const RectifyArguments& options) {
  return options.max_disparity_px > 0 ? options.max_disparity_px
                                      : geometry.size_px[0] / width_by_disparity;
}

Rectified rectify(const Rig& rig,
                  const RectifiedGeometry& geometry,
                  const GreyLevels& left,
                  const GreyLevels& right,
                  const RectifyArguments& options) {
  Rectified r;
  r.geometry = geometry;
  r.images = rectified_images(rig, r.geometry, left, right, options.threads);
  r.field = vertical_field(r.images, {0, most_disparity_px(geometry, options)}, options.field);
  return r;
}

/// What else may be the reason where the axes of the cameras meet at a disparity that is not
/// searched: of a rig that converges, what both see in the middle of their images.
std::string convergence(const Rig& rig,
                        const RectifiedGeometry& geometry,
                        const RectifyArguments& options) {
  constexpr double degrees = 180 / std::numbers::pi;
  std::array<std::optional<Eigen::Vector2d>, 2> middle;
  for (int c = 0; c < 2; ++c) {
    const Camera& camera = rig.cameras[c];
    middle[c] = rectified_pixel(rig, geometry, c, {camera.ox_px(), camera.oy_px()});
  }
  if (!middle[0] || !middle[1]) return "";
  const double disparity_px = middle[0]->x() - middle[1]->x();
  if (disparity_px <= most_disparity_px(geometry, options)) return "";
  // Angle of an optical axis in the epipolar plane; rotation about the baseline is no convergence.
  const auto angle = [](const Eigen::Matrix3d& R_rectified_camera) {
    const Eigen::Vector3d axis = R_rectified_camera.col(2);
    return std::atan2(axis.x(), axis.z());
  };
  const double converging =
      angle(geometry.turn.R_rectified_left) - angle(geometry.turn.R_rectified_right);
  return fmt::format(
      ". The cameras converge by {:.0f} degrees: what is in the middle of both has a disparity of "
      "{:.0f} px here, beyond the {} px that were searched; give a larger --max-disparity, and a "
      "smaller --f-px with a wider --size, so that both images keep it",
      degrees * converging, disparity_px, most_disparity_px(geometry, options));
}

/// Adds trust warnings if the rows are not aligned.
void check_alignment(const Rectified& rectified,
                     const Rig& rig,
                     const GreyLevels& left,
                     const GreyLevels& right,
                     const RectifyArguments& options,
                     Session& session) {
  const VerticalField& field = rectified.field;
  constexpr double nearly_all = 0.9;
  const double blank = std::max(rectified.images.left_valid.blank_share(),
                                rectified.images.right_valid.blank_share());
  if (blank > nearly_all) {
    const std::string words = fmt::format("{:.0f} % of a rectified image is blank", 100 * blank);
    if (options.size.empty() && !(options.geometry.f_px > 0)) {
      throw Error(options.rig, words, "check its cameras' poses: they do not look the same way");
    }
    session.add_trust_warning(words + "; check --f-px and --size");
    return;
  }
  constexpr double much = 0.1;
  if (blank > much && options.size.empty() && !(options.geometry.f_px > 0)) {
    session.warn(
        fmt::format("{:.0f} % of a rectified image is blank, at the largest focal length "
                    "that is tried; give a larger --f-px, or another --size",
                    100 * blank));
  }
  if (!field.unrectified && !field.known) {
    const std::string words =
        "row alignment of the rectified images could not be checked: " + describe(field) +
        convergence(rig, rectified.geometry, options);
    if (field.corners == 0) {
      session.add_trust_warning(words);
    } else {
      session.warn(words);
    }
  }
  if (field.misaligned && !field.unrectified && !options.repair) {
    session.add_trust_warning(misalignment(field) +
                              "--repair corrects this, a calibration of today its cause");
  }
  if (!field.unrectified) return;
  if (!field.known && rig.cameras[0].size_px == rig.cameras[1].size_px) {
    const VerticalField exchanged = rectify(rig, rectified.geometry, right, left, options).field;
    if (exchanged.known && !exchanged.unrectified) {
      session.add_trust_warning(
          fmt::format("left and right appear to be swapped: {} corners match as given, {} after "
                      "swapping; swap --left and --right, or the cameras of the rig",
                      field.matched, exchanged.matched));
      return;
    }
  }
  session.add_trust_warning("the rows of the rectified images are not aligned: " + describe(field) +
                            "; check that the rig matches the current cameras, that the images are "
                            "simultaneous and that --max-disparity is large enough" +
                            convergence(rig, rectified.geometry, options));
}

std::string png(const GreyLevels& image) { return png_of(bytes_of(image)); }

GreyLevels mask(const ValidPixels& valid) {
  GreyLevels image{valid.width_px, valid.height_px, {}};
  for (const std::uint8_t v : valid.values) image.values.push_back(v ? 255.0F : 0.0F);
  return image;
}

using Contents = std::vector<std::pair<std::filesystem::path, std::string>>;

Contents contents(const Rig& rig,
                  const RectifiedGeometry& geometry,
                  const RectifiedImages& images,
                  const RectifyArguments& options) {
  const std::filesystem::path folder = options.output;
  RigEstimate rectified;
  rectified.rig = rectified_rig(rig, geometry);
  Contents files{{folder / "left.png", png(images.pair.left)},
                 {folder / "right.png", png(images.pair.right)},
                 {folder / "rig.json", format_rig(rectified)}};
  if (options.masks) {
    files.emplace_back(folder / "left_valid.png", png(mask(images.left_valid)));
    files.emplace_back(folder / "right_valid.png", png(mask(images.right_valid)));
  }
  return files;
}

Json result_json(const RectifiedGeometry& g,
                 const RectifiedImages& images,
                 const std::optional<Deviations>& d,
                 Json field,
                 const Contents& files,
                 const Session& session) {
  Json names = Json::array();
  for (const auto& [name, content] : files) names.push_back(name.string());
  Json uncertainty;
  if (d && d->pixels > 0) {
    uncertainty = {{"at_m", d->at_m},
                   {"disparity_px", d->disparity_px},
                   {"grid_pixels", d->pixels},
                   {"rms_disparity_sd_px", d->rms_disparity_px},
                   {"rms_vertical_sd_px", d->rms_vertical_px}};
  }
  return {
      {"f_px", g.f_px},
      {"centre_px", {g.centre_px[0], g.centre_px[1]}},
      {"size_px", {g.size_px[0], g.size_px[1]}},
      {"baseline_m", g.baseline_m},
      {"blank",
       {{"left", images.left_valid.blank_share()}, {"right", images.right_valid.blank_share()}}},
      {"uncertainty", uncertainty},
      {"vertical_field", std::move(field)},
      {"doubts", session.trust_warnings()},
      {"files", names}};
}

std::string result_text(const RectifiedGeometry& g,
                        const RectifiedImages& images,
                        const std::optional<Deviations>& d,
                        const std::string& field,
                        const RectifyArguments& options,
                        std::size_t files) {
  std::string text = fmt::format(
      "images            {}x{} px, f {:.3f} px, centre ({:.3f}, {:.3f}) px\n"
      "baseline          {:.6g} m: depth = {:.6g} m px / disparity\n"
      "blank             {:.1f} % of the left image, {:.1f} % of the right\n",
      g.size_px[0], g.size_px[1], g.f_px, g.centre_px[0], g.centre_px[1], g.baseline_m,
      g.f_px * g.baseline_m, 100 * images.left_valid.blank_share(),
      100 * images.right_valid.blank_share());
  if (!d) {
    text += "rig's error       unknown: the rig file has no covariance\n";
  } else if (d->pixels == 0) {
    text +=
        fmt::format("rig's error       no point at {:.4g} m is visible in both images\n", d->at_m);
  } else {
    text += fmt::format(
        "rig's error       at {:.4g} m ({:.1f} px): disparity {:.3f} px, rows {:.3f} px (rms "
        "standard deviation over the image)\n",
        d->at_m, d->disparity_px, d->rms_disparity_px, d->rms_vertical_px);
  }
  return text + "vertical field    " + field +
         fmt::format("\n{} files written to {}\n", files, options.output);
}

void run(RectifyArguments options, Session& session) {
  if (!options.size.empty()) {
    const auto [width, height] = parse_size(options.size, "--size");
    constexpr int max_side = 20'000;
    constexpr double max_pixels = 1e8;
    if (width > max_side || height > max_side || double(width) * height > max_pixels) {
      throw Error(
          "--size",
          fmt::format("{}x{} is too large (limits: 20000 px per side, 1e8 pixels)", width, height),
          "give a smaller size");
    }
    options.geometry.size_px = {width, height};
  }
  const ReadRig file = read_named_rig(options.rig, session, {options.left, options.right});
  std::vector<std::filesystem::path> inputs = files_of_named_rig(options.rig);
  inputs.insert(inputs.end(), {options.left, options.right});
  const Rig& rig = file.estimate.rig;
  require_pair(rig, options.rig, options.rig);
  require_side_by_side(rig, options.rig);
  const RectifiedGeometry wanted =
      with_errors_of(options.rig, [&] { return rectified_geometry(rig, options.geometry); });
  const RectifiedPair raw =
      read_camera_images(rig, options.rig, options.left, options.right, session);
  Rectified rectified = rectify(rig, wanted, raw.left, raw.right, options);
  check_alignment(rectified, rig, raw.left, raw.right, options, session);
  auto& [geometry, images, field] = rectified;
  const bool repaired = options.repair && field.significant;
  if (repaired) correct_right(field, images.pair);
  std::string words = describe(field);
  if (options.repair) words += repaired ? "; repaired" : "; no repair needed";

  const Contents files = contents(rig, geometry, images, options);
  for (const auto& [name, content] : files) {
    check_output_is_not_input(inputs, name);
  }
  const auto d = deviations(file.estimate, geometry, options.at_m);
  OutputFiles outputs;
  outputs.add_folder(options.output);
  for (const auto& [name, content] : files) outputs.add(name, content);
  outputs.commit();
  session.result(
      result_json(geometry, images, d, vertical_field_json(field, repaired), files, session),
      result_text(geometry, images, d, words, options, files.size()));
}

}  // namespace

void add_rectify(CLI::App& app, Session& session) {
  auto o = std::make_shared<RectifyArguments>();
  CLI::App* verb = add_verb(app, session, "rectify",
                            "rectify a stereo pair so that epipolar lines are image rows",
                            "vernier rectify --rig rig.json --left left01.png --right right01.png "
                            "-o rectified");
  verb->add_option("--rig", o->rig, "rig file or shipped name")->required();
  verb->add_option("--left", o->left, "left image")->required();
  verb->add_option("--right", o->right, "right image")->required();
  verb->add_option(
      "--size", o->size,
      "size of the rectified images, WxH (default: the left camera's, its sides exchanged for "
      "cameras one above the other)");
  verb->add_option(
          "--f-px", o->geometry.f_px,
          "focal length of the rectified images (default: widest view with almost no blank pixels, "
          "at most 1.3 times the cameras')")
      ->check(finite_and_positive);
  verb->add_option("--at-m", o->at_m,
                   "depth at which the rig's error is reported (default: where the disparity is "
                   "1/20 of the width)")
      ->check(finite_and_positive);
  verb->add_option("--max-disparity", o->max_disparity_px,
                   "largest disparity of matched corners, px (default: a quarter of the width)")
      ->check(CLI::Range(1, 100'000));
  verb->add_option("--band", o->field.band_px,
                   "search range for matching corners, rows above and below")
      ->check(CLI::Range(1, 10))
      ->capture_default_str();
  verb->add_flag("--repair", o->repair,
                 "correct the right image by the estimated vertical field, if significant");
  verb->add_flag("--masks", o->masks,
                 "also write left_valid.png and right_valid.png (0: blank pixel)");
  verb->add_option("--threads", o->threads, "number of threads (0: all)")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  verb->add_option("-o,--output", o->output, "output folder for left.png, right.png and rig.json")
      ->required();
  check_folder_written(*verb, "--output");
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
