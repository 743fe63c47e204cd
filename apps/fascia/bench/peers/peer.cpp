#include "bench/peers/peer.h"

namespace fascia {

std::vector<Peer> sheetPeers() {
  return {
#ifdef FASCIA_WITH_BULLET
      kBulletPeer,
#endif
#ifdef FASCIA_WITH_JOLT
      kJoltPeer,
#endif
  };
}

}  // namespace fascia
