#pragma once

#include <fascia/render/character_scene.h>
#include <fascia/render/renderer.h>

#include "compare/sheet.h"
#include "compare/views.h"

namespace fascia {

// What the figures stand in.
struct Setting {
  std::shared_ptr<const RigSurface> surface;
  Box reached;  // by the plain rig in the course of its motion: the floor lies below
  double ground_m = 0;
};

// How one picture differs from the others of a film.
struct FilmPicture {
  std::size_t frame = 0;
  double turn = 0;    // [0, 1] around the figure
  double wipe = 0.5;  // where the line is
  Vec3 gone = Vec3::Zero();
};

// Draws pictures of both sides.
class Shooting {
 public:
  Shooting(Sides& sides, MainView view, std::vector<Place> places, Sheet sheet, Setting around);

  // The moment is the shot's frame, measured. Valid until the next call.
  const Pixels& draw(const FilmPicture& shot, const Moment& moment, const std::string& title);

 private:
  Scene sceneOf(Side side) const;
  void render(Scene& scene, const Camera& camera, const Cell& cell, Pixels& pixels);
  std::vector<Mark> marksOn(const Camera& camera, const Cell& cell) const;

  Sides& sides_;
  MainView view_;
  std::vector<Place> places_;
  Sheet sheet_;
  Setting around_;
  Renderer renderer_;
  std::vector<Vec3> middles_;  // of the places, now
  Both<std::vector<Eigen::Vector3f>> points_;
  Both<Pixels> mains_;
  Pixels piece_, picture_;
};

}  // namespace fascia
