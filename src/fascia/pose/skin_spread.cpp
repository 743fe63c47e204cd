#include <fascia/pose/skin_spread.h>

#include <fascia/base/assert.h>

namespace fascia {

SkinSpread::SkinSpread(const PoseMesh& mesh, const LimbParts& parts) {
  constexpr double kReach = 0.35;  // square of the smoothing length, in local radii
  FASCIA_ASSERT(parts.radius_m.size() == mesh.size(), "a radius for each point");
  std::vector<Eigen::Triplet<double>> entries;
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    const int row = static_cast<int>(i);
    entries.emplace_back(row, row, double{mesh.area_m2[i]});
    for (const PoseMesh::Edge& e : mesh.around(i)) {
      const double c =
          kReach * double{parts.radius_m[i]} * double{parts.radius_m[e.to]} * double{e.weight};
      entries.emplace_back(row, row, c);
      if (e.to < i) entries.emplace_back(row, static_cast<int>(e.to), -c);
    }
  }
  const auto n = static_cast<Eigen::Index>(mesh.size());
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  if (!system_.factorize(matrix)) system_ = {};  // cannot be: diagonally dominant
}

}  // namespace fascia
