#include "compare/shooting.h"

namespace fascia {

Shooting::Shooting(Sides& sides, MainView view, std::vector<Place> places, Sheet sheet,
                   Setting around)
    : sides_(sides),
      view_(std::move(view)),
      places_(std::move(places)),
      sheet_(std::move(sheet)),
      around_(std::move(around)) {}

Scene Shooting::sceneOf(Side side) const {
  SceneOptions options;
  options.rig_surface = around_.surface;
  Scene scene;
  addCharacter(sides_.character(), sides_.state(), sides_.surface(side), options,
               sides_.model().size_m(), scene);
  scene.drawables.push_back(groundDisc(around_.reached, around_.ground_m));
  return scene;
}

void Shooting::render(Scene& scene, const Camera& camera, const Cell& cell, Pixels& pixels) {
  scene.camera = camera;
  standLights(scene);
  renderer_.render(scene, cell.width, cell.height, pixels);
}

std::vector<Mark> Shooting::marksOn(const Camera& camera, const Cell& cell) const {
  std::vector<Mark> marks;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Seen seen = seenBy(camera, cell.aspect(), middles_[i]);
    marks.push_back({seen.x, seen.y, places_[i].radius_m * seen.height_per_m});
  }
  return marks;
}

const Pixels& Shooting::draw(const FilmPicture& shot, const Moment& moment,
                             const std::string& title) {
  sides_.seek(shot.frame);
  for (const Side side : kSides) sides_.points(shot.frame, side, points_[side]);
  middles_.clear();
  for (const Place& place : places_) middles_.push_back(place.middle(sides_.model(), points_));
  const Layout& layout = sheet_.layout();
  sheet_.setTitle(title);
  sheet_.begin(picture_);
  Both<std::vector<Mark>> marks;
  for (const Side side : kSides) {
    const Cell& cell = side == Side::plain ? layout.mains.front() : layout.mains.back();
    const Camera camera = view_.camera(cell.aspect(), shot.turn, shot.gone);
    Scene scene = sceneOf(side);
    render(scene, camera, cell, mains_[side]);
    marks[side] = marksOn(camera, cell);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Cell& closer = layout.closer[i][side == Side::plain ? 0 : 1];
      render(scene, closeView(places_[i], middles_[i]), closer, piece_);
      sheet_.addCloser(i, side, piece_, picture_);
    }
  }
  sheet_.addMain(mains_, marks, shot.wipe, picture_);
  sheet_.addFigures(moment, picture_);
  return picture_;
}

}  // namespace fascia
