#include <fascia/render/blended_skin.h>

#include <fascia/rig/morph_blend.h>

namespace fascia {

BlendedSkin::BlendedSkin(const Character& character)
    : model_(*character.def().rig->model),
      joints_(character),
      blend_(model_),
      points_(model_.points_m.size()) {}

void BlendedSkin::compute(const CharacterState& state, std::vector<Eigen::Vector3f>& positions) {
  joints_.motion(state.skeleton, motion_);
  blend_.deform(motion_, points_);
  addMorphs(model_, state.morphs.weights, motion_, 1, points_);
  positions.resize(model_.vertices.size());
  for (std::size_t v = 0; v < positions.size(); ++v)
    positions[v] = points_[model_.vertices[v].point];
}

}  // namespace fascia
