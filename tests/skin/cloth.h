#pragma once

#include <fascia/skin/cloth/cloth_stepper.h>

#include "pinned_sheet.h"

namespace fascia::test {

// A pinned sheet or tube, stepped by limits.
struct Cloth {
  PinnedSheet sheet;
  GridTopology topology;
  ClothStepper stepper;

  explicit Cloth(const PinnedSheet& from, double bending_Nm = 0)
      : sheet(from),
        topology(from.layout, from.elastic,
                 bending_Nm > 0 ? Bending(from.layout, from.rest, constant(from.layout, bending_Nm))
                                : Bending()),
        stepper(topology, from.rest, from.points, constant(from.layout, bending_Nm)) {}

  void prepare(double h_s, const ContactResponse& contact = {}) {
    prepareStep(sheet.points, contact, h_s, sheet.step, AddedMass::none);
  }
  void run(int steps) {
    stepper.run(sheet.model().inputs, 0, steps, sheet.position, sheet.velocity);
  }
  const GridLayout& layout() const { return sheet.layout; }
  Vec3 place(int i, int j) const { return at(sheet.position, layout().at(i, j)); }
  double maxStretch() const { return sheet.elastic.maxStretch(sheet.position); }
};

// Fixes rows of a sheet that was built without.
inline void fixRow(PinnedSheet& sheet, int j) {
  for (int i = 0; i < sheet.layout.columns; ++i) sheet.points.free[sheet.layout.at(i, j)] = 0;
}

// Mass per area of cloth that weighs 250 g/m², hung from its last row.
inline PinnedSheet hung(const GridLayout& layout, double size_m, double stiffness_N_per_m) {
  PinnedSheet::Options o;
  o.layout = layout;
  o.width_m = o.height_m = size_m;
  o.stretchU_N_per_m = o.stretchV_N_per_m = stiffness_N_per_m;
  o.shear_N_per_m = 20;
  o.density_kg_per_m2 = 0.25;
  o.drag_Ns_per_m3 = 0.25;
  o.gravity_m_per_s2 = Vec3(0, -9.81, 0);
  o.pinned = false;
  PinnedSheet sheet(o);
  fixRow(sheet, layout.rows - 1);
  return sheet;
}

}  // namespace fascia::test
