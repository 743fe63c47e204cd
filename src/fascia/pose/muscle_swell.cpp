#include <fascia/pose/muscle_swell.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

using Eigen::Vector3f;

// Shares of the local radius per unit of `in`: on the bone above a joint and on its own.
constexpr float kAbove = 1.f, kOwn = 0.5f;
// Extensors give up so much of what flexors gain.
constexpr float kThinning = 0.35f;
constexpr float kLeastSlenderness = 1.2f;  // length over radius of a bone with muscles that show

// How far a muscle comes out, in local radii: slowly at first, so that small dials stay subtle.
float strengthOf(float dial) {
  return 0.08f * dial + 0.12f * dial * dial;
}

}  // namespace

MuscleSwell::MuscleSwell(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
                         const SkinSpread& spread, std::span<const float> dial) {
  FASCIA_ASSERT(dial.size() == mesh.size(), "a dial for each point");
  if (std::all_of(dial.begin(), dial.end(), [](float d) { return d <= 0; })) return;
  std::vector<float> strength;
  for (std::uint32_t j = 0; j < source.joints.size(); ++j) {
    const int above = parts.bodyAbove(j);
    if (above < 0 || !parts.part[j].exists()) continue;
    const auto a = static_cast<std::uint32_t>(above);
    if (!parts.meetInCrease(a, j)) continue;
    const auto isLimb = [&](std::uint32_t bone) {
      const LimbPart& part = parts.part[bone];
      return !parts.hub[bone] && part.length_m() > kLeastSlenderness * part.meanRadius_m();
    };
    if (!isLimb(j)) continue;
    const Vector3f up = parts.origin_m[a] - parts.origin_m[j];
    if (up.norm() < 1e-4f * mesh.size_m) continue;
    Muscle muscle{j, a, j, wide(up.normalized()), wide(parts.part[j].axis()), {}, {}};
    muscle.rest = muscle.towardsAbove + muscle.along;
    muscles_.push_back(muscle);
    strength.push_back(kOwn);
    if (!isLimb(a)) continue;
    muscle.bone = a;
    muscles_.push_back(muscle);
    strength.push_back(kAbove);
  }
  parallelFor(muscles_.size(),
              [&](std::size_t k) { prepare(mesh, parts, spread, dial, strength[k], muscles_[k]); });
}

void MuscleSwell::prepare(const PoseMesh& mesh, const LimbParts& parts, const SkinSpread& spread,
                          std::span<const float> dial, float strength, Muscle& muscle) {
  const LimbPart& bone = parts.part[muscle.bone];
  FASCIA_ASSERT(bone.length_m() > 0, "a bone with a muscle has a length");
  std::vector<float> field[3];
  for (std::vector<float>& f : field) f.assign(mesh.size(), 0.f);
  for (const std::uint32_t i : parts.skin[muscle.bone]) {
    const float t = (mesh.rest[i] - bone.begin_m()).dot(bone.axis()) / bone.length_m();
    const float belly = smoothStep(1.6f * (0.5f - std::abs(t - 0.5f)) / 0.5f);
    const float amount =
        strength * strengthOf(dial[i]) * belly * parts.radius_m[i] * mesh.area_m2[i];
    for (int c = 0; c < 3; ++c) field[c][i] = amount * mesh.normal[i][c];
  }
  SupernodalCholesky::Scratch scratch;
  spread.spread(field[0], field[1], field[2], scratch);
  float most = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i)
    most = std::max({most, std::abs(field[0][i]), std::abs(field[1][i]), std::abs(field[2][i])});
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    const Vector3f per(field[0][i], field[1][i], field[2][i]);
    if (per.lpNorm<Eigen::Infinity>() > 1e-3f * most) muscle.reach.push_back({i, per});
  }
}

void MuscleSwell::swell(std::span<const JointMotion> motion, std::span<float> along) const {
  for (const Muscle& m : muscles_) {
    FASCIA_ASSERT(m.above < motion.size() && m.joint < motion.size() && m.bone < motion.size(),
                  "the muscle's joints move");
    const Vector4f in =
        motion[m.above].rotation * m.towardsAbove + motion[m.joint].rotation * m.along;
    const Vector4f bent = motion[m.bone].rotation.back(in) - m.rest;
    if (bent.squaredNorm() < 1e-8f) continue;
    const Vector3f by = narrow(bent);
    for (const Reach& r : m.reach) {
      const float out = by.dot(r.per);
      along[r.point] += out > 0 ? out : kThinning * out;
    }
  }
}

}  // namespace fascia
