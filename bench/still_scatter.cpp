// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// A rig that stands still: the scatter of disparities and of segments between looks at the same
// scene, beside the part of their stated standard deviations that is noise. `still_room` of
// VERNIER_DATA, 16 pairs of EuRoC's V1_01. What is stated beyond noise all looks share, and no
// number of them shows it. Even looks may be used for tuning, odd ones judge.
//
//     still_scatter [all|even|odd]
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "calib/formats/asl_sensor.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/quantile.h"
#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/edges/edge_line.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/grey_levels.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/rectification.h"
#include "stereo/rectified_images.h"

namespace vernier::stereo {
namespace {

using namespace vernier::internal;
using namespace vernier::stereo::internal;
using Eigen::Vector2d;

constexpr double floor_px = EdgeMatcherOptions{}.sigma_floor_px;
constexpr double gross_sigma = 6;  // beyond it a value is a wrong match, and counted
constexpr std::size_t least_looks = 5;

/// One look: edges, their matches and segments.
struct Look {
  std::vector<EdgePoint> edges;
  std::vector<EdgeMatch> matches;
  std::vector<EdgeSegment> segments;
  std::vector<SegmentDisparity> disparities;
  Pose T_look_first;  ///< what little the rig moves since the first look
};

Look look_at(const Rig& rig,
             const RectifiedGeometry& geometry,
             const GreyLevels& left,
             const GreyLevels& right) {
  const RectifiedImages images = rectified_images(rig, geometry, left, right, 0);
  Look look;
  CannyOptions canny;
  canny.noise = images.pair.left_noise.per_pixel();
  look.edges = canny_edges(images.pair.left, canny);
  std::erase_if(look.edges, [&](const EdgePoint& e) { return !images.left_valid(e.x, e.y); });
  look.matches = match_edges(images.pair, look.edges, {0, geometry.size_px[0] / 4});
  look.segments = edge_segments(look.edges);
  std::vector<EdgeDisparity> found;
  for (const EdgeMatch& match : look.matches) found.push_back(match.at);
  look.disparities = segment_disparities(look.edges, look.segments, found);
  return look;
}

/// The edges of a look by pixel.
class EdgeIndex {
 public:
  EdgeIndex(const std::vector<EdgePoint>& edges, const Eigen::Vector2i& size)
      : edges_(edges), width_(size[0]), at_(static_cast<std::size_t>(size[0] * size[1]), -1) {
    for (std::size_t i = 0; i < edges.size(); ++i) at_[place(edges[i].x, edges[i].y)] = int(i);
  }

  /// The nearest edge point of nearly the same normal within 1.5 px; -1: none.
  int near(const Vector2d& p, const Eigen::Vector2f& normal) const {
    int best = -1;
    double least = 1.5;
    const int height = static_cast<int>(at_.size()) / width_;
    for (int y = int(p.y()) - 1; y <= int(p.y()) + 2; ++y) {
      for (int x = int(p.x()) - 1; x <= int(p.x()) + 2; ++x) {
        if (x < 0 || y < 0 || x >= width_ || y >= height) continue;
        const int i = at_[place(x, y)];
        if (i < 0 || edges_[std::size_t(i)].normal.dot(normal) < 0.95F) continue;
        const double off = (edges_[std::size_t(i)].pixel_px.cast<double>() - p).norm();
        if (off < least) {
          least = off;
          best = i;
        }
      }
    }
    return best;
  }

