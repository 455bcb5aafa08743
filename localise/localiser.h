// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "localise/pgh.h"
#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise {

enum class LocalisationStatus {
  answered,
  too_few_lines,  ///< fewer than min_lines lines
  tie,            ///< two positions more than 1 m apart have the same best score
  no_match,       ///< no node of the map matches
  unsure,  ///< an error is more probable than max_error_rate; the answer holds the best guess
  failed,  ///< the localiser itself failed, as a program that died; see `failure`
  too_few_corners,  ///< fewer than min_corners corners
};

std::string_view name(LocalisationStatus status);

/// A pose at which the views may have been taken.
struct PoseMode {
  Pose2D pose;
  int node = -1;           ///< the map node it was compared with
  double probability = 0;  ///< that the robot stood within 1 m of it
  double score = 0;        ///< log-likelihood, up to a constant of the query
};

struct LocalisationAnswer {
  LocalisationStatus status = LocalisationStatus::too_few_lines;
  int node = -1;         ///< index of the map node, the memo's answer
  Pose2D pose;           ///< refined metric pose
  double score = 0;      ///< of the method; `lines`: log-likelihood in nats
  double runner_up = 0;  ///< score of the best pose more than 1 m away
  /// That the pose is right within 1 m, as the method states it; 0 for methods that state none.
  double probability = 0;
  bool states_probability() const { return probability > 0; }
  std::vector<PoseMode> modes;  ///< of the posterior, most probable first; `lines` only
  /// The turn of a further look that tells the modes apart best, or places that rank best where
  /// there are no two modes; 0 where the map tells nothing, or the answer is sure enough
  /// (look_error_rate).
  double next_turn_rad = 0;
  std::string failure;  ///< why, if it failed
  /// CPU time that another process spent on it, to a tick of the system's scheduler (some ms).
  double program_cpu_ms = 0;
};

/// Estimates where a view was taken. Implementations keep no state between queries.
class Localiser {
 public:
  virtual ~Localiser() = default;
  /// The pose of a view.
  virtual LocalisationAnswer localise(const PlaceView& query) const = 0;
  /// The pose of the first of several views from one position, whose turns are known. Without an
  /// implementation the first look alone is used. Throws Error without looks.
  virtual LocalisationAnswer localise_looks(std::span<const Look> looks) const;
};

/// Which stages of `lines` run; without all of them the best-ranked node is the answer. Each can be
/// studied alone.
struct LocaliserStages {
  bool align = true;    ///< votes of vertical lines give each candidate's pose; else its node's
  bool refine = true;   ///< the candidate's lines are compared in the image, and its pose improved
  bool compare = true;  ///< the best are compared with the lines of neighbouring nodes merged
  /// Where that leaves doubts, more candidates are tried; where it leaves none, those that rank as
  /// the answer's own, and the places that look like the answer in the map.
  bool deepen = true;
};

/// The stages in words: "align+refine+compare+deepen", or a part of it; "none" without any.
std::string name(const LocaliserStages& stages);
/// From words in any order. Throws Error for an unknown or repeated one.
LocaliserStages localiser_stages(std::string_view words);

struct LocaliserOptions {
  std::string ranker = "view";  ///< of `lines`: view, pgh or pgh_aggregate
  int candidates = 256;         ///< of the best-ranked poses; `lines` tries 16 of them first,
                                ///< and more where these leave doubts or rank alike
  int min_lines = 3;            ///< minimum number of lines in space for an answer
  /// `lines` abstains (unsure) where an error is more probable than this; 1: an answer is never
  /// unsure.
  double max_error_rate = 0.01;
  /// `lines` asks for a further look (next_turn_rad) where an error is more probable than this, at
  /// most max_error_rate; none: where it is unsure.
  std::optional<double> look_error_rate;
  /// What `lines` takes for the probability that the robot stands where the map holds nothing,
  /// before it looks; below 1. 0: it is on the map.
  double off_map = 0;
  /// What `lines` takes for the probability, before it looks and before the recorded views are
  /// compared, that two places are equal, so that their recordings differ by errors alone; below 1.
  /// 0: what the map holds tells all places apart.
  double repeats = 0.05;
  LocaliserStages stages;
  /// `corners` answers if so many corners agree at least; from 4.
  int min_corners = 8;
  /// Simulated robots and pairs of images give views their corners, which cost time and memory: for
  /// a method that does not say so itself (needs_corners).
  bool corners = false;
  PghOptions histograms;  ///< of `pgh` and the rankers by histograms: in space, metres
  PghOptions image_histograms = image_pgh_options();  ///< of `pgh_baseline`: pixels
  std::string command;       ///< of `program`: a program and its arguments, quoted as in a shell
  double time_limit_s = 10;  ///< of `program`, for a query; above 0
};

