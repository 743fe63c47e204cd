#include <fascia/skin/point/face_samples.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/math/points.h>

namespace fascia {
namespace {

using Face = std::array<std::uint32_t, 3>;

constexpr std::size_t kFacesPerBlock = 16;
constexpr int kLooks = 6;  // per edge, to find out how deep a face sinks
// Share of the fat that is left where a face is near the flesh.
constexpr double kNear = 0.75;
// What a motion may make of the depth at rest.
constexpr double kInMotion = 2;
// More would cost more than they are worth: such a skin wants more points.
constexpr int kMostPieces = 8;

// visit(weights) for the places that cut edges into n pieces; corners are left out.
template <class Visit>
void forEachPlace(int n, const Visit& visit) {
  const auto share = [n](int i) { return static_cast<float>(i) / static_cast<float>(n); };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      if (i < n && j < n && i + j > 0)
        visit(std::array<float, 3>{share(i), share(j), share(n - i - j)});
}

bool isOnEdge(const std::array<float, 3>& weights) {
  return std::ranges::find(weights, 0.f) != weights.end();
}

std::uint64_t edgeKey(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::max(a, b)} << 32u | std::min(a, b);
}

// The least distance of each face from any solid, but no more than `enough_m`.
void leastDistances(const DistanceField& field, std::span<const Face> faces,
                    const VectorArray& rest, float enough_m, std::span<float> least_m) {
  std::vector<float> x, y, z;
  Box box;
  for (const Face& face : faces)
    forEachPlace(kLooks, [&](const std::array<float, 3>& weights) {
      Eigen::Vector3f p = Eigen::Vector3f::Zero();
      for (std::size_t c = 0; c < 3; ++c) p += weights[c] * floatPointAt(rest, face[c]);
      x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z());
      box.add(p.cast<double>());
    });
  const std::size_t count = x.size(), looks = count / faces.size();
  std::vector<float> distance(count), nx(count), ny(count), nz(count);
  std::ranges::fill(least_m, enough_m);
  for (std::size_t s = 0; s < field.solidCount(); ++s) {
    const SolidId solid(static_cast<std::int64_t>(s));
    const Box bounds = field.bounds(solid);
    if ((box.low.array() - enough_m > bounds.high.array()).any() ||
        (box.high.array() + enough_m < bounds.low.array()).any())
      continue;
    field.evaluate(solid, {x.data(), y.data(), z.data(), count}, distance.data(),
                   {nx.data(), ny.data(), nz.data(), count});
    for (std::size_t i = 0; i < count; ++i)
      least_m[i / looks] = std::min(least_m[i / looks], distance[i]);
  }
}

// Into how many pieces the edges of each face are to be cut; 1: no samples.
std::vector<int> piecesOf(const DistanceField& field, std::span<const Face> faces,
                          const VectorArray& rest, double fat_m, double tolerance_m) {
  std::vector<float> least_m(faces.size());
  const auto enough_m = static_cast<float>(kNear * fat_m);
  parallelFor((faces.size() + kFacesPerBlock - 1) / kFacesPerBlock, [&](std::size_t b) {
    const std::size_t first = b * kFacesPerBlock,
                      count = std::min(kFacesPerBlock, faces.size() - first);
    leastDistances(field, faces.subspan(first, count), rest, enough_m,
                   std::span(least_m).subspan(first, count));
  });
  std::vector<int> pieces;
  for (const float least : least_m) {
    // Half as long pieces sag a quarter as deep.
    const double wanted = std::sqrt(kInMotion * std::max(0.0, fat_m - double{least}) / tolerance_m);
    pieces.push_back(
        least < enough_m ? std::clamp(static_cast<int>(std::ceil(wanted)), 2, kMostPieces) : 1);
  }
  return pieces;
}

class Sampler {
 public:
  Sampler(std::span<const Face> faces, std::span<const int> pieces)
      : faces_(faces), pieces_(pieces) {
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (std::size_t e = 0; e < 3; ++e) {
        int& most = edges_[edgeKey(faces[f][e], faces[f][(e + 1) % 3])];
        most = std::max(most, pieces[f]);
      }
  }

  void addBlock(std::size_t first, std::size_t count) {
    const std::size_t firstSample = out_.samples.size(), firstPoint = out_.points.size();
    for (std::size_t f = first; f < first + count; ++f) addFace(f);
    if (out_.samples.size() == firstSample) return;
    for (std::size_t i = firstSample; i < out_.samples.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        if (out_.samples[i].weights[c] > 0) out_.points.push_back(out_.samples[i].corners[c]);
    const auto begin = out_.points.begin() + static_cast<std::ptrdiff_t>(firstPoint);
    std::sort(begin, out_.points.end());
    out_.points.erase(std::unique(begin, out_.points.end()), out_.points.end());
    const auto narrow = [](std::size_t n) { return static_cast<std::uint32_t>(n); };
    out_.blocks.push_back({narrow(firstSample), narrow(out_.samples.size() - firstSample),
                           narrow(firstPoint), narrow(out_.points.size() - firstPoint)});
  }
  FaceSamples take() {
    addEdges();
    return std::move(out_);
  }

 private:
  void addFace(std::size_t f) {
    const Face& face = faces_[f];
    for (std::size_t e = 0; e < 3; ++e) addEdge(face[e], face[(e + 1) % 3]);
    if (pieces_[f] == 1) return;
    forEachPlace(pieces_[f], [&](const std::array<float, 3>& weights) {
      if (!isOnEdge(weights)) out_.samples.push_back({face, weights});
    });
  }
  // Of the two faces at an edge the first one brings its samples.
  void addEdge(std::uint32_t a, std::uint32_t b) {
    int& pieces = edges_[edgeKey(a, b)];
    for (int i = 1; i < pieces; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(pieces);
      out_.samples.push_back({{a, b, b}, {1 - t, t, 0}});
    }
    pieces = 1;
  }

  void addEdges() {
    const std::unordered_set<std::uint32_t> moved(out_.points.begin(), out_.points.end());
    for (const Face& face : faces_)
      for (std::size_t e = 0; e < 3; ++e) {
        const std::uint32_t a = face[e], b = face[(e + 1) % 3];
        if ((moved.contains(a) || moved.contains(b)) && edges_.erase(edgeKey(a, b)) > 0)
          out_.edges.push_back({{a, b}, 0});
      }
  }

  std::span<const Face> faces_;
  std::span<const int> pieces_;
  std::unordered_map<std::uint64_t, int> edges_;  // pieces that an edge is still to be cut into
  FaceSamples out_;
};

}  // namespace

FaceSamples sampleFaces(const DistanceField& field, std::span<const Face> faces,
                        const VectorArray& rest, double fat_m, double tolerance_m) {
  FASCIA_ASSERT(tolerance_m > 0, "something is left between samples");
  const std::vector<int> pieces = piecesOf(field, faces, rest, fat_m, tolerance_m);
  if (std::ranges::all_of(pieces, [](int n) { return n == 1; })) return {};
  Sampler sampler(faces, pieces);
  for (std::size_t f = 0; f < faces.size(); f += kFacesPerBlock)
    sampler.addBlock(f, std::min(kFacesPerBlock, faces.size() - f));
  FaceSamples out = sampler.take();
  measureEdges(rest, out);
  return out;
}

void measureEdges(const VectorArray& rest, FaceSamples& faces) {
  for (FaceSamples::Edge& edge : faces.edges)
    edge.rest_m = (floatPointAt(rest, edge.ends[1]) - floatPointAt(rest, edge.ends[0])).norm();
}

}  // namespace fascia
