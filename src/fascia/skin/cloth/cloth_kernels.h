#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/skin/cloth/cloth_level.h>
#include <fascia/skin/grid/grid_layout.h>
#include <fascia/skin/point/step_inputs.h>

namespace fascia {

// SIMD kernels of the sheet's steps (cloth_stepper.h); dispatched at run time. Rows [begin, end)
// of a level; those of different bands may be swept at the same time.

// What the points of the finest level carry through a step besides their places.
struct ClothMotion {
  // Where the last step has ended, and the velocity there; lie as the finest level's places.
  VectorArray end, velocity;
  // Per row an offset into `tables`: lists of `half` floats, even columns, then odd ones.
  //   share of the velocity that drag leaves; way that gravity's acceleration goes in a step
  //   (s², 0: fixed); of a row with strands: share of a strand's excess taken back, share of its
  //   ends' relative way taken back, rest length.
  std::vector<std::size_t> row;
  std::vector<std::uint8_t> hasStrands;  // per row
  FloatArray tables;
};

// One step, and what stays the same during it.
struct ClothStep {
  const StepInputs* inputs = nullptr;
  const GridLayout* layout = nullptr;
  float step_s = 0;
  float time_s = 0;     // of its end, since the interval's start
  float swing = 0;      // how far the velocity is that of the step's end, see cloth_stepper.h
  float touch_m = 0;    // points as near as that touch the flesh
  bool isLast = false;  // of the interval: its end goes to `position` and `velocity`
  VectorArray* position = nullptr;
  VectorArray* velocity = nullptr;
};

// Takes up the state and the half spaces at an interval's start, and begins its first step.
void clothBegin(const ClothStep& first, std::span<ClothLevel> levels, ClothMotion& motion,
                int begin, int end);
// Adds what the coarser level has changed.
void clothFollow(const ClothLevel& coarser, ClothLevel& level, int begin, int end);
// Diagonals between the rows of the band, or of the one cell row before `begin`.
void clothShear(ClothLevel& level, int begin, int end);
// Sweeps: each row's edges to the row before in the sweep, then those within it, then contact.
// coarser: not null, its changes are added on the way.
void clothSweepDown(const ClothLevel* coarser, ClothLevel& level, float time_s, int begin, int end);
// The edges between the last row of a band and the first of the next, row `first`.
void clothSeam(ClothLevel& level, int first);
void clothSweepUp(ClothLevel& level, float time_s, int begin, int end);
// The same, and what it has made of a coarse level goes to ClothLevel::change.
void clothFinishCoarse(const ClothLevel& finer, ClothLevel& level, float time_s, int begin,
                       int end);
// The same of the finest level, whose points end the step and begin the next one.
void clothFinish(const ClothStep& step, std::span<ClothLevel> levels, ClothMotion& motion,
                 int begin, int end);

}  // namespace fascia
