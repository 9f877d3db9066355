#include "evaluate_relocalisation.hpp"

#include <iostream>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "saccade/core/errors.hpp"
#include "saccade/evaluation/local_alignment.hpp"
#include "saccade/evaluation/relocalisation_evaluation.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/session/session_sink.hpp"
#include "saccade/sources/frame_source.hpp"
#include "saccade/sources/read_ahead.hpp"
#include "saccade/sources/stamped_poses.hpp"
#include "source_talk.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

constexpr double kSameMoment_s = 0.010;

/// Takes true poses to the session's world, by the frames that the session is made of.
LocalAlignment worldFromTruth(const SessionReader& session, const StampedPoses& truth) {
  std::vector<PosePair> pairs;
  for (const FrameRecord& frame : session.frames()) {
    const std::optional<Pose> true_pose = truth.nearest(frame.stamp_s, kSameMoment_s);
    if (frame.T_WC && true_pose) pairs.push_back({{frame.stamp_s, *frame.T_WC}, {frame.stamp_s, *true_pose}});
  }
  constexpr std::size_t kFewest = 3;
  if (pairs.size() < kFewest) {
    throw IoError(session.path(), "at least 3 frames whose true pose is known (--truth)", std::to_string(pairs.size()));
  }
  return LocalAlignment(std::move(pairs));
}

void print(const RelocalisationScore& score, bool json) {
  constexpr double kDegrees = 57.29577951308232;
  for (const RelocalisationScore::WrongPlace& wrong : score.wrong_places) {
    std::cerr << "frame " << wrong.frame.value << " was placed " << fixed(100.0 * wrong.error_m, 1) << " cm and "
              << fixed(kDegrees * wrong.error_rad, 1) << " degrees from the truth\n";
  }
  const double frames = static_cast<double>(std::max<std::int64_t>(1, score.frames));
  if (json) {
    std::cout << nlohmann::ordered_json{{"frames", score.frames},
                                        {"accepted", score.accepted},
                                        {"known", score.known},
                                        {"known_located", score.known_located},
                                        {"less_known", score.less_known},
                                        {"less_known_located", score.less_known_located},
                                        {"less_known_refused", score.less_known_refused},
                                        {"false_accepts", score.false_accepts},
                                        {"search_ms", score.search_ms / frames}}
                     .dump(2)
              << "\n";
    return;
  }
  std::cout << alignedTable({{"frames", grouped(score.frames)},
                             {"60 % of the view mapped", grouped(score.known)},
                             {"  located within 5 cm, 5 degrees", grouped(score.known_located)},
                             {"less mapped", grouped(score.less_known)},
                             {"  located", grouped(score.less_known_located)},
                             {"  refused", grouped(score.less_known_refused)},
                             {"false accepts", grouped(score.false_accepts)},
                             {"search", fixed(score.search_ms / frames, 0) + " ms"}});
}

}  // namespace

void evaluateRelocalisation(const std::string& session, const std::string& input, const std::string& range,
                            const std::string& truth, bool json) {
  const SessionReader reader(session);
  std::optional<StampedPoses> true_poses;
  std::optional<LocalAlignment> to_world;
  if (!truth.empty()) {
    true_poses = StampedPoses::loadStrictly(truth);
    to_world = worldFromTruth(reader, *true_poses);
  }
  ReadAhead source(openSource(input, range.empty() ? FrameRange{} : FrameRange::parse(range)));
  sayWhatWasUnderstood(source.description());
  Explorer explorer(loadConfig(reader), source.description().camera);
  explorer.restore(loadMemory(reader));
  RelocalisationEvaluation evaluation(explorer);
  catchInterrupts();
  ProgressLine progress(source.description().frames);
  RgbdFrame frame;
  for (ReadStatus status = source.read(frame); status != ReadStatus::kEnd && !interrupted();
       status = source.read(frame)) {
    if (status == ReadStatus::kSkip) continue;
    std::optional<Pose> T_WC;
    if (true_poses) {
      const std::optional<Pose> T_TC = true_poses->nearest(frame.stamp_s, kSameMoment_s);
      if (!T_TC) continue;
      T_WC = to_world->toEstimate(*T_TC);
    }
    evaluation.add(frame, T_WC);
    progress.show(evaluation.score().frames, "");
  }
  progress.clear();
  if (evaluation.score().frames == 0) throw IoError(input, "frames to look for", "none");
  print(evaluation.score(), json);
}

}  // namespace saccade::app
