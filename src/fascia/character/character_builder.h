#pragma once

#include <memory>

#include <fascia/character/character.h>

namespace fascia {

// Builds a character part by part, each from its own slice of the definition. Parts of the
// character that it was edited from are taken over where neither their slice nor a part that they
// are made of has changed.
class CharacterBuilder {
 public:
  // `before` may be nullptr.
  CharacterBuilder(std::shared_ptr<const CharacterDef> def, double interval_s,
                   const CharacterParts* before);

  // Throws Error with all faults of the definition.
  CharacterParts build();

 private:
  void makeSkeleton();
  void makeFlesh();
  void makeMorphs();
  void makeSoftFlesh();
  void checkSoftness();
  bool keepsSoftFlesh() const;
  bool keepsBindings() const;
  void bindMotions();
  void bindRigMotions();
  void checkRigNames();
  void makeSkin();
  void checkIntegrator();

  const CharacterDef& def() const { return *parts_.def; }

  const CharacterParts* before_;
  CharacterParts parts_;
  Diagnostics diagnostics_;
};

}  // namespace fascia
