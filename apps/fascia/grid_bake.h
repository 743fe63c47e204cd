#pragma once

#include <span>
#include <string>
#include <vector>

#include <fascia/character/recording.h>
#include <fascia/io/glb_export/grid_writer.h>

#include "console.h"
#include "rig_bake.h"

namespace fascia {

// How a character whose skin is a grid becomes a .glb: morphs if nothing is said, bones, or cache
// (every vertex of every frame). `options` are those that rigs have, too.

// Whether it becomes one small file of all motions; otherwise see writeGlb.
bool isSmallGridBake(const Character& character, const RigBakeOptions& options);

GridBakeReport writeGridBake(const Character& character,
                             std::span<const Recording* const> recordings,
                             const RigBakeOptions& options, const std::string& path,
                             const Console& console);

// Says how faithful each motion is, for a person; for a machine the same.
Json describe(const GridBakeReport& report, std::span<const Recording* const> recordings,
              const RigBakeOptions& options, const std::string& path, const Console& console);

}  // namespace fascia
