#include <fascia/geometry/orientation.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

constexpr double kLeastShare = 0.01;   // of the whole surface
constexpr double kMostOpen = 0.2;      // the triangles' sum of areas as vectors, over their area
constexpr double kLeastVolume = 0.01;  // of a ball's of the same area; a double sheet has less
constexpr double kMostWork = 2e8;      // solid angles
constexpr std::size_t kProbes = 5;     // places of a piece that are looked at

struct Piece {
  std::vector<std::uint32_t> triangles;
  double area_m2 = 0, volume_m3 = 0;
  Vec3 sum_m2 = Vec3::Zero();
  Box box;

  bool encloses() const {
    const double ball_m3 = std::pow(area_m2, 1.5) / (6 * std::sqrt(kPi));
    return area_m2 > 0 && sum_m2.norm() < kMostOpen * area_m2 &&
           std::abs(volume_m3) > kLeastVolume * ball_m3;
  }
};

std::array<Vec3, 3> cornersOf(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return {mesh.positions[t[0]].cast<double>(), mesh.positions[t[1]].cast<double>(),
          mesh.positions[t[2]].cast<double>()};
}

std::vector<Piece> piecesOf(const TriangleMesh& mesh, std::span<const std::uint32_t> component,
                            std::uint32_t count) {
  std::vector<Piece> pieces(count);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Piece& piece = pieces[component[mesh.triangles[t][0]]];
    piece.triangles.push_back(t);
    for (const Vec3& p : cornersOf(mesh, t)) piece.box.add(p);
  }
  for (Piece& piece : pieces) {
    if (piece.triangles.empty()) continue;
    // From the middle of the piece, so that holes cost as little as they can.
    const Vec3 middle = piece.box.center();
    for (const std::uint32_t t : piece.triangles) {
      const auto [a, b, c] = cornersOf(mesh, t);
      const Vec3 cross = (b - a).cross(c - a);
      piece.area_m2 += 0.5 * cross.norm();
      piece.sum_m2 += 0.5 * cross;
      piece.volume_m3 += (a - middle).dot((b - middle).cross(c - middle)) / 6;
    }
  }
  return pieces;
}

// How often a piece winds around a point (van Oosterom & Strackee 1983 for a triangle's solid
// angle).
double windings(const TriangleMesh& mesh, const Piece& piece, const Vec3& p) {
  double sum = 0;
  for (const std::uint32_t t : piece.triangles) {
    auto [a, b, c] = cornersOf(mesh, t);
    a -= p, b -= p, c -= p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * kPi);
}

class Nesting {
 public:
  Nesting(const TriangleMesh& mesh, const std::vector<Piece>& pieces)
      : mesh_(mesh), pieces_(pieces) {}

  // The largest piece that most of this one lies in; -1: none.
  int outermost(std::uint32_t inner) {
    int found = -1;
    for (std::uint32_t k = 0; k < pieces_.size(); ++k) {
      const bool larger = std::abs(pieces_[k].volume_m3) > std::abs(pieces_[inner].volume_m3);
      if (k == inner || !larger || !pieces_[k].encloses() || !contains(pieces_[k], pieces_[inner]))
        continue;
      if (found < 0 || std::abs(pieces_[k].volume_m3) >
                           std::abs(pieces_[static_cast<std::size_t>(found)].volume_m3))
        found = static_cast<int>(k);
    }
    return found;
  }
  bool gaveUp() const { return work_ > kMostWork; }

 private:
  bool contains(const Piece& outer, const Piece& inner) {
    if ((inner.box.center().array() < outer.box.low.array()).any() ||
        (inner.box.center().array() > outer.box.high.array()).any())
      return false;
    work_ += static_cast<double>(kProbes * outer.triangles.size());
    if (gaveUp()) return false;
    std::size_t within = 0;
    for (std::size_t i = 0; i < kProbes; ++i) {
      const std::uint32_t t = inner.triangles[i * inner.triangles.size() / kProbes];
      within += std::abs(windings(mesh_, outer, cornersOf(mesh_, t)[0])) > 0.5;
    }
    return 2 * within > kProbes;
  }

  const TriangleMesh& mesh_;
  const std::vector<Piece>& pieces_;
  double work_ = 0;
};

}  // namespace

std::vector<std::uint32_t> insideOutPieces(const TriangleMesh& mesh,
                                           std::span<const std::uint32_t> component,
                                           std::uint32_t count) {
  FASCIA_ASSERT(component.size() == mesh.positions.size(), "a piece for each vertex");
  const std::vector<Piece> pieces = piecesOf(mesh, component, count);
  double area_m2 = 0;
  bool any = false;
  for (const Piece& piece : pieces) {
    area_m2 += piece.area_m2;
    any = any || (piece.volume_m3 < 0 && piece.encloses());
  }
  if (!any) return {};
  Nesting nesting(mesh, pieces);
  std::vector<std::uint32_t> found;
  for (std::uint32_t k = 0; k < count; ++k) {
    if (pieces[k].area_m2 < kLeastShare * area_m2 || !pieces[k].encloses()) continue;
    const int outer = nesting.outermost(k);
    const Piece& judge = outer < 0 ? pieces[k] : pieces[static_cast<std::size_t>(outer)];
    if (judge.volume_m3 < 0) found.push_back(k);
  }
  return nesting.gaveUp() ? std::vector<std::uint32_t>{} : found;
}

}  // namespace fascia
