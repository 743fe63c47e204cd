#pragma once

#include <string>
#include <vector>

#include <fascia/rig/joint_pose.h>

#include "bench/deformation/judge.h"

namespace fascia {

// What all contenders did on one stage; linear blending is the first.
struct StageResult {
  std::string name;
  bool isPose = false;
  bool isBend = false;  // of a hinge: an elbow, a knee
  std::vector<std::string> methods;
  std::vector<Score> scores;
  std::vector<double> frame_s;
};

// One number that sums a rig up, and what it should be at most.
struct SummaryMeasure {
  std::string key;      // for machines
  std::string meaning;  // for people: "crossings in a pose"
  double value = 0;     // NaN: nothing to measure
  double goal = 0;      // NaN: none
  bool isKnown() const { return value == value; }
  bool isMet() const { return !isKnown() || !(goal == goal) || value <= goal; }
};

// One contender against linear blending over all of a rig's stages. `number` of it in the results;
// `jitterGoal` see Contender.
std::vector<SummaryMeasure> summarize(const RiggedModel& model,
                                      const std::vector<StageResult>& stages, std::size_t number,
                                      double jitterGoal);

}  // namespace fascia
