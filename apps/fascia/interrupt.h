#pragma once

namespace fascia {

// Ctrl-C and a polite kill only raise a flag, so that work stops between frames and every
// half-written file is taken back before the program goes.
void watchInterrupts();

int interruptSignal();  // the signal that came, or 0

// Ends the program the way the signal would have, so that shells and scripts see it.
[[noreturn]] void dieOfInterrupt();

// Thrown where work stops.
struct Interrupted {};

}  // namespace fascia