 private:
  std::size_t place(int x, int y) const {
    return std::size_t(y) * std::size_t(width_) + std::size_t(x);
  }
  const std::vector<EdgePoint>& edges_;
  int width_;
  std::vector<int> at_;
};

/// A pixel of the rectified left image and its disparity.
struct SeenPoint {
  Vector2d px;
  double disparity_px = 0;
};

/// Where a point of the first look is in another, after what little the rig moves.
SeenPoint moved(const RectifiedGeometry& g, const Pose& T, const SeenPoint& p) {
  const double z = g.depth_m(p.disparity_px);
  const Vector2d xy = z / g.f_px * (p.px - g.centre_px);
  const Eigen::Vector3d x = T.R * Eigen::Vector3d(xy.x(), xy.y(), z) + T.t;
  return {g.f_px / x.z() * x.head<2>() + g.centre_px, g.disparity_px(x.z())};
}

/// The motion of the rig by Gauss and Newton from the offsets of matched edges along their normals.
Pose motion_between(const RectifiedGeometry& g,
                    const Look& from,
                    const Look& to,
                    const EdgeIndex& index) {
  Pose T;
  for (int round = 0; round < 15; ++round) {
    Eigen::Matrix<double, 6, 6> N = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t k = 0; k < from.edges.size(); ++k) {
      const EdgePoint& e = from.edges[k];
      if (!from.matches[k].refined || !(from.matches[k].at.disparity_px > 1)) continue;
      const SeenPoint there =
          moved(g, T, {e.pixel_px.cast<double>(), from.matches[k].at.disparity_px});
      const int i = index.near(there.px, e.normal);
      if (i < 0) continue;
      const Vector2d n = e.normal.cast<double>();
      const double off = n.dot(to.edges[std::size_t(i)].pixel_px.cast<double>() - there.px);
      const double w = 1 / (1 + off * off / (0.1 * 0.1));
      const Vector2d x = (there.px - g.centre_px) / g.f_px;
      const double inverse_z = 1 / g.depth_m(there.disparity_px);
      Eigen::Matrix<double, 2, 6> J;  // of the pixel by a small rotation and translation
      J << -x.x() * x.y(), 1 + x.x() * x.x(), -x.y(), inverse_z, 0, -inverse_z * x.x(),
          -1 - x.y() * x.y(), x.x() * x.y(), x.x(), 0, inverse_z, -inverse_z * x.y();
      const Eigen::Matrix<double, 1, 6> row = g.f_px * n.transpose() * J;
      N += w * row.transpose() * row;
      b += w * off * row.transpose();
    }
    const Eigen::Matrix<double, 6, 1> step = N.ldlt().solve(b);
    const Eigen::Matrix3d R = rotation_from_vector(step.head<3>());
    T = Pose{R * T.R, R * T.t + step.tail<3>()};
  }
  return T;
}

/// Values of one thing in several looks, each with its stated variances.
struct Track {
  std::vector<double> value, noise_variance, stated_variance;
};

/// Scatter over stated noise, over tracks.
void report(const std::string& what, const std::vector<Track>& tracks) {
  std::vector<double> z, scatter, noise, stated, ratio;
  int gross = 0, values = 0, used = 0;
  for (const Track& track : tracks) {
    if (track.value.size() < least_looks) continue;
    const double middle = quantile(track.value, 0.5, QuantileKind::linear);
    std::vector<double> kept, n2, s2;
    for (std::size_t i = 0; i < track.value.size(); ++i) {
      ++values;
      if (std::abs(track.value[i] - middle) > gross_sigma * std::sqrt(track.stated_variance[i])) {
        ++gross;
        continue;
      }
      kept.push_back(track.value[i]);
      n2.push_back(track.noise_variance[i]);
      s2.push_back(track.stated_variance[i]);
    }
    if (kept.size() < least_looks) continue;
    ++used;
    double mean = 0, squares = 0, noise2 = 0, stated2 = 0;
    const double n = static_cast<double>(kept.size());
    for (const double x : kept) mean += x / n;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      squares += (kept[i] - mean) * (kept[i] - mean) / (n - 1);
      noise2 += n2[i] / n;
      stated2 += s2[i] / n;
      z.push_back((kept[i] - mean) * std::sqrt(n / (n - 1) / n2[i]));
    }
    scatter.push_back(std::sqrt(squares));
    noise.push_back(std::sqrt(noise2));
    stated.push_back(std::sqrt(stated2));
    ratio.push_back(std::sqrt(squares / noise2));
  }
  const auto median = [](std::vector<double> v) {
    return v.empty() ? 0 : quantile(std::move(v), 0.5, QuantileKind::linear);
  };
  const auto rms = [](const std::vector<double>& v) {
    double s = 0;
    for (const double x : v) s += x * x;
    return std::sqrt(s / std::max<double>(1, double(v.size())));
  };
  std::vector<double> absolute;
  for (const double x : z) absolute.push_back(std::abs(x));
  // of a normal deviate the median of |z| is 0.6745
  fmt::print("| {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} % |\n", what,
             used, median(scatter), median(noise), median(stated), rms(z), median(ratio),
             median(absolute) / 0.6745, 100.0 * gross / std::max(1, values));
}

