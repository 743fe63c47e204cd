#pragma once

#include <fascia/deformable/body/body_field.h>
#include <fascia/field/field_list.h>
#include <fascia/world/placed_field.h>
#include <fascia/world/stage.h>

namespace fascia {

// What a character of a stage has around it, seen from its own space: the bodies that collide, in
// between the two ends of a frame, and the props.
class StageSurroundings final : public Surroundings {
 public:
  StageSurroundings(const Stage& stage, const Transform& character);

  // The states of the bodies at both ends of the frame that comes; read until the next call.
  void setFrame(const OdeState& from, const OdeState& to) { from_ = &from, to_ = &to; }
  const Field& at(double time_s) override;

 private:
  BodyField bodies_;
  FieldList all_;  // in the scene's space
  PlacedField placed_;
  const OdeState* from_ = nullptr;
  const OdeState* to_ = nullptr;
  OdeState state_;  // at the time asked for
};

}  // namespace fascia
