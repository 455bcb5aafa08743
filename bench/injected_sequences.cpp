// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// A wrong calibration put into real sequences: rigs that are wrong by draws of a covariance times
// psi_c are told to the chain of stereo, from the raw images on, and to the simulator's sensor and
// estimator at the same places; what each draw changes, in reality and in simulation.
//
//     injected_sequences CALIBRATED.json drive|still_room|PAIRS.toml [draws] [end sigma px]
//
// CALIBRATED.json is a calibrated pair (opencv4) whose covariance is used, in units of focal length
// and baseline: the sequences' own files have none. `drive` and `still_room` are of VERNIER_DATA;
// what a told rig changes is against what the given rig reconstructs. Of PAIRS.toml (a list of
// pairs, docs/matchers.md) it is against the truth; these are taken as raw images of a pinhole pair
// with that calibration's field of view.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig_file.h"
#include "calib/sampler.h"
#include "calib/statistics/bootstrap.h"
#include "calib/statistics/quantile.h"
#include "injected_scenes.h"
#include "stereo/rectification.h"
#include "told_wrong.h"

namespace vernier::bench {
namespace {

using namespace vernier::internal;
using namespace vernier::stereo;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double gross_px = 3;  // off what simulation says: a mismatch

/// What one line's place is off, by a told rig.
struct Off {
  double px = 0;  ///< of disparity
  double m = 0;   ///< of place
};
struct Sample {
  Off real, simulated;
  bool steep = false;  ///< the line makes more than 60 deg with the rows
};

struct Draw {
  bool physical = true;
  std::size_t wanted = 0;       ///< lines that simulation places
  std::vector<Sample> lines;    ///< those that the chain found
  std::vector<Sample> carried;  ///< px is not set
};

Vector2d middle(const ImageSegment& s) { return 0.5 * (s.a_px + s.b_px); }

/// The point of a line at a raw pixel of the left image, with the rig that placed it.
std::optional<Vector3d> at_pixel(const PlacedLine& line, const Rig& rig, const Vector2d& px) {
  const auto ray = try_unproject(rig.cameras[0], px);
  return ray ? on_ray(line, *ray) : std::nullopt;
}

Off off_by(const RectifiedGeometry& given, const Vector3d& told, const Vector3d& reference) {
  return {given.disparity_px(told.z()) - given.disparity_px(reference.z()),
          (told - reference).norm()};
}

/// How far a carried point is from the line it belongs to, along its ray.
std::optional<double> carried_off(const PlacedLine& from,
                                  const PlacedLine& to,
                                  const Rig& told,
                                  const Vector2d& from_px,
                                  const Pose& T_to_from) {
  const auto p = at_pixel(from, told, from_px);
  if (!p) return {};
  const Vector3d q = T_to_from * *p;
  const auto there = on_ray(to, q);
  if (!there) return {};
  return (*there - q).norm();
}

class Trial {
 public:
  Trial(const Scene& scene, double sigma_px) : scene_(scene), sigma_px_(sigma_px) {}

  Draw of(const Rig& told, std::uint32_t trial) const {
    Draw draw;
    const Rig& given = scene_.estimate.rig;
    const RectifiedGeometry geometry = rectified_geometry(given);
    std::vector<std::vector<PlacedLine>> real;
    for (std::size_t i = 0; i < scene_.sights.size(); ++i) {
      const Sight& sight = scene_.sights[i];
      real.push_back(reconstructed(told, sight.images,
                                   range_with(told, given, sight.lines, sight.images.range)));
      const SimulatedPair pair(given, sight.lines, sigma_px_, trial, std::uint32_t(i));
      const auto simulated = pair.placed_with(told), before = pair.placed_with(given);
      for (std::size_t k = 0; k < sight.lines.size(); ++k) {
        const PlacedLine& line = sight.lines[k];
        if (!simulated[k] || !before[k]) continue;
        const PlacedLine& reference = scene_.against_truth ? line : *before[k];
        const Vector2d px = middle(simulated[k]->left_px);
        const auto p = at_pixel(*simulated[k], told, px), r = at_pixel(reference, given, px);
        if (!p || !r) continue;
        ++draw.wanted;
        const PlacedLine* found = like(real.back(), line.left_px);
        if (!found) continue;
        const Vector2d real_px = middle(line.left_px);
        const auto q = at_pixel(*found, told, real_px), s = at_pixel(line, given, real_px);
        const ImageSegment& at = line.left_px;
        const bool steep = std::abs(at.b_px.y() - at.a_px.y()) > 0.866 * at.length_px();
        if (q && s)
          draw.lines.push_back({off_by(geometry, *q, *s), off_by(geometry, *p, *r), steep});
      }
    }
    add_carried(told, trial, real, draw);
    return draw;
  }