/// Tracks of edge points: the disparity where the edge of a point of the first look is.
std::map<std::string, std::vector<Track>> point_tracks(const RectifiedGeometry& g,
                                                       const std::vector<Look>& looks) {
  std::vector<EdgeIndex> index;
  for (const Look& look : looks) index.emplace_back(look.edges, g.size_px);
  std::map<std::string, std::vector<Track>> tracks;
  for (std::size_t e = 0; e < looks[0].edges.size(); ++e) {
    const EdgePoint& first = looks[0].edges[e];
    const EdgeMatch& match_of_first = looks[0].matches[e];
    if (std::abs(first.normal.x()) < 0.0872F || !(match_of_first.at.disparity_px > 1)) continue;
    const SeenPoint at_first{first.pixel_px.cast<double>(), match_of_first.at.disparity_px};
    Track refined, coarse, place;
    for (std::size_t k = 0; k < looks.size(); ++k) {
      const SeenPoint there = moved(g, looks[k].T_look_first, at_first);
      const int i = k == 0 ? int(e) : index[k].near(there.px, first.normal);
      if (i < 0) continue;
      const EdgePoint& edge = looks[k].edges[std::size_t(i)];
      if (match_of_first.refined) {
        place.value.push_back(
            edge.normal.cast<double>().dot(edge.pixel_px.cast<double>() - there.px));
        place.noise_variance.push_back(edge.sigma_px * edge.sigma_px);
        place.stated_variance.push_back(0.04);
      }
      const EdgeMatch& match = looks[k].matches[std::size_t(i)];
      if (!match.at.matched()) continue;
      const double all = match.at.sigma_px * match.at.sigma_px;
      Track& track = match.refined ? refined : coarse;
      track.value.push_back(match.at.disparity_px - there.disparity_px);
      track.noise_variance.push_back(match.refined ? std::max(1e-6, all - floor_px * floor_px)
                                                   : all);
      track.stated_variance.push_back(all);
    }
    const double s = refined.noise_variance.empty()
                         ? 0
                         : std::sqrt(quantile(refined.noise_variance, 0.5, QuantileKind::linear));
    const std::string band = s < 0.03   ? "a noise < 0.03"
                             : s < 0.06 ? "b 0.03 to 0.06"
                             : s < 0.12 ? "c 0.06 to 0.12"
                                        : "d above 0.12";
    tracks["edge point across its edge"].push_back(place);
    tracks["refined, all"].push_back(refined);
    tracks["refined, " + band].push_back(refined);
    tracks["support parabola (0.5 px stated)"].push_back(coarse);
  }
  return tracks;
}

/// A placed segment with its line.
struct SegmentLine {
  const SegmentDisparity* segment;
  EdgeLine line;
  Vector2d direction;
};

std::vector<SegmentLine> lines_of(const Look& look) {
  std::vector<SegmentLine> lines;
  for (const SegmentDisparity& s : look.disparities) {
    if (s.status != SegmentStatus::placed) continue;
    const Vector2d d = (s.left_px.b_px - s.left_px.a_px).normalized();
    lines.push_back({&s, EdgeLine(look.edges, look.segments[std::size_t(s.segment)].points, 1), d});
  }
  return lines;
}

double disparity_at(const SegmentDisparity& s, const Vector2d& p) {
  const Vector2d ab = s.left_px.b_px - s.left_px.a_px;
  const double u = (p - s.left_px.a_px).dot(ab) / ab.squaredNorm();
  return (1 - u) * s.a_disparity_px + u * s.b_disparity_px;
}

/// The same segment in another look: nearly the same ends.
const SegmentLine* same_in(const std::vector<SegmentLine>& lines,
                           const Vector2d& a,
                           const Vector2d& b,
                           double& apart) {
  const SegmentLine* best = nullptr;
  double least = 6;  // sum of both ends' distances along the edge, px
  const Vector2d t = (b - a).normalized(), n(-t.y(), t.x());
  for (const SegmentLine& line : lines) {
    const Vector2d da = line.segment->left_px.a_px - a, db = line.segment->left_px.b_px - b;
    if (std::abs(n.dot(da)) > 1.5 || std::abs(n.dot(db)) > 1.5) continue;
    const double off = std::abs(t.dot(da)) + std::abs(t.dot(db));
    if (off < least) {
      least = off;
      best = &line;
    }
  }
  apart = least;
  return best;
}

/// The values of a track at some of its places.
void append(const Track& from, std::size_t i, Track& to) {
  to.value.push_back(from.value[i]);
  to.noise_variance.push_back(from.noise_variance[i]);
  to.stated_variance.push_back(from.stated_variance[i]);
}

