#include <fascia/deformable/puppet/behaviour.h>

namespace fascia {

BehaviourPtr makeMove(PuppetPointId point, const Vec3& place_m, const ChaseOptions& options) {
  ChaseOptions chase = options;
  const bool comesToRest =
      !options.finalVelocity_m_per_s || options.finalVelocity_m_per_s->isZero(0);
  if (comesToRest) chase.finalVelocity_m_per_s = Vec3::Zero();
  chase.keepControl = options.keepControl || comesToRest;
  return makeChase(point, place_m, chase);
}

}  // namespace fascia
