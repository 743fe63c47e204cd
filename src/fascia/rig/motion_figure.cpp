#include <fascia/rig/motion_figure.h>

#include <fascia/base/assert.h>

namespace fascia {

MotionFigure figureOf(const RiggedModel& model, std::size_t motion) {
  FASCIA_ASSERT(motion < model.motions.size(), "the motion exists");
  return {model.joints, model.motions[motion]};
}

void poseFigure(const MotionFigure& figure, std::size_t frame, std::vector<Transform>& world) {
  FASCIA_ASSERT(frame < figure.motion.frameCount(), "the frame exists");
  const std::size_t count = figure.joints.size();
  world.resize(count);
  for (std::size_t j = 0; j < count; ++j) {
    const std::size_t i = frame * count + j;
    const Transform local{figure.motion.rotation[i].cast<double>().toRotationMatrix(),
                          figure.motion.translation_m[i].cast<double>()};
    const int parent = figure.joints[j].parent;
    world[j] = parent < 0 ? local : world[static_cast<std::size_t>(parent)] * local;
  }
}

}  // namespace fascia
