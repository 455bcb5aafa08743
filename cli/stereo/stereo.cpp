// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/output_files.h"
#include "calib/error.h"
#include "calib/statistics/quantile.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/stereo/disparity_picture.h"
#include "cli/stereo/matcher_names.h"
#include "cli/stereo/outside_range.h"
#include "cli/stereo/stereo_files.h"
#include "cli/stereo/stereo_input.h"
#include "cli/stereo/swapped_pair.h"
#include "cli/stereo/vertical_field_json.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/matching/external_matcher.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/space_segments.h"

namespace vernier::cli {
namespace {

constexpr double min_density = 0.2;    // warn if a smaller fraction of the edges is matched
constexpr double max_uncertain = 0.5;  // warn if a larger fraction of segments has uncertain depth

struct StereoArguments {
  StereoInputOptions input;
  SpaceSegmentOptions space;
  double min_angle_deg = 5;
  MatcherOptions matcher{"edge", {}, 0};
  std::string output, picture;
};

/// Medians over reconstructed segments, at their farther ends.
struct DepthFigures {
  double depth_m = 0, matching_m = 0, calibration_m = 0, relative = 0;
  double calibration_share = 0;  ///< fraction of the variance
  int placed = 0, linear = 0, reliable = 0;
};

DepthFigures depth_figures(const std::vector<MeasuredSegment>& segments) {
  DepthFigures f;
  std::vector<double> depth, matching, calibration, relative, share;
  for (const MeasuredSegment& s : segments) {
    if (s.status != SegmentStatus::placed) continue;
    ++f.placed;
    f.linear += s.linear;
    f.reliable += s.segment.reliable;
    const int z = s.segment.a_m.z() > s.segment.b_m.z() ? 2 : 5;
    const double own = s.independent_m2(z, z), common = s.calibration_m2(z, z);
    depth.push_back(std::max(s.segment.a_m.z(), s.segment.b_m.z()));
    matching.push_back(std::sqrt(own));
    calibration.push_back(std::sqrt(common));
    share.push_back(common / (own + common));
    relative.push_back(s.relative_sigma);
  }
  f.depth_m = median_or_zero(depth);
  f.matching_m = median_or_zero(matching);
  f.calibration_m = median_or_zero(calibration);
  f.calibration_share = median_or_zero(share);
  f.relative = median_or_zero(relative);
  return f;
}

/// Number of edges to match and of edges matched.
struct EdgesMatched {
  int asked = 0, matched = 0;
  double share() const { return static_cast<double>(matched) / std::max(1, asked); }
};

EdgesMatched edge_figures(const StereoResult& result, double min_angle_rad) {
  EdgesMatched f;
  for (std::size_t i = 0; i < result.edges.size(); ++i) {
    if (std::abs(result.edges[i].normal.x()) < std::sin(min_angle_rad)) continue;
    ++f.asked;
    f.matched += result.found[i].matched();
  }
  return f;
}

/// The edges of the left image at valid pixels.
std::vector<EdgePoint> edges_of(const StereoInput& input, const std::string& file) {
  CannyOptions canny;
  canny.noise = input.pair.left_noise.per_pixel();
  std::vector<EdgePoint> edges = canny_edges(input.pair.left, canny);
  if (input.left_valid) {
    std::erase_if(edges, [&](const EdgePoint& e) { return !(*input.left_valid)(e.x, e.y); });
  }
  if (edges.empty()) {
    constexpr float dim = 32;  // of 255
    const std::vector<float>& grey = input.pair.left.values;
    const float largest = *std::max_element(grey.begin(), grey.end());
    throw Error(file,
                largest < dim ? fmt::format("no edges found: its grey values end at {:.1f} % of "
                                            "their range",
                                            largest / 2.55)
                              : "no edges found",
                largest < dim ? "multiply the values of both images by one factor: those of 12 "
                                "bits in a 16-bit file by 16"
                              : "give a textured image");
  }
  return edges;
}

StereoResult look(const StereoArguments& options, const StereoInput& input) {
  MapRange map;
  MatcherOptions told = options.matcher;
  told.told = [&map](const MapRange& range) { map = range; };
  const Matcher matcher = single_matcher(told);
  StereoResult result;
  result.edges = edges_of(input, options.input.left);
  result.found = matcher.match(input.pair, result.edges, input.range);
  result.map = map;
  check_not_swapped(matcher, result.found, input.range, input.exchanged, options.input.left);
  drop_blank_matches(input, result.edges, result.found);
  result.segments = edge_segments(result.edges);
  SegmentDisparityOptions how;
  how.min_angle_rad = options.min_angle_deg * std::numbers::pi / 180;
  result.lines = segment_disparities(result.edges, result.segments, result.found, how);
  if (!input.geometry) return result;
  std::vector<SegmentDisparity> whole = result.lines;
  for (SegmentDisparity& line : whole) {
    line.a_disparity_px += input.offset_px;
    line.b_disparity_px += input.offset_px;
  }
  result.placed = input.estimate
                      ? space_segments(whole, *input.geometry, *input.estimate, options.space)
                      : space_segments(whole, *input.geometry, options.space);
  return result;
}

std::string sigma_words(const DepthFigures& f) {
  return fmt::format(
      "{:.3g} m from matching and {:.3g} m from the calibration at {:.3g} m (medians)",
      f.matching_m, f.calibration_m, f.depth_m);
}

void check_result(const StereoArguments& options,
                  const StereoInput& input,
                  const StereoResult& result,
                  const EdgesMatched& edges,
                  const DepthFigures& depth,
                  Session& session) {
  const std::string of_map = doubt_about(result.map, input.range.max_px);
  if (input.field.unrectified) {
    session.add_trust_warning(
        "the rows of the two images are not aligned: " + describe(input.field) +
        (options.input.rectified ? "; rectify the pair first (give --rig and leave out --rectified)"
                                 : "; check that the rig matches the current cameras and that the "
                                   "images are simultaneous"));
  } else if (input.field.misaligned && !input.repaired) {
    session.add_trust_warning(misalignment(input.field) +
                              (options.input.rectified
                                   ? "--repair corrects this"
                                   : "--repair corrects this, a calibration of today its cause"));
  } else if (!of_map.empty()) {
    session.add_trust_warning(of_map);
  } else if (!doubt_range(input, session) && edges.share() < min_density) {
    session.add_trust_warning(fmt::format(
        "too few matches: {} of {} edges; check that both images show the same scene at the same "
        "time, that rows are aligned and that disparities are between {} and {} px",
        edges.matched, edges.asked, input.range.min_px, input.range.max_px));
  }
  if (!input.geometry) return;
  if (depth.placed == 0) {
    if (!session.trust_warnings().empty()) return;  // for the reason given above
    session.add_trust_warning(
        "no segment could be reconstructed; segments.json gives the reason for each");
  } else if (depth.reliable == 0) {
    session.add_trust_warning(fmt::format(
        "no segment lies nearer than {:g} m, so that all count as unreliable: {}",
        options.space.max_depth_m,
        depth.linear == 0
            ? "the scene is too far for the baseline, or a value of the cameras is wrong"
            : "check the baseline and the focal length, or give a larger --max-depth-m"));
  } else if (depth.linear < (1 - max_uncertain) * depth.placed) {
    session.add_trust_warning(fmt::format(
        "the depth of {} of {} segments is uncertain by more than 10 %: {}; {}",
        depth.placed - depth.linear, depth.placed, sigma_words(depth),
        depth.calibration_share > 0.5
            ? fmt::format(
                  "{:.0f} % of the variance is due to the calibration: improve the calibration",
                  100 * depth.calibration_share)
            : "the scene is too far for the baseline"));
  } else if (depth.calibration_share > 0.5) {
    session.info(fmt::format(
        "note: {:.0f} % of the depth variance is due to the calibration and common to all segments",
        100 * depth.calibration_share));
  }
}

/// Number of segments by status; parts of a segment are counted separately.
std::map<std::string, int> refusals(const StereoResult& result) {
  std::map<std::string, int> counts;
  for (std::size_t i = 0; i < result.lines.size(); ++i) {
    const SegmentStatus own = result.lines[i].status;
    const SegmentStatus status =
        own == SegmentStatus::placed && !result.placed.empty() ? result.placed[i].status : own;
    ++counts[status_key(status)];
  }
  return counts;
}

Json result_json(const StereoArguments& options,
                 const StereoInput& input,
                 const StereoResult& result,
                 const EdgesMatched& edges,
                 const DepthFigures& depth) {
  Json segments{{"found", result.segments.size()}};
  for (const auto& [key, count] : refusals(result)) segments[key] = count;
  Json json{{"matcher", single_matcher(options.matcher).name},
            {"edges", result.edges.size()},
            {"edges_off_the_row", edges.asked},
            {"matched", edges.matched},
            {"density", edges.share()},
            {"min_disparity_px", input.range.min_px},
            {"max_disparity_px", input.range.max_px},
            {"segments", segments},
            {"depth", Json()},
            {"vertical_field", vertical_field_json(input.field, input.repaired)}};
  if (depth.placed > 0) {
    const bool known = input.estimate && input.estimate->covariance;
    json["depth"] = {{"median_m", depth.depth_m},
                     {"matching_sigma_m", depth.matching_m},
                     {"calibration_sigma_m", known ? Json(depth.calibration_m) : Json()},
                     {"calibration_share", known ? Json(depth.calibration_share) : Json()},
                     {"relative_sigma", depth.relative},
                     {"linear", depth.linear},
                     {"reliable", depth.reliable}};
  }
  return json;
}

std::string result_text(const StereoInput& input,
                        const StereoResult& result,
                        const EdgesMatched& edges,
                        const DepthFigures& depth) {
  std::string text = fmt::format(
      "edges             {}, {} of them not along the row; {} matched ({:.1f} %), {} to {} px\n",
      result.edges.size(), edges.asked, edges.matched, 100 * edges.share(), input.range.min_px,
      input.range.max_px);
  text += fmt::format("segments          {} in the left image:", result.segments.size());
  for (const auto& [key, count] : refusals(result)) text += fmt::format(" {} {}", count, key);
  text += '\n';
  if (!input.geometry) return text + "3D                not computed: no cameras given\n";
  if (depth.placed == 0) return text;
  const bool known = input.estimate && input.estimate->covariance;
  text += fmt::format("depth             {:.4g} m, standard deviation {:.3g} m from matching",
                      depth.depth_m, depth.matching_m);
  text += known ? fmt::format(", {:.3g} m from the calibration (medians)\n", depth.calibration_m)
                : " (medians); calibration part unknown\n";
  if (depth.linear < depth.placed) {
    text += fmt::format("uncertain         {} of {}: depth uncertain by more than 10 %\n",
                        depth.placed - depth.linear, depth.placed);
  }
  return text;
}

/// Throws Error if an output would overwrite an input or another output.
void check_outputs(const StereoArguments& options) {
  std::vector<std::filesystem::path> inputs{options.input.left, options.input.right};
  if (!options.input.rig.empty()) {
    for (const auto& file : files_of_named_rig(options.input.rig)) inputs.push_back(file);
  }
  const std::filesystem::path folder = options.output;
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder)) {
    throw Error(options.output, "is not a folder", "give another folder with -o");
  }
  for (const char* name : {"edges.csv", "segments.csv", "segments.json", "segments.ply"}) {
    check_output_is_not_input(inputs, folder / name);
    if (!options.picture.empty()) check_different("--picture", options.picture, folder / name);
  }
  if (!options.picture.empty()) check_output_is_not_input(inputs, options.picture);
}

