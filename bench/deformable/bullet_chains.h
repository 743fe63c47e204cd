#pragma once

namespace fascia {

// The same chains in Bullet, where the build has found it: as articulated multibodies with
// spherical joints (Featherstone), and as rigid bodies with point-to-point constraints. Prints one
// line each.
void printBulletChains(int chains, int barsPerChain);

}  // namespace fascia
