#include "report_map.h"

#include <algorithm>

#include <fmt/format.h>

namespace fascia {

void reportMap(const MotionFile& file, const RiggedModel& rig, const Console& console) {
  const auto driven = std::count_if(file.map.begin(), file.map.end(), [](const JointPair& pair) {
    return !pair.source.empty() && !pair.target.empty();
  });
  console.say(fmt::format("{}: {} joints in {}; drives {} of the rig's {}", file.figure.motion.name,
                          file.figure.joints.size(), file.unit, driven, rig.joints.size()));
  console.detail(printJointMap(file.map));
  for (const std::string& note : file.notes) console.detail(note);
}

}  // namespace fascia