void run(const StereoArguments& options, Session& session) {
  single_matcher(options.matcher);
  check_outputs(options);
  const StereoInput input = read_stereo_input(options.input, session);
  const StereoResult result = look(options, input);
  const EdgesMatched edges = edge_figures(result, options.min_angle_deg * std::numbers::pi / 180);
  const DepthFigures depth = depth_figures(result.placed);
  check_result(options, input, result, edges, depth, session);

  const std::filesystem::path folder = options.output;
  std::vector<std::pair<std::filesystem::path, std::string>> files{
      {folder / "edges.csv", edges_csv(input, result)},
      {folder / "segments.csv", segments_csv(result)},
      {folder / "segments.json", segments_json(input, result)}};
  if (input.geometry) files.emplace_back(folder / "segments.ply", segments_ply(result));
  Json names = Json::array();
  for (const auto& [name, content] : files) names.push_back(name.string());
  if (!options.picture.empty()) names.push_back(options.picture);
  if (!options.picture.empty()) {
    files.emplace_back(options.picture,
                       disparity_picture(input.pair.left, result.edges, result.found, input.range));
  }
  OutputFiles outputs;
  outputs.add_folder(folder);
  for (const auto& [name, content] : files) outputs.add(name, content);
  outputs.commit();
  Json json = result_json(options, input, result, edges, depth);
  json["doubts"] = session.trust_warnings();
  json["files"] = names;
  session.result(json, result_text(input, result, edges, depth) +
                           fmt::format("{} files written to {}\n", files.size(), options.output));
}

