#pragma once

#include <memory>
#include <string>
#include <vector>

#include <fascia/character/character_def.h>
#include <fascia/rig/rigged_model.h>

#include "console.h"

namespace fascia {

inline constexpr double kContestRate_hz = 60;

// A rig, which of its motions is to be shown, and where its joints are in every frame: from the
// bind pose to the frame.
struct ContestStage {
  std::shared_ptr<const RiggedModel> model;
  int motion = 0;
  std::vector<std::vector<Transform>> motions;  // frame, joint
};
// Frames at kContestRate_hz, for at most `longest_s`.
ContestStage makeContestStage(std::shared_ptr<const RiggedModel> model, int motion,
                              double longest_s);

// A motion as one way of skinning shows it.
struct ContestFrames {
  std::vector<std::vector<Eigen::Vector3f>> frames;  // the model's points; as many as the stage's
  double frame_s = 0;  // time that it takes to pose the joints and deform the points, per frame
};

// One way of skinning.
class Contender {
 public:
  virtual ~Contender() = default;
  virtual std::string name() const = 0;
  virtual ContestFrames perform(const ContestStage& stage, const Console& console) = 0;
  // How much more than linear blending it may tremble; 0: nobody asks.
  virtual double jitterGoal() const { return 0; }
};

// Linear blending first, dual quaternions, delta mush; Fascia too, if there is a character.
// `model` has all motions that will be shown.
std::vector<std::unique_ptr<Contender>> makeContenders(std::shared_ptr<const RiggedModel> model,
                                                       const CharacterDef* character);

}  // namespace fascia
