#include <fascia/character/flesh_character.h>

#include <algorithm>

#include <fascia/pose/softness.h>

namespace fascia {
namespace {

// Skin for an imported figure: its pose function. A simulated membrane on top of it is held
// closely, and evens out what joints fold over a few hundredths of the figure's size.
SkinDef skinFor(const RiggedModel& model, const SkinPoseDef& dials) {
  const double size = model.size_m();
  SkinDef skin;
  skin.mesh.pose = dials;
  skin.fat.thickness_m = std::clamp(0.1 * size, 1e-6, 1.0);
  if (!dials.simulate) return skin;
  skin.tissue.stiffness_N_per_m3 = 20000;
  skin.tissue.damping_Ns_per_m3 = 300;
  skin.tissue.carry = 0.75;
  const double evening_m = 0.006 * size;
  const double stretch =
      std::clamp(skin.tissue.stiffness_N_per_m3 * evening_m * evening_m, 1e-3, 1e6);
  skin.material.stretch_u_N_per_m = skin.material.stretch_v_N_per_m = stretch;
  skin.material.shear_N_per_m = 0.5 * stretch;
  skin.material.prestretch = 1;
  return skin;
}

// What follows a single joint stays as hard as its artist made it: say so, and how to have it else.
void noteStiffPieces(const RiggedModel& model, std::vector<std::string>& notes) {
  const std::vector<char> stiff =
      stiffPieces({model.points_m, model.weights, model.triangles, model.joints});
  const auto hard = std::count(stiff.begin(), stiff.end(), 1);
  if (hard == 0) return;
  notes.push_back(std::to_string(hard) + " of " + std::to_string(stiff.size()) +
                  " points belong to pieces that a single joint carries: they stay hard "
                  "(\"parts\" with \"rigid\": false makes one soft)");
}

}  // namespace

FleshedCharacter fleshCharacter(const std::shared_ptr<const RiggedModel>& model,
                                const FitOptions& fit, const SkinPoseDef& dials) {
  FitOptions fitting = fit;
  fitting.muscle = dials.muscle;
  FleshedCharacter out;
  out.fit = fitFlesh(*model, fitting);
  noteStiffPieces(*model, out.fit.notes);
  out.def.name = model->name;
  out.def.skeleton = out.fit.skeleton;
  out.def.flesh = out.fit.flesh;
  out.def.rig = RigDef{.file = model->sourceFile, .model = model};
  out.def.skin = skinFor(*model, dials);
  return out;
}

}  // namespace fascia
