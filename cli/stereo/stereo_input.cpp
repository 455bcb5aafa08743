// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/stereo_input.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/error.h"
#include "calib/estimate/rig_part.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "cli/program/camera_images.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/stereo/side_by_side.h"
#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matching/matcher_input.h"
#include "stereo/rectification.h"
#include "stereo/rectification/vertical_field.h"
#include "stereo/rectified_images.h"

namespace vernier::cli {
namespace {

constexpr double nearly_all = 0.9;  // of an image
constexpr int default_range = 4;    // width divided by the largest disparity

void check(const StereoInputOptions& o) {
  if (o.rig.empty() && !o.rectified) {
    throw Error("stereo", "no rig given", "give --rig for unrectified images, or --rectified");
  }
  const bool values = o.f_px > 0 || o.baseline_m > 0 || !o.centre_px.empty() || o.offset_px != 0;
  if (!values) return;
  if (!o.rectified || !o.rig.empty()) {
    throw Error(
        "--f-px, --baseline-m, --centre-px, --offset-px",
        "only valid for rectified images without a rig file",
        o.rig.empty() ? "add --rectified" : "leave them out: the rig file contains these values");
  }
  if (!(o.f_px > 0) || !(o.baseline_m > 0)) {
    throw Error(o.f_px > 0 ? "--baseline-m" : "--f-px", "missing; needed for depth",
                "give both --f-px and --baseline-m, or neither");
  }
}

/// Throws Error for a range that cannot be, naming the option, of those that are given, and for a
/// pair that cannot be matched.
void check_pair(const StereoInputOptions& o,
                const RectifiedPair& pair,
                const DisparityRange& range) {
  check_range(range, pair.left.width_px,
              o.max_disparity_px ? "--max-disparity" : "--min-disparity");
  check_matcher_input(pair, range, o.right);
}

void take_raw(const StereoInputOptions& o, StereoInput& input, Session& session) {
  const Rig& rig = input.estimate->rig;
  require_pair(rig, o.rig, o.rig);
  require_side_by_side(rig, o.rig);
  const RectifiedGeometry geometry = with_errors_of(o.rig, [&] { return rectified_geometry(rig); });
  const RectifiedPair raw = read_camera_images(rig, o.rig, o.left, o.right, session);
  RectifiedImages images = rectified_images(rig, geometry, raw.left, raw.right, o.threads);
  input.geometry = geometry;
  const double blank = std::max(images.left_valid.blank_share(), images.right_valid.blank_share());
  if (blank > nearly_all) {
    throw Error(o.rig, fmt::format("{:.0f} % of a rectified image is blank", 100 * blank),
                "check its cameras' poses: they do not look the same way");
  }
  check_pair(o, images.pair, input.range);
  input.field = vertical_field(images, input.range);
  input.pair = std::move(images.pair);
  input.left_valid = std::move(images.left_valid);
  input.right_valid = std::move(images.right_valid);
  if (rig.cameras[0].size_px != rig.cameras[1].size_px) return;
  input.exchanged = [rig, geometry, raw, threads = o.threads] {
    return rectified_images(rig, geometry, raw.right, raw.left, threads).pair;
  };
}

/// Takes the cameras of rectified images from a rig file or the command line.
void take_cameras(const StereoInputOptions& o, StereoInput& input, Session& session) {
  const Eigen::Vector2i size(input.pair.left.width_px, input.pair.left.height_px);
  if (!o.rig.empty()) {
    input.estimate = read_named_rig(o.rig, session, {o.left, o.right}).estimate;
    input.geometry = geometry_of_rectified_rig(input.estimate->rig);
    if (!input.geometry || input.geometry->size_px != size) {
      throw Error(
          o.rig,
          fmt::format("not a rectified rig: two parallel pinhole cameras of {}x{} px are required",
                      size[0], size[1]),
          "leave out --rectified, or give the rig.json written by vernier rectify");
    }
    const auto& cameras = input.estimate->rig.cameras;
    input.offset_px = cameras[1].ox_px() - cameras[0].ox_px();
  } else if (o.f_px > 0) {
    RectifiedGeometry g;
    g.turn = {Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()};
    g.f_px = o.f_px;
    g.baseline_m = o.baseline_m;
    g.size_px = size;
    if (o.centre_px.empty()) {
      g.centre_px = 0.5 * (size - Eigen::Vector2i::Ones()).cast<double>();
      session.warn("no --centre-px: using the image centre");
    } else {
      const std::vector<double> centre = parse_numbers(o.centre_px, 2, "--centre-px");
      g.centre_px = {centre[0], centre[1]};
      const Eigen::Array2d in_image = g.centre_px.array() / size.cast<double>().array();
      if (in_image.minCoeff() < 0 || in_image.maxCoeff() > 1) {
        session.warn(fmt::format(
            "--centre-px {}: outside the image of {}x{} px, which only a cropped image's can be",
            o.centre_px, size[0], size[1]));
      }
    }
    input.geometry = g;
    input.offset_px = o.offset_px;
  }
}

/// Searches as far as points at infinity, whose disparity is minus the offset, unless told
/// otherwise.
void reach_infinity(const StereoInputOptions& o, StereoInput& input, Session& session) {
  const double infinity_px = -std::round(input.offset_px);
  if (o.min_disparity_px || infinity_px >= input.range.min_px) return;
  if (infinity_px <= -input.pair.left.width_px) {
    throw Error(o.rig.empty() ? "--offset-px" : o.rig,
                fmt::format("the principal points are {:.6g} px apart, in images {} px wide",
                            input.offset_px, input.pair.left.width_px),
                "give the right principal point minus the left one, in pixels");
  }
  input.range.min_px = static_cast<int>(infinity_px);
  session.info(fmt::format(
      "disparities from {} px are searched: the principal points are {:.6g} px apart, so that far "
      "points have negative ones; --min-disparity sets another limit",
      input.range.min_px, input.offset_px));
}

void take_rectified(const StereoInputOptions& o, StereoInput& input, Session& session) {
  check_pair(o, input.pair, input.range);
  check_two_images(input.pair, o.left, o.right);
  take_cameras(o, input, session);
  reach_infinity(o, input, session);
  input.field = vertical_field(input.pair, input.range);
  input.exchanged = [other = exchanged(input.pair)] { return other; };
}

void repair_rows(bool wanted, StereoInput& input, Session& session) {
  const VerticalField& field = input.field;
  if (field.unrectified) return;
  if (!field.known) session.warn("row alignment could not be checked: " + describe(field));
  if (field.known && (wanted || field.significant)) session.info(describe(field));
  if (!field.significant) return;
  if (wanted) {
    correct_right(field, input.pair);
    input.repaired = true;
  } else if (!field.misaligned) {
    session.warn("the rows are slightly misaligned; --repair corrects this");
  }
}

int width_of(const StereoInputOptions& o, StereoInput& input, Session& session) {
  if (!o.rectified) {
    input.estimate = read_named_rig(o.rig, session, {o.left, o.right}).estimate;
    return input.estimate->rig.cameras.at(0).size_px[0];
  }
  input.pair = {read_image(o.left, session), read_image(o.right, session)};
  return input.pair.left.width_px;
}

}  // namespace

StereoInput read_stereo_input(const StereoInputOptions& options, Session& session) {
  check(options);
  StereoInput input;
  const int width = width_of(options, input, session);
  const int least_px = options.min_disparity_px.value_or(0);
  input.range = {least_px,
                 options.max_disparity_px.value_or(std::max(least_px + 1, width / default_range))};
  if (options.rectified) {
    take_rectified(options, input, session);
  } else {
    take_raw(options, input, session);
  }
  repair_rows(options.repair, input, session);
  return input;
}

void drop_blank_matches(const StereoInput& input,
                        const std::vector<EdgePoint>& edges,
                        std::vector<EdgeDisparity>& found) {
  if (!input.right_valid) return;
  const ValidPixels& right = *input.right_valid;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!found[i].matched()) continue;
    const auto x = static_cast<int>(std::lround(edges[i].pixel_px.x() - found[i].disparity_px));
    const bool inside = x >= 0 && x < right.width_px;
    if (!inside || !right(x, edges[i].y)) found[i] = {};
  }
}

}  // namespace vernier::cli
