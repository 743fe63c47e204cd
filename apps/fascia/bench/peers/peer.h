#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/sheet/sheet_scene.h"

namespace fascia {

// Another engine that can simulate the sheet.
struct Peer {
  const char* name;
  // Effort 1 is its default; with twice the effort it takes twice as many steps, stretches less and
  // is slower.
  std::string (*setting)(int effort);
  std::unique_ptr<SheetSolver> (*make)(const SheetScene& scene, int effort, int threads);
  bool threaded;
};

// One file each; built where the engine is installed.
extern const Peer kBulletPeer, kJoltPeer;

// Those that were there when this was built.
std::vector<Peer> sheetPeers();

}  // namespace fascia
