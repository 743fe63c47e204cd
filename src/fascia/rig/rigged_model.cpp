#include <fascia/rig/rigged_model.h>

#include <fascia/base/assert.h>

namespace fascia {

void poseRig(const RiggedModel& model, int motion, double time_s, std::vector<Transform>& world) {
  FASCIA_ASSERT(motion < static_cast<int>(model.motions.size()), "the motion exists");
  const std::size_t count = model.joints.size();
  world.resize(count);
  if (motion < 0) {
    for (std::size_t j = 0; j < count; ++j) world[j] = model.joints[j].rest_world;
    return;
  }
  const SampledMotion& m = model.motions[static_cast<std::size_t>(motion)];
  for (std::size_t j = 0; j < count; ++j) {
    const Transform local = sampleJoint(m, j, time_s);
    const int parent = model.joints[j].parent;
    world[j] = parent < 0 ? local : world[static_cast<std::size_t>(parent)] * local;
  }
}

}  // namespace fascia
