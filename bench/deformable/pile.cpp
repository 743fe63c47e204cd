#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include <fascia/deformable/contact/body_contact.h>

#include "deformable/scenes.h"
#include "deformable/tables.h"

namespace fascia {
namespace {

constexpr double kRadius_m = 0.1, kSpacing_m = 0.26;
constexpr int kFrames = 240, kFramesPerLine = 60;

SolidDef solidOf(bool round) {
  if (round) return {"sphere", {kRadius_m}, {}};
  return {"superellipsoid", {kRadius_m, kRadius_m, kRadius_m, 0.2, 0.2}, {}};
}

struct Pile {
  std::unique_ptr<BodySystem> system;
  OdeState state;
  BodySurfacePtr surface;
};

// Soft solids of 0.2 m and some 4 kg or 8 kg on a lattice above the ground, each turned
// differently.
Pile makePile(int bodies, bool round) {
  Diagnostics diagnostics;
  const Solid solid(solidOf(round), "", diagnostics);
  const auto shape = std::make_shared<BodyShape>(
      BodyDef{makeAffineBasis(3),
              solidMatter(solid, 1000, 0.02, MatterDetail::of(1)),
              {.rigidity_Pa = 3e4, .volume_Pa = 3e4, .relaxation_s = 0.002}});
  BodyModel model;
  for (int i = 0; i < bodies; ++i) model.add(shape);
  Pile pile;
  pile.system = std::make_unique<BodySystem>(std::move(model));
  pile.surface = makeSolidSurface(solid, 16);
  BodyContacts& contacts = pile.system->setContacts({.ground_m = 0});
  pile.state = pile.system->model().restState();
  const int across = static_cast<int>(std::ceil(std::cbrt(bodies / 2.0)));
  for (int i = 0; i < bodies; ++i) {
    contacts.setSurface(BodyId(i), pile.surface);
    const int layer = i / (across * across);
    const Vec3 axis(1, 0.5 * (i % 3), 0.3), shift(0.03 * (layer % 3), 0.2, 0.04 * (layer % 2));
    const Vec3 cell(i % across, layer, i / across % across);
    pile.system->model().place(BodyId(i),
                               {Eigen::AngleAxisd(0.9 * i, axis.normalized()).toRotationMatrix(),
                                kSpacing_m * cell + shift},
                               pile.state);
  }
  return pile;
}

// How deep a vertex of any body is in the ground, m; never negative.
double deepest_m(const Pile& pile) {
  double lowest = 0;
  for (std::size_t b = 0; b < pile.system->model().bodyCount(); ++b)
    for (const Eigen::Vector3f& X : pile.surface->mesh().positions)
      lowest = std::min(
          lowest, pile.system->model().point(pile.state.r, {BodyId(b), X.cast<double>()}).y());
  return std::max(0.0, -lowest);
}

void printPile(int bodies, bool round) {
  Pile pile = makePile(bodies, round);
  BodyStepper stepper(*pile.system);
  BodyStepperStats before;
  for (int frame = 0; frame < kFrames; frame += kFramesPerLine) {
    const std::clock_t begin = std::clock();
    for (int i = 0; i < kFramesPerLine; ++i) stepper.step(1.0 / 60, pile.state);
    const double spent_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    const BodyStepperStats& stats = stepper.stats();
    std::printf("%6d %-7s %5d s %12.2f %12.1f %10zu %8llu %10.4f %12.2g\n", bodies,
                round ? "balls" : "cubes", frame / kFramesPerLine + 1,
                1e3 * spent_s / kFramesPerLine,
                static_cast<double>(stats.iterations - before.iterations) / kFramesPerLine,
                pile.system->contacts()->contacts().size(),
                static_cast<unsigned long long>(stats.halved - before.halved), deepest_m(pile),
                pile.system->model().kineticEnergy_J(pile.state.v) / bodies);
    std::fflush(stdout);
    before = stats;
  }
}

}  // namespace

void printPiles() {
  std::printf("\nSoft bodies that fall into a heap, 60 Hz, a step per frame, implicit Euler\n");
  std::printf("%6s %-7s %7s %12s %12s %10s %8s %10s %12s\n", "bodies", "", "second", "ms/frame",
              "iterations", "contacts", "halved", "deepest m", "J per body");
  for (const int bodies : {100, 1000})
    for (const bool round : {true, false}) printPile(bodies, round);
}

}  // namespace fascia
