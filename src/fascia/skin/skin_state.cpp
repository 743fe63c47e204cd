#include <algorithm>

#include <fascia/skin/resample.h>
#include <fascia/skin/skin.h>

namespace fascia {

void SkinState::addTo(StateHash& hash, const GridLayout& g) const {
  const auto columns = static_cast<std::size_t>(g.columns);
  for (const VectorArray* a : {&position, &velocity})
    for (const FloatArray* axis : {&a->x, &a->y, &a->z})
      for (int j = 0; j < g.rows; ++j) hash.add(axis->data() + g.row(j), columns * sizeof(float));
}

void carrySkin(const Skin& skin, const SkinPose& pose, SkinState& state) {
  const GridLayout& g = skin.layout();
  VectorArray scratch;
  state.position.resize(g.storage());
  state.velocity.resize(g.storage());
  state.velocity.fill(0.f);
  skin.carriers().place(*pose.field, scratch, state.position);
  for (const Skin::Fixed& f : skin.fixed()) {
    const Vec3 p = pose.joints[f.joint.index()].point(f.position_joint);
    state.position.x[f.point] = static_cast<float>(p.x());
    state.position.y[f.point] = static_cast<float>(p.y());
    state.position.z[f.point] = static_cast<float>(p.z());
  }
  fillPads(g, state.position);
}

void measureSkin(const Skin& skin, const SkinPose& pose, const SkinState& state, SkinStats& stats) {
  const FleshContact contact({skin.blocks().begin(), skin.blocks().end()});
  stats.max_penetration_m = std::max<double>(
      stats.max_penetration_m, contact.deepest(*pose.field, skin.points(), state.position));
  stats.max_edge_stretch =
      std::max(stats.max_edge_stretch, skin.elastic().maxStretch(state.position));
}

SkinState resampled(const Skin& from, const SkinState& state, const Skin& to) {
  SkinState out;
  out.position = resample(from.layout(), state.position, to.layout());
  out.velocity = resample(from.layout(), state.velocity, to.layout());
  out.maxSpeed_m_per_s = state.maxSpeed_m_per_s;
  return out;
}

void skinSurface(const Skin& skin, const SkinState& state, TriangleMesh& mesh) {
  const int columns = skin.columns(), rows = skin.rows();
  const auto across = static_cast<std::uint32_t>(columns + 1);
  const std::size_t vertices =
      static_cast<std::size_t>(columns + 1) * static_cast<std::size_t>(rows) + 2;
  const bool first = mesh.positions.size() != vertices;
  mesh.positions.resize(vertices);
  Eigen::Vector3f centers[2] = {Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const std::size_t k = skin.layout().at(i % columns, j);
      const Eigen::Vector3f p(state.position.x[k], state.position.y[k], state.position.z[k]);
      mesh.positions[static_cast<std::size_t>(j) * across + static_cast<std::size_t>(i)] = p;
      if (i < columns && (j == 0 || j + 1 == rows)) centers[j == 0 ? 0 : 1] += p;
    }
  }
  const auto cap = static_cast<std::uint32_t>(vertices - 2);
  mesh.positions[cap] = centers[0] / static_cast<float>(columns);
  mesh.positions[cap + 1] = centers[1] / static_cast<float>(columns);

  if (first) {
    mesh.triangles.clear();
    mesh.uvs.clear();
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i <= columns; ++i)
        mesh.uvs.emplace_back(static_cast<float>(i) / static_cast<float>(columns),
                              1 - static_cast<float>(j) / static_cast<float>(rows - 1));
    mesh.uvs.emplace_back(0.5f, 1.f);
    mesh.uvs.emplace_back(0.5f, 0.f);
    const auto last = static_cast<std::uint32_t>(rows - 1) * across;
    for (std::uint32_t j = 0; j + 1 < static_cast<std::uint32_t>(rows); ++j) {
      for (std::uint32_t i = 0; i + 1 < across; ++i) {
        const std::uint32_t a = j * across + i, b = a + 1, c = a + across, d = c + 1;
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({a, d, c});
      }
    }
    for (std::uint32_t i = 0; i + 1 < across; ++i) {
      mesh.triangles.push_back({cap, i + 1, i});
      mesh.triangles.push_back({cap + 1, last + i, last + i + 1});
    }
  }
  computeNormals(mesh.positions, mesh.triangles, mesh.normals);
  // The seam's two copies of a point share one normal, or the seam would show.
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rows); ++j) {
    Eigen::Vector3f &a = mesh.normals[j * across], &b = mesh.normals[j * across + across - 1];
    const Eigen::Vector3f sum = a + b;
    if (sum.squaredNorm() > 1e-12f) a = b = sum.normalized();
  }
}

}  // namespace fascia
