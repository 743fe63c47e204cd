#include "bench/deformation/contest.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include <fmt/core.h>

#include "bench/deformation/pictures.h"
#include "bench/deformation/table.h"

namespace fascia {
namespace {

bool isWanted(PoseGroup group, const std::vector<std::string>& poses) {
  static const char* const names[] = {"bends", "hips", "shoulders", "wrists", "neck"};
  const auto says = [&](const std::string& word) {
    return word == "all" || word == names[static_cast<std::size_t>(group)];
  };
  return poses.empty() || std::any_of(poses.begin(), poses.end(), says);
}

std::vector<JointPose> wantedPoses(const RiggedModel& model, const ContestOptions& options) {
  std::vector<double> bends_rad;
  for (const double angle_deg : options.angles_deg) bends_rad.push_back(radians(angle_deg));
  std::vector<JointPose> poses = findPoses(model, bends_rad);
  std::erase_if(poses, [&](const JointPose& p) { return !isWanted(p.group, options.poses); });
  return poses;
}

class Contest {
 public:
  Contest(const Entrant& entrant, const ContestOptions& options, const Console& console,
          std::vector<Issue>& issues)
      : entrant_(entrant),
        options_(options),
        console_(console),
        issues_(issues),
        judge_(*entrant.model),
        poses_(wantedPoses(*entrant.model, options)) {
    // All that will be shown as motions of one model, so that characters are built once.
    auto model = std::make_shared<RiggedModel>(*entrant.model);
    model->motions.clear();
    for (const JointPose& pose : poses_) {
      model->motions.push_back(poseMotion(*entrant.model, pose));
      model->motions.back().name = fmt::format("pose {}", model->motions.size());
    }
    for (SampledMotion& motion : findMotions(*entrant.model, options.motions, console, issues)) {
      clips_.push_back(motion.name);
      motion.name = fmt::format("clip {}", clips_.size());
      model->motions.push_back(std::move(motion));
    }
    model_ = std::move(model);
    contenders_ = makeContenders(model_, entrant.character ? &*entrant.character : nullptr);
  }

  Json run() {
    console_.say("");
    console_.say(fmt::format("{}: {} points, {} triangles, {} joints; {} crossings at rest",
                             entrant_.name, model_->points_m.size(), model_->triangles.size(),
                             model_->joints.size(), judge_.crossingsAtRest()));
    if (!entrant_.character)
      console_.hint(entrant_.name + " is a rig without flesh: Fascia does not take part");
    Json::List poses, clips;
    for (const JointPose& pose : poses_) poses.push_back(showPose(pose));
    for (std::size_t i = 0; i < clips_.size(); ++i) clips.push_back(showClip(i));
    if (stages_.empty()) console_.say("nothing to show: no joint for a pose, and no motion");
    return Json::Object{{"name", entrant_.name},
                        {"points", static_cast<int>(model_->points_m.size())},
                        {"triangles", static_cast<int>(model_->triangles.size())},
                        {"joints", static_cast<int>(model_->joints.size())},
                        {"pieces", static_cast<int>(model_->componentCount)},
                        {"height_m", model_->height_m()},
                        {"crossings_at_rest", static_cast<int>(judge_.crossingsAtRest())},
                        {"poses", std::move(poses)},
                        {"clips", std::move(clips)},
                        {"summary", sumUp()}};
  }

