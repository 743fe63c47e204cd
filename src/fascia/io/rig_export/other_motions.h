#pragma once

#include <string>
#include <vector>

#include <fascia/io/rig_export/rig_source.h>

namespace fascia {

// A motion of the file that is not baked.
struct OtherMotion {
  std::string name;
  int motion = 0;     // in RiggedModel::motions
  int animation = 0;  // in the document
  double start_s = 0, duration_s = 0;

  // Moments of it, evenly spread from its beginning to its end; at least two.
  std::vector<double> times(std::size_t count) const;
  // … and where the joints are then: per moment, per joint, the motion from the bind pose.
  BoneFrames bones(const RiggedModel& model, const std::vector<double>& times_s) const;
};

std::vector<OtherMotion> otherMotions(const RigSource& source);

// Poses of all of them, so many in all, or two of each if that is more.
BoneFrames posesOfOthers(const RiggedModel& model, const std::vector<OtherMotion>& others,
                         std::size_t most);

// How far each of them is in a written file from what it was in the source: both are played.
std::vector<RigBakeReport::Motion> measureOthers(const RigSource& source, const std::string& path,
                                                 const std::vector<OtherMotion>& others);

}  // namespace fascia