std::map<std::string, std::vector<Track>> segment_tracks(const RectifiedGeometry& g,
                                                         const std::vector<Look>& looks) {
  std::vector<std::vector<SegmentLine>> lines;
  for (const Look& look : looks) lines.push_back(lines_of(look));
  std::map<std::string, std::vector<Track>> tracks;
  for (const SegmentLine& first : lines[0]) {
    for (const bool is_a : {true, false}) {
      Track across, same_across, disparity, same_disparity, along;
      for (std::size_t k = 0; k < looks.size(); ++k) {
        const auto& own = *first.segment;
        const SeenPoint to_a =
            moved(g, looks[k].T_look_first, {own.left_px.a_px, own.a_disparity_px});
        const SeenPoint to_b =
            moved(g, looks[k].T_look_first, {own.left_px.b_px, own.b_disparity_px});
        const Vector2d &a = to_a.px, &b = to_b.px;
        double apart = 0;
        const SegmentLine* line = k == 0 ? &first : same_in(lines[k], a, b, apart);
        if (!line) continue;
        const SegmentDisparity& s = *line->segment;
        const Vector2d& end = is_a ? s.left_px.a_px : s.left_px.b_px;
        const Vector2d place = is_a ? a : b;
        // Where the line is at the first look's end, across it, and its disparity there.
        const double at = line->line.along(place);
        const Vector2d n = line->line.normal;
        across.value.push_back(n.dot(line->line.at(at) - place));
        const Eigen::Vector2d h(1, at);
        across.noise_variance.push_back(h.dot(line->line.noise_covariance * h));
        across.stated_variance.push_back(line->line.across_variance(at));
        disparity.value.push_back(disparity_at(s, place) - (is_a ? to_a : to_b).disparity_px);
        disparity.noise_variance.push_back(s.disparity_noise_px2[is_a ? 0 : 1]);
        const int i = is_a ? 4 : 5;
        disparity.stated_variance.push_back(s.covariance_px2(i, i));
        if (apart < 2) {
          append(across, across.value.size() - 1, same_across);
          append(disparity, disparity.value.size() - 1, same_disparity);
        }
        along.value.push_back(line->direction.dot(end - place));
        const Eigen::Matrix2d C = s.covariance_px2.block<2, 2>(is_a ? 0 : 2, is_a ? 0 : 2);
        along.noise_variance.push_back(line->direction.dot(C * line->direction));
        along.stated_variance.push_back(along.noise_variance.back());
      }
      const double length = first.segment->left_px.length_px();
      const std::string band = length < 15   ? " a below 15 px long"
                               : length < 30 ? " b 15 to 30 px"
                                             : " c 30 px and more";
      tracks["end across its line, all"].push_back(across);
      tracks["end across its line," + band].push_back(across);
      tracks["end across its line, both ends within 2 px," + band].push_back(same_across);
      tracks["end's disparity, both ends within 2 px"].push_back(same_disparity);
      tracks["end's disparity, all"].push_back(disparity);
      tracks["end's disparity," + band].push_back(disparity);
      tracks["end along its line (all stated)"].push_back(along);
    }
  }
  return tracks;
}

int run(const std::string& which) {
  const char* data = std::getenv("VERNIER_DATA");
  if (!data) {
    fmt::print(stderr, "still_scatter: VERNIER_DATA is not set\n");
    return 2;
  }
  const auto room = std::filesystem::path(data) / "sequences" / "still_room";
  const Rig rig = read_asl_sensors({room / "left.yaml", room / "right.yaml"}).rig;
  const RectifiedGeometry geometry = rectified_geometry(rig);
  std::vector<std::filesystem::path> names;
  for (const auto& entry : std::filesystem::directory_iterator(room / "left"))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  std::vector<Look> looks;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if ((which == "even" && i % 2 == 1) || (which == "odd" && i % 2 == 0)) continue;
    looks.push_back(look_at(rig, geometry, read_grey_levels(room / "left" / names[i]),
                            read_grey_levels(room / "right" / names[i])));
    const EdgeIndex index(looks.back().edges, geometry.size_px);
    looks.back().T_look_first = motion_between(geometry, looks[0], looks.back(), index);
  }
  double shift_m = 0, turn_rad = 0;
  for (const Look& look : looks) {
    shift_m = std::max(shift_m, look.T_look_first.t.norm());
    turn_rad = std::max(turn_rad, vector_from_rotation(look.T_look_first.R).norm());
  }
  fmt::print("{} looks; the rig moves by up to {:.2f} mm and {:.3f} deg, which is taken out\n\n",
             looks.size(), 1e3 * shift_m, turn_rad * 180 / std::numbers::pi);
  fmt::print(
      "| what | tracks | scatter, median px | noise stated | all stated | rms z | median ratio | "
      "median abs z / 0.6745 | beyond 6 sigma |\n| --- | --- | --- | --- | --- | --- | --- | --- | "
      "--- |\n");
  for (const auto& [what, tracks] : point_tracks(geometry, looks)) report(what, tracks);
  for (const auto& [what, tracks] : segment_tracks(geometry, looks)) report(what, tracks);
  return 0;
}

}  // namespace
}  // namespace vernier::stereo

int main(int argc, char** argv) { return vernier::stereo::run(argc > 1 ? argv[1] : "all"); }