 private:
  Json showPose(const JointPose& pose) {
    const auto motion = static_cast<int>(&pose - poses_.data());
    const ContestStage stage = makeContestStage(model_, motion, 2);
    const HingeRegion region = regionOf(*model_, pose);
    StageResult& result = stages_.emplace_back();
    result.name = pose.name;
    result.isPose = true;
    result.isBend = pose.hinge.has_value();
    const std::string turned =
        pose.hinge ? fmt::format(" (turned by {:.0f}°)", degrees(pose.turn_rad)) : "";
    sayStageHeading(result, turned, console_);
    std::optional<PosePictures> pictures;
    if (!options_.pictures.empty()) pictures.emplace(*model_, pose, region, judge_);
    perform(stage, result, [&](const ContestFrames& performance) {
      if (pictures && !tryToDraw([&] { pictures->add(renderer(), performance.frames.back()); }))
        pictures.reset();
      return judge_.judgePose(region, stage, performance);
    });
    if (pictures) tryToDraw([&] { pictures->write(pictureFile(pose)); });
    return Json::Object{{"name", pose.name},
                        {"joint", model_->joints[pose.joint].name},
                        {"bend", pose.hinge.has_value()},
                        {"angle_deg", degrees(pose.angle_rad)},
                        {"turn_deg", degrees(pose.turn_rad)},
                        {"results", toJson(result, model_->points_m.size())}};
  }

  Json showClip(std::size_t number) {
    const auto motion = static_cast<int>(poses_.size() + number);
    const ContestStage stage = makeContestStage(model_, motion, options_.seconds);
    StageResult& result = stages_.emplace_back();
    result.name = clips_[number];
    sayStageHeading(result, fmt::format(", {} frames", stage.motions.size()), console_);
    perform(stage, result,
            [&](const ContestFrames& performance) { return judge_.judgeClip(stage, performance); });
    return Json::Object{{"motion", result.name},
                        {"frames", static_cast<int>(stage.motions.size())},
                        {"results", toJson(result, model_->points_m.size())}};
  }

  template <class Judgement>
  void perform(const ContestStage& stage, StageResult& result, const Judgement& judgement) {
    for (const auto& contender : contenders_) {
      const ContestFrames performance = contender->perform(stage, console_);
      result.methods.push_back(contender->name());
      result.frame_s.push_back(performance.frame_s);
      result.scores.push_back(judgement(performance));
      sayRow(result, result.scores.size() - 1, model_->points_m.size(), console_);
    }
  }

  // One picture that cannot be drawn says why; the tables go on.
  template <class Draw>
  bool tryToDraw(const Draw& draw) {
    if (!canDraw_) return false;
    try {
      draw();
      return true;
    } catch (const Error& error) {
      issues_.insert(issues_.end(), error.issues().begin(), error.issues().end());
      return canDraw_ = false;
    }
  }

  Json sumUp() {
    std::vector<SummaryRow> rows;
    for (std::size_t i = 1; i < contenders_.size() && !stages_.empty(); ++i) {
      const double jitterGoal = contenders_[i]->jitterGoal();
      rows.push_back(
          {contenders_[i]->name(), jitterGoal > 0, summarize(*model_, stages_, i, jitterGoal)});
    }
    if (!rows.empty()) saySummary(rows, console_);
    Json::List list;
    for (const SummaryRow& row : rows) list.push_back(toJson(row));
    return list;
  }

  Renderer& renderer() {
    if (!renderer_) renderer_.emplace();
    return *renderer_;
  }

  std::string pictureFile(const JointPose& pose) const {
    std::string name = pose.name;
    std::string file;
    for (const char c : name) {
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 && (c & 0x80) == 0)
        file += c;
      else if (!file.empty() && file.back() != '-')
        file += '-';
    }
    if (file.ends_with('-')) file.pop_back();
    return options_.pictures + "/" + entrant_.name.substr(0, entrant_.name.find('.')) + "-" + file +
           ".png";
  }

  const Entrant& entrant_;
  const ContestOptions& options_;
  const Console& console_;
  std::vector<Issue>& issues_;
  Judge judge_;
  std::vector<JointPose> poses_;
  std::vector<std::string> clips_;
  std::shared_ptr<const RiggedModel> model_;  // its motions: the poses, the clips
  std::vector<std::unique_ptr<Contender>> contenders_;
  std::vector<StageResult> stages_;
  std::optional<Renderer> renderer_;
  bool canDraw_ = true;
};

}  // namespace

Json runContest(const Entrant& entrant, const ContestOptions& options, const Console& console,
                std::vector<Issue>& issues) {
  return Contest(entrant, options, console, issues).run();
}

}  // namespace fascia