 private:
  void add_carried(const Rig& told,
                   std::uint32_t trial,
                   const std::vector<std::vector<PlacedLine>>& real,
                   Draw& draw) const {
    const Rig& given = scene_.estimate.rig;
    std::vector<PlacedLine> first, second;
    for (const Link& link : scene_.links) {
      PlacedLine line = scene_.sights[link.from].lines[link.line];
      first.push_back(line);
      line.a_m = link.T_to_from * line.a_m;
      line.b_m = link.T_to_from * line.b_m;
      second.push_back(line);
    }
    // the same place in two frames, each with noise of its own
    const auto from = SimulatedPair(given, first, sigma_px_, trial, 1000).placed_with(told);
    const auto to = SimulatedPair(given, second, sigma_px_, trial, 1001).placed_with(told);
    for (std::size_t i = 0; i < scene_.links.size(); ++i) {
      const Link& link = scene_.links[i];
      const ImageSegment& px = first[i].left_px;
      const PlacedLine* a = like(real[link.from], px);
      const PlacedLine* b = like(real[link.to], scene_.sights[link.to].lines[link.same].left_px);
      if (!a || !b || !from[i] || !to[i]) continue;
      const auto off = carried_off(*a, *b, told, middle(px), link.T_to_from);
      const auto simulated =
          carried_off(*from[i], *to[i], told, middle(from[i]->left_px), link.T_to_from);
      if (off && simulated) draw.carried.push_back({{0, *off}, {0, *simulated}, false});
    }
  }