/// Creates the localiser named `method` on a map, which must outlive it:
///
///  - `lines`: a view descriptor ranks the nodes; votes of vertical lines give poses; the lines
///    that the map recorded are compared with the query's in its image; the answer is the best of a
///    posterior over poses, or unsure;
///  - `pgh`: spatial histograms rank the nodes by Bhattacharyya coefficients; rigid alignment of
///    the best ones verifies them and gives the metric pose;
///  - `pgh_baseline`: image-line histograms compared in a plain loop, and the memo's filter that
///    eliminates the lowest node until one is left. For comparison only;
///  - `pgh_baseline_vectorised`: the same method on stored roots with SIMD dot products. For
///    comparison of times;
///  - `corners`: descriptors of corners rank the nodes by a vocabulary and are matched with those
///    of the best nodes; corners in space that agree on a pose on the floor give it, by consensus
///    and least squares on pixels. States no probability (docs/localisation.md);
///  - `program`: a program of one's own, which reads the map and the queries as lines of JSON and
///    answers in lines of JSON (docs/own-localiser.md). A query that it does not answer, not in
///    time or with nonsense has the status `failed`, and the program is started again, three times
///    in a row at most. Throws Error if it cannot be started;
///  - any other that was registered.
///
/// Throws Error for another name, listing these, options out of range, and a factory that made
/// none.
std::unique_ptr<Localiser> make_localiser(std::string_view method,
                                          const TopologicalMap& map,
                                          const LocaliserOptions& options = {});

std::vector<std::string> localiser_names();

/// Creates a localiser on a map that outlives it.
using LocaliserFactory =
    std::function<std::unique_ptr<Localiser>(const TopologicalMap&, const LocaliserOptions&)>;

/// Whether the histograms of a method are of lines in the image:
/// LocaliserOptions::image_histograms.
bool uses_image_histograms(std::string_view method);

/// What a method needs of views, of the map and of queries.
struct ViewNeeds {
  bool corners = false;  ///< PlaceView::corners, which not every view holds
  bool lines = true;     ///< PlaceView::lines or image_lines
};

/// Makes a method known to make_localiser, and so to studies of this process. Safe with threads.
/// Throws Error for a name that is empty or taken.
void register_localiser(const std::string& method, LocaliserFactory factory, ViewNeeds needs = {});

/// Whether a method's answers can depend on an option: "looks" for further looks of a query,
/// "endpoint_sigma" for the told error of ends of lines, "histograms" for the histograms of the
/// method, else the name of a member of LocaliserOptions. True for methods that were registered.
bool uses_option(std::string_view method,
                 std::string_view option,
                 const LocaliserOptions& options = {});

/// Candidates that the method looks at, whatever LocaliserOptions::candidates says.
int most_candidates(std::string_view method);

/// Whether a method may answer: `lines` is never sure without the stage compare, unless
/// max_error_rate is 1.
bool can_be_sure(std::string_view method, const LocaliserOptions& options);

/// Whether a method looks at lines; true for an unknown one.
bool uses_lines(std::string_view method);

/// Whether views should hold corners: for a method that needs them, or if the options say so.
/// False for an unknown method otherwise.
bool needs_corners(std::string_view method, const LocaliserOptions& options = {});

}  // namespace vernier::localise
