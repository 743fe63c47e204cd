#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fascia/deformable/puppet/puppet.h>
#include <fascia/deformable/solve/body_stepper.h>
#include <fascia/deformable/solve/body_system.h>
#include <fascia/world/script.h>
#include <fascia/world/stage.h>
#include <fascia/world/trouble.h>

namespace fascia {

// One run of a stage: bodies, characters and the script that drives them, through time. Not
// copyable, as a script that has begun is not; the same stage and seed give the same bits again.
class Performance {
 public:
  // seed 0: the start as the file says; others scatter it. The stage must outlive it. Throws Error
  // with the faults of the script's text.
  explicit Performance(const Stage& stage, std::uint64_t seed = 0);
  Performance(const Performance&) = delete;
  Performance& operator=(const Performance&) = delete;
  ~Performance();

  // One frame: script → bodies, in steps; then the characters. dt_s > 0. Throws Error of the
  // script (file, line, call).
  void advance(double dt_s);

  double time_s() const { return state_.t_s; }
  const OdeState& bodies() const { return state_; }
  std::size_t characterCount() const { return actors_.size(); }
  const CharacterState& character(std::size_t i) const;
  // What moves a character from the next frame on, made for it and outliving the performance;
  // nullptr: the scene's motion again, which is also what it starts with.
  void setSource(std::size_t i, const PostureSource* source);
  const PostureSource& source(std::size_t i) const;
  const BodyStepperStats& bodyStats() const { return stepper_->stats(); }
  // Strings to pull while it runs, by a hand or a program.
  Puppet& puppet() { return *puppet_; }
  // What was wrong with bodies at the start and the ends of frames, and which controls let go.
  std::span<const BodyTrouble> troubles() const { return troubles_.troubles(); }
  // What ties of the scene say twice, or against each other, and how far apart that was at the
  // start.
  std::span<const Redundancy> redundancies() const { return redundancies_; }
  const Script* script() const { return script_.get(); }  // nullptr: the scene has none
  std::uint64_t hash() const;                             // over time, bodies and characters

 private:
  struct Actor;

  void addActor(const SceneCharacterDef& def);
  void addTies();
  void addPuppet();
  void addContacts();
  void addPaths();
  void step(double h_s);
  static void poseAhead(Actor& actor, double time_s);
  void lookForTroubles();
  void restoreCollapsed();

  const Stage& stage_;
  OdeState state_;
  OdeState before_;  // the frame
  BodySystem system_;
  std::unique_ptr<BodyStepper> stepper_;
  std::unique_ptr<Puppet> puppet_;
  std::unique_ptr<Script> script_;
  std::vector<std::unique_ptr<Actor>> actors_;
  std::vector<std::string> obstacles_;  // names of props and characters, as bodies meet them
  TroubleLog troubles_;
  std::vector<Redundancy> redundancies_;
  std::vector<int> collapsedFrames_;  // per body: for how long it has had no volume
  std::size_t letGos_ = 0;            // of the puppet, that are among the troubles
};

}  // namespace fascia