  const Scene& scene_;
  double sigma_px_;
};

double median(std::vector<double> v) {
  return v.empty() ? std::nan("") : quantile(std::move(v), 0.5, QuantileKind::linear);
}

using Of = std::function<double(const Sample&)>;

/// Ratio of medians of sizes, real to simulated, over the samples of chosen draws.
double ratio(const std::vector<std::vector<Sample>>& draws,
             std::span<const std::size_t> chosen,
             double Off::*value) {
  std::vector<double> real, simulated;
  for (const std::size_t d : chosen) {
    for (const Sample& s : draws[d]) {
      real.push_back(std::abs(s.real.*value));
      simulated.push_back(std::abs(s.simulated.*value));
    }
  }
  return median(std::move(real)) / median(std::move(simulated));
}

/// Median and robust spread of a draw's disparity errors.
struct Moments {
  double bias = 0, scatter = 0;
};
Moments moments(const std::vector<Sample>& samples, Off Sample::*side) {
  std::vector<double> v;
  for (const Sample& s : samples) v.push_back((s.*side).px);
  const double m = median(v);
  for (double& x : v) x = std::abs(x - m);
  return {m, 1.4826 * median(std::move(v))};
}

std::string with_interval(std::size_t count, const ClusterStatistic& statistic) {
  std::vector<std::size_t> all(count);
  for (std::size_t i = 0; i < count; ++i) all[i] = i;
  if (count < 3) return fmt::format("{:.2f}", statistic(all));
  const Interval i = bootstrap_interval(count, statistic, {.resamples = 1000, .seed = 1});
  return fmt::format("{:.2f} ({:.2f} to {:.2f})", statistic(all), i.low, i.high);
}

void report(double psi_c, const std::vector<Draw>& draws, bool against_truth) {
  std::vector<std::vector<Sample>> lines, carried;
  std::vector<Moments> real, simulated;
  std::size_t wanted = 0, found = 0, gross = 0;
  int failed = 0;
  for (const Draw& draw : draws) {
    failed += !draw.physical;
    wanted += draw.wanted;
    found += draw.lines.size();
    if (draw.lines.empty()) continue;
    lines.push_back(draw.lines);
    carried.push_back(draw.carried);
    for (const Sample& s : draw.lines) gross += std::abs(s.real.px - s.simulated.px) > gross_px;
    real.push_back(moments(draw.lines, &Sample::real));
    simulated.push_back(moments(draw.lines, &Sample::simulated));
  }
  const std::size_t n = lines.size();
  std::vector<std::vector<Sample>> steep = lines;
  for (auto& draw : steep) std::erase_if(draw, [](const Sample& s) { return !s.steep; });
  const auto size_of = [&](const std::vector<std::vector<Sample>>& from, Off Sample::*side,
                           double Off::*value) {
    std::vector<double> v;
    for (const auto& draw : from) {
      for (const Sample& s : draw) v.push_back(std::abs(s.*side.*value));
    }
    return median(std::move(v));
  };
  const auto slope = [&](std::span<const std::size_t> chosen) {
    double both = 0, square = 0;
    for (const std::size_t d : chosen) {
      both += real[d].bias * simulated[d].bias;
      square += simulated[d].bias * simulated[d].bias;
    }
    return both / square;
  };
  const auto scatter = [&](std::span<const std::size_t> chosen) {
    double r = 0, s = 0;
    for (const std::size_t d : chosen) {
      r += real[d].scatter;
      s += simulated[d].scatter;
    }
    return r / s;
  };
  const bool shows_change = psi_c > 0 || against_truth;
  fmt::print("| {:g} | {} | {:.0f} % |", psi_c, n, 100.0 * double(found) / double(wanted));
  if (shows_change) {
    fmt::print(" {:.3f} px; {:.3f} px | {} | {} | {} | {} |",
               size_of(lines, &Sample::real, &Off::px),
               size_of(lines, &Sample::simulated, &Off::px),
               with_interval(n, [&](auto c) { return ratio(lines, c, &Off::px); }),
               with_interval(n, [&](auto c) { return ratio(steep, c, &Off::px); }),
               psi_c > 0 ? with_interval(n, slope) : "", with_interval(n, scatter));
  } else {
    fmt::print(" | | | | |");
  }
  fmt::print(" {:.1f} % |", 100.0 * double(gross) / double(std::max<std::size_t>(1, found)));
  const double off = size_of(carried, &Sample::real, &Off::m);
  if (off == off) {
    fmt::print(" {:.3f} m; {:.3f} m | {} |", off, size_of(carried, &Sample::simulated, &Off::m),
               with_interval(n, [&](auto c) { return ratio(carried, c, &Off::m); }));
  }
  fmt::print("{}\n", failed > 0 ? fmt::format(" {} draws are no rigs", failed) : "");
  std::fflush(stdout);
}

int run(const std::vector<std::string>& words) {
  if (words.size() < 2) {
    fmt::print(stderr,
               "injected_sequences CALIBRATED.json drive|still_room|PAIRS.toml [draws] "
               "[end sigma px]\n");
    return 2;
  }
  const RigEstimate calibrated = read_rig(words[0]).estimate;
  const int count = words.size() > 2 ? std::stoi(words[2]) : 20;
  const double sigma_px = words.size() > 3 ? std::stod(words[3]) : 0.15;
  std::vector<Scene> scenes;
  if (words[1].ends_with(".toml")) {
    scenes = pairs(words[1], calibrated);
  } else {
    const char* data = std::getenv("VERNIER_DATA");
    if (!data) {
      fmt::print(stderr, "injected_sequences: VERNIER_DATA is not set\n");
      return 2;
    }
    const auto folder = std::filesystem::path(data) / "sequences" / words[1];
    scenes.push_back(words[1] == "drive" ? drive(folder, calibrated)
                                         : still_room(folder, calibrated));
  }
  std::size_t lines = 0, links = 0;
  for (const Scene& scene : scenes) {
    for (const Sight& sight : scene.sights) lines += sight.lines.size();
    links += scene.links.size();
  }
  fmt::print(
      "{}: {} lines{}; ends of simulated lines {:g} px\n\n"
      "| psi_c | draws | found | median disparity error, real; simulated | ratio | of lines "
      "steeper than 60 deg | "
      "slope of a draw's bias | scatter in a draw, ratio | off by 3 px | carried, real; simulated "
      "| ratio |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
      words[1], lines, links > 0 ? fmt::format(", {} carried", links) : "", sigma_px);
  for (const double psi_c : {0.0, 1.0, 3.0, 10.0, 30.0}) {
    std::vector<Draw> draws;
    std::uint32_t number = 0;
    for (const Scene& scene : scenes) {
      const Trial trial(scene, sigma_px);
      const RigSampler sampler(scene.estimate, "injected error");
      for (int d = 0; d < (psi_c > 0 ? count : 1); ++d, ++number) {
        Draw draw;
        try {
          const Rig told = sampler.sample(psi_c, 1, number);
          draw.physical = is_physical(told, scene.estimate.rig);
          if (draw.physical) draw = trial.of(told, number);
        } catch (const Error&) {  // no cameras have such parameters
          draw = Draw{};
          draw.physical = false;
        }
        draws.push_back(std::move(draw));
      }
    }
    report(psi_c, draws, scenes.front().against_truth);
  }
  return 0;
}

}  // namespace
}  // namespace vernier::bench

int main(int argc, char** argv) {
  try {
    return vernier::bench::run({argv + 1, argv + argc});
  } catch (const vernier::Error& error) {
    std::fputs((std::string(error.what()) + "\n").c_str(), stderr);
    return 2;
  }
}