void add_cameras(CLI::App* verb, StereoInputOptions& o) {
  verb->add_option("--left", o.left, "left image")->required();
  verb->add_option("--right", o.right, "right image")->required();
  verb->add_option("--rig", o.rig, "rig file or shipped name of the cameras");
  verb->add_flag("--rectified", o.rectified, "the images are already rectified");
  verb->add_option("--f-px", o.f_px, "focal length of rectified images without a rig")
      ->check(finite_and_positive);
  verb->add_option("--baseline-m", o.baseline_m, "baseline of rectified images without a rig")
      ->check(finite_and_positive);
  verb->add_option("--centre-px", o.centre_px,
                   "principal point cx,cy of the left rectified image without a rig");
  verb->add_option(
          "--offset-px", o.offset_px,
          "right minus left principal point in x, added to disparities (Middlebury's doffs)")
      ->check(finite);
  verb->add_option("--max-disparity", o.max_disparity_px,
                   "largest disparity to search, px (default: a quarter of the width)");
  verb->add_option("--min-disparity", o.min_disparity_px,
                   "smallest disparity to search, px (default: 0, or that of points at infinity if "
                   "the principal points say that it is less)");
  verb->add_flag("--repair", o.repair,
                 "correct the right image by the estimated vertical field, if significant");
  verb->add_option("--threads", o.threads, "number of threads for rectification (0: all)")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

}  // namespace

