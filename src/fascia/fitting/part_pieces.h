#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <fascia/fitting/joint_frames.h>
#include <fascia/fitting/part_fit.h>

namespace fascia {

// A part whose skin is several pieces of the mesh: a head and its hat, a chest and a jacket.

// Share of the body's piece that is filled, for others to be called worn.
inline constexpr double kWellFilled = 0.7;

// The piece that is the body itself: of the bulky ones the nearest to the joint. None if the part
// is one piece.
std::optional<std::uint32_t> corePiece(const FleshPart& part, const BoneFrame& frame);

// The part without its other pieces.
FleshPart onlyPiece(const FitSetting& setting, const BoneFrame& frame, const FleshPart& part,
                    std::uint32_t piece);

// Share of a piece's skin, where there is room beneath, that the solids come near enough to.
double filledShare(const FitSetting& setting, const FleshPart& part,
                   const std::vector<NamedSolid>& solids, std::uint32_t piece);

// Pieces that the solids leave empty, though they fill the core: they are worn.
std::vector<std::uint32_t> wornPieces(const FitSetting& setting, const FleshPart& part,
                                      const std::vector<NamedSolid>& solids, std::uint32_t core);

}  // namespace fascia
