#pragma once

#include <span>
#include <string>
#include <vector>

#include <fascia/deformable/contact/body_contact.h>
#include <fascia/world/stage.h>

namespace fascia {

// What was wrong with a body of a performance, and when. Found at the ends of frames by looking
// afresh, whatever the steps made of it.
struct BodyTrouble {
  enum class Kind {
    insideOut,  // det F is not positive somewhere
    crushed,    // less than a quarter of its volume is left
    sunk,       // in the ground, by more than kDepth of its size
    inside,     // in a prop, a character or another body, by more than kDepth of the smaller size
    restored,   // it had collapsed, and started anew undeformed
    letGo,      // a control let go of it, or it would have squeezed `with` flat: no fault
  };
  static constexpr double kDepth = 0.1, kCrushed = 0.25;

  Kind kind;
  BodyId body;
  std::string with;     // name of what it is inside of, or was about to squeeze
  double from_s, to_s;  // first and last frame
  double worst;         // the depth, m; or the part of the volume that was left
  bool lasts = false;   // it was so in the last frame that was looked at
};

const char* nameOf(BodyTrouble::Kind kind);  // "inside out", …
// "small was 0.12 m deep inside of big from 3.6 s to 3.7 s".
std::string textOf(const Stage& stage, const BodyTrouble& trouble);
// Whether any of them is a fault.
bool anyFault(std::span<const BodyTrouble> troubles);

// The troubles of a performance, so far.
class TroubleLog {
 public:
  static constexpr std::size_t kMost = 1000;  // later ones are left out

  // `obstacles`: their names, by ObstacleId. Without contacts bodies are looked at one by one.
  void look(const Stage& stage, const OdeState& bodies, BodyContacts* contacts,
            std::span<const std::string> obstacles);
  void noteRestored(double time_s, BodyId body);
  void noteLetGo(double time_s, BodyId body, const std::string& squeezed);

  std::span<const BodyTrouble> troubles() const { return troubles_; }

 private:
  void note(BodyTrouble::Kind kind, BodyId body, const std::string& with, double time_s,
            double worst);

  std::vector<BodyTrouble> troubles_;
  std::vector<BodyContacts::Overlap> overlaps_;
  double last_s_ = -1;  // of the look before
};

}  // namespace fascia