void add_stereo(CLI::App& app, Session& session) {
  auto o = std::make_shared<StereoArguments>();
  CLI::App* verb = add_verb(
      app, session, "stereo", "compute edge disparities with standard deviations, and 3D segments",
      "vernier stereo --rig rig.json --left left01.png --right right01.png --max-disparity 120 "
      "-o seen\n"
      "  vernier stereo --rectified --left im0.png --right im1.png --f-px 994.978 --baseline-m "
      "0.193001 --centre-px 311.193,254.877 --offset-px 31.086 --max-disparity 70 -o seen");
  add_cameras(verb, o->input);
  auto* names = verb->add_option("--matcher", o->matcher.names, "edge, stretch, bm or sgbm")
                    ->capture_default_str();
  add_command_options(*verb, o->matcher)->excludes(names);
  verb->add_option("--epipolar-reject-deg", o->min_angle_deg,
                   "skip segments at a smaller angle to the row, degrees")
      ->check(CLI::Range(0.0, 80.0))
      ->capture_default_str();
  verb->add_option("--max-depth-m", o->space.max_depth_m,
                   "segments farther than this are marked unreliable, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--picture", o->picture, "PNG of the edges, blue (far) to red (near)")
      ->check(png_name);
  verb->add_option("-o,--output", o->output,
                   "output folder for edges.csv, segments.csv, segments.json and segments.ply")
      ->check(not_empty)
      ->required();
  check_files_written(*verb, {"--picture"});
  check_folder_written(*verb, "--output");
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
