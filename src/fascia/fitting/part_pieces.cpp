#include <fascia/fitting/part_pieces.h>

#include <algorithm>
#include <limits>
#include <map>

namespace fascia {
namespace {

constexpr double kBulky = 0.3;  // of the bulkiest piece's volume
constexpr double kEmpty = 0.5;  // most of a worn piece that is filled

struct Piece {
  double bulk_m3 = 0, nearest_m = std::numeric_limits<double>::infinity();
};

struct Filling {
  double area_m2 = 0, filled_m2 = 0;
  double share() const { return area_m2 > 0 ? filled_m2 / area_m2 : 0; }
};

std::map<std::uint32_t, Filling> fillings(const FitSetting& setting, const FleshPart& part,
                                          const std::vector<NamedSolid>& solids) {
  std::map<std::uint32_t, Filling> out;
  const std::vector<double> gaps = gaps_m(part, solids);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    const SurfaceSample& s = part.own[i];
    Filling& piece = out[s.piece];
    piece.area_m2 += s.area_m2;
    if (gaps[i] < setting.mostGap_m(s)) piece.filled_m2 += s.area_m2;
  }
  return out;
}

}  // namespace

std::optional<std::uint32_t> corePiece(const FleshPart& part, const BoneFrame& frame) {
  std::map<std::uint32_t, Piece> pieces;
  for (const SurfaceSample& s : part.own) {
    Piece& piece = pieces[s.piece];
    piece.bulk_m3 += s.area_m2 * s.radius_m;
    piece.nearest_m = std::min(piece.nearest_m, (s.position_m - frame.world.translation_m).norm());
  }
  if (pieces.size() < 2) return std::nullopt;
  double most_m3 = 0;
  for (const auto& [id, piece] : pieces) most_m3 = std::max(most_m3, piece.bulk_m3);
  std::optional<std::uint32_t> core;
  for (const auto& [id, piece] : pieces) {
    if (piece.bulk_m3 < kBulky * most_m3) continue;
    if (!core || piece.nearest_m < pieces[*core].nearest_m) core = id;
  }
  return core;
}

FleshPart onlyPiece(const FitSetting& setting, const BoneFrame& frame, const FleshPart& part,
                    std::uint32_t piece) {
  const auto isOf = [&](const SurfaceSample& s) { return s.piece == piece; };
  std::vector<SurfaceSample> own;
  std::ranges::copy_if(part.own, std::back_inserter(own), isOf);
  FleshPart out = subPart(setting.symmetry, frame, part, std::move(own), part.central);
  std::ranges::copy_if(part.blend, std::back_inserter(out.blend), isOf);
  return out;
}

double filledShare(const FitSetting& setting, const FleshPart& part,
                   const std::vector<NamedSolid>& solids, std::uint32_t piece) {
  return fillings(setting, part, solids)[piece].share();
}

std::vector<std::uint32_t> wornPieces(const FitSetting& setting, const FleshPart& part,
                                      const std::vector<NamedSolid>& solids, std::uint32_t core) {
  std::map<std::uint32_t, Filling> all = fillings(setting, part, solids);
  std::vector<std::uint32_t> worn;
  if (all[core].share() < kWellFilled) return worn;
  for (const auto& [piece, filling] : all)
    if (piece != core && filling.share() < kEmpty) worn.push_back(piece);
  return worn;
}

}  // namespace fascia
