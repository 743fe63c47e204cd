#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fascia {

// A morph target of an imported skin: a way for its rest shape to change, that a weight says how
// much of is there.
struct MorphDef {
  std::string name;  // unique
  double rest = 0;   // its weight where nothing says otherwise
  bool operator==(const MorphDef&) const = default;
};
// Weights beyond are of no use that anybody has found, and larger ones would be far from the body.
inline constexpr double kMostMorphWeight = 10;

// How much of each morph is there, and how fast that changes: one entry per morph.
struct MorphPose {
  std::vector<double> weights;  // 0: none of it, 1: all
  std::vector<double> rates;    // 1/s
};

// The morphs that a character's skin has. Constant once built.
class Morphs {
 public:
  Morphs() = default;
  explicit Morphs(std::vector<MorphDef> list) : list_(std::move(list)) {}

  std::size_t size() const { return list_.size(); }
  const MorphDef& operator[](std::size_t i) const { return list_[i]; }
  int find(std::string_view name) const;  // -1: none of that name
  bool operator==(const Morphs&) const = default;

  // All at rest, still.
  void rest(MorphPose& out) const;
  // Makes weights fit, whatever they are: one per morph, the missing ones at rest; what is no
  // number at rest; within ±kMostMorphWeight, still at the limits.
  void admit(MorphPose& pose) const;

 private:
  std::vector<MorphDef> list_;
};

}  // namespace fascia
