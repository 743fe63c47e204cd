#include <fascia/geometry/editable_mesh.h>

#include <algorithm>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

bool has(const EditableMesh::Corners& t, std::uint32_t p) {
  return t[0] == p || t[1] == p || t[2] == p;
}

// The corner of a triangle that is neither.
std::uint32_t third(const EditableMesh::Corners& t, std::uint32_t a, std::uint32_t b) {
  for (const std::uint32_t p : t)
    if (p != a && p != b) return p;
  return t[0];
}

}  // namespace

EditableMesh::EditableMesh(const TriangleMesh& mesh)
    : triangles_(mesh.triangles), around_(mesh.positions.size()) {
  for (const Eigen::Vector3f& p : mesh.positions) places_.push_back(p.cast<double>());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    for (const std::uint32_t p : triangles_[t]) around_[p].push_back(t);
}

std::vector<EditableMesh::Edge> EditableMesh::edges() const {
  std::vector<Edge> out;
  std::vector<std::uint32_t> beyond;
  for (std::uint32_t a = 0; a < places_.size(); ++a) {
    beyond.clear();
    for (const std::uint32_t t : around_[a])
      for (const std::uint32_t b : triangles_[t])
        if (b > a) beyond.push_back(b);
    std::sort(beyond.begin(), beyond.end());
    beyond.erase(std::unique(beyond.begin(), beyond.end()), beyond.end());
    for (const std::uint32_t b : beyond) out.push_back({a, b});
  }
  return out;
}

// The triangle in which b follows a.
std::optional<std::uint32_t> EditableMesh::triangleAlong(std::uint32_t a, std::uint32_t b) const {
  for (const std::uint32_t t : around_[a]) {
    const Corners& c = triangles_[t];
    for (std::size_t k = 0; k < 3; ++k)
      if (c[k] == a && c[(k + 1) % 3] == b) return t;
  }
  return std::nullopt;
}

std::optional<std::array<std::uint32_t, 2>> EditableMesh::wings(std::uint32_t a,
                                                                std::uint32_t b) const {
  const auto left = triangleAlong(a, b), right = triangleAlong(b, a);
  if (!left || !right) return std::nullopt;
  return std::array{third(triangles_[*left], a, b), third(triangles_[*right], a, b)};
}

bool EditableMesh::isEdge(std::uint32_t a, std::uint32_t b) const {
  return std::any_of(around_[a].begin(), around_[a].end(),
                     [&](std::uint32_t t) { return has(triangles_[t], b); });
}

void EditableMesh::replaceCorner(std::uint32_t triangle, std::uint32_t from, std::uint32_t to) {
  for (std::uint32_t& p : triangles_[triangle])
    if (p == from) p = to;
}

void EditableMesh::detach(std::uint32_t triangle, std::uint32_t p) {
  std::erase(around_[p], triangle);
}

std::uint32_t EditableMesh::split(std::uint32_t a, std::uint32_t b, const Vec3& place) {
  const auto middle = static_cast<std::uint32_t>(places_.size());
  places_.push_back(place);
  around_.emplace_back();
  for (const std::uint32_t t : {*triangleAlong(a, b), *triangleAlong(b, a)}) {
    const auto half = static_cast<std::uint32_t>(triangles_.size());
    const std::uint32_t wing = third(triangles_[t], a, b);
    triangles_.push_back(triangles_[t]);
    replaceCorner(t, b, middle);
    replaceCorner(half, a, middle);
    detach(t, b);
    around_[b].push_back(half);
    around_[wing].push_back(half);
    around_[middle].push_back(t);
    around_[middle].push_back(half);
  }
  return middle;
}

// The link condition (Dey et al. 1999): what both ends have for neighbours are the two wings.
bool EditableMesh::canCollapse(std::uint32_t a, std::uint32_t b) const {
  const auto wing = wings(a, b);
  if (!wing || (*wing)[0] == (*wing)[1]) return false;
  if (valence((*wing)[0]) <= 3 || valence((*wing)[1]) <= 3) return false;
  if (valence(a) + valence(b) < 7) return false;
  for (const std::uint32_t t : around_[a])
    for (const std::uint32_t p : triangles_[t])
      if (p != a && p != b && p != (*wing)[0] && p != (*wing)[1] && isEdge(b, p)) return false;
  return true;
}

void EditableMesh::collapse(std::uint32_t a, std::uint32_t b, const Vec3& place) {
  FASCIA_ASSERT(canCollapse(a, b), "the mesh stays 2-manifold");
  for (const std::uint32_t t : {*triangleAlong(a, b), *triangleAlong(b, a)}) {
    const Corners gone = triangles_[t];
    for (const std::uint32_t p : gone) detach(t, p);
  }
  for (const std::uint32_t t : around_[b]) {
    replaceCorner(t, b, a);
    around_[a].push_back(t);
  }
  around_[b].clear();
  places_[a] = place;
}

bool EditableMesh::canFlip(std::uint32_t a, std::uint32_t b) const {
  const auto wing = wings(a, b);
  return wing && (*wing)[0] != (*wing)[1] && valence(a) > 3 && valence(b) > 3 &&
         !isEdge((*wing)[0], (*wing)[1]);
}

void EditableMesh::flip(std::uint32_t a, std::uint32_t b) {
  FASCIA_ASSERT(canFlip(a, b), "the mesh stays 2-manifold");
  const std::uint32_t left = *triangleAlong(a, b), right = *triangleAlong(b, a);
  const std::uint32_t l = third(triangles_[left], a, b), r = third(triangles_[right], a, b);
  replaceCorner(left, b, r);
  replaceCorner(right, a, l);
  detach(left, b);
  detach(right, a);
  around_[r].push_back(left);
  around_[l].push_back(right);
}

TriangleMesh EditableMesh::mesh() const {
  TriangleMesh out;
  std::vector<std::uint32_t> number(places_.size());
  std::vector<char> used(triangles_.size(), 0);
  for (std::uint32_t p = 0; p < places_.size(); ++p) {
    if (around_[p].empty()) continue;
    number[p] = static_cast<std::uint32_t>(out.positions.size());
    out.positions.push_back(places_[p].cast<float>());
    for (const std::uint32_t t : around_[p]) used[t] = 1;
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (!used[t]) continue;
    const Corners& c = triangles_[t];
    out.triangles.push_back({number[c[0]], number[c[1]], number[c[2]]});
  }
  return out;
}

}  // namespace fascia
