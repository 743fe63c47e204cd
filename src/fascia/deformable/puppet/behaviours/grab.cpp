#include <fascia/deformable/puppet/behaviour.h>

namespace fascia {

BehaviourPtr makeGrab(PuppetPointId point, const Target& target, const ChaseOptions& options) {
  return sequence(makeChase(point, target, options), makeConnect(point, target));
}

}  // namespace fascia
