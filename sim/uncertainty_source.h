// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "calib/rig.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"

namespace vernier::sim {

/// An edge passing through the error sources: its true ends, and the displacement of each end in
/// each camera. Ends are projected on demand, so that the ends of a cut piece lie exactly on the
/// edge, for any lens.
struct SensedEdge {
  VisibleEdge truth;
  std::array<std::array<Eigen::Vector2d, 2>, 2> offset_px{};  ///< [eye][end]
  std::uint32_t piece = 0;  ///< index of the part left by an edge-loss gap
  bool in_stereo = true;    ///< false: seen by the left camera only, as far as stereo can tell

  SensedEdge() {
    for (auto& eye : offset_px) eye.fill(Eigen::Vector2d::Zero());
  }
};

/// A corner pair in both images.
struct SensedCorner {
  VisibleCorner truth;
  std::array<Eigen::Vector2d, 2> pixel_px;  ///< [camera]
  bool mismatched = false;
};

struct SensedView {
  std::vector<SensedEdge> edges;
  std::vector<SensedCorner> corners;
  std::string failure;  ///< set by a source that failed: the sources after it do not act
};

/// The true rig and the trial's identity, which keys every random draw.
struct SensingContext {
  const Rig& rig;
  const stereo::Rectification& rectification;
  std::uint64_t seed = 0;
  std::uint32_t trial = 0;
  std::uint32_t frame = 0;
  Eigen::Vector2d at_m{0, 0};  ///< of the look, on the floor
};

/// The edge in the image of a camera (0 left, 1 right), displacements included.
stereo::ImageSegment image_of(const Rig& rig, const SensedEdge& edge, int eye);

/// One source of geometric error. Sources act in a fixed order on the noise-free view of the true
/// rig; each draws from its own stream, keyed by the feature it acts on, so that enabling or
/// disabling one does not change the draws of the others. One source may be used by several threads
/// at once.
class UncertaintySource {
 public:
  virtual ~UncertaintySource() = default;
  virtual std::string_view name() const = 0;
  virtual void apply(const SensingContext& context, SensedView& view) const = 0;
};

/// The sources enabled by these settings, in order: unseen edges, missed edges, clutter, lateral
/// shift, merging of lines, edge loss, end-point error, epipolar rejection, stereo mismatch, corner
/// loss, corner error, corner mismatch, then those of one's own (SourceSettings::own, in their
/// order) and the program. The memo's seventh source, calibration, acts on the rig assumed by the
/// estimator (RigSampler), the mount on the pose of a look (draw_mount), and moved furniture on the
/// world (with_moved_furniture). `rig` is what the program is told. Throws Error for an own source
/// that is not registered, and a program that cannot be started.
std::vector<std::unique_ptr<UncertaintySource>> standard_sources(const SourceSettings& settings,
                                                                 double min_length_px,
                                                                 const Rig& rig);
/// The same for settings without a program.
std::vector<std::unique_ptr<UncertaintySource>> standard_sources(const SourceSettings& settings,
                                                                 double min_length_px);

/// Creates a source from its options. Throws Error for options it does not accept; what else it
/// throws is passed on as an Error. What else than Error such a source throws when it acts, and
/// numbers that are not finite in an edge or a corner, fail the view (SensedView::failure).
using SourceFactory = std::function<std::unique_ptr<UncertaintySource>(const SourceOptions&)>;

/// Makes a source of one's own known by name to SourceSettings::own, and so to Sensor and to
/// studies of this process. Safe with threads. Throws Error for a name that is taken or not made of
/// small letters, digits and underscores.
void register_source(const std::string& name, SourceFactory factory);

/// Names of the registered sources, ascending.
std::vector<std::string> registered_sources();

}  // namespace vernier::sim
