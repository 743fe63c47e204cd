#pragma once

namespace fascia {

// From here on Ctrl-C and a polite kill end the program at once, whatever it is at, the way the
// signal would have, so that shells and scripts see it; but first what must not stay behind is
// removed: half-written files, other programs at work. To be called before any thread is started.
void watchInterrupts();

// A reader that went away and a file that may grow no more are errors of that write, not our end.
void keepWriteErrors();

// Descriptors 0 to 2 are taken, if only by nothing: else the first files that are opened would be
// standard input and output.
void holdStandardStreams();

// Ends the program as the signal would have.
[[noreturn]] void dieOf(int signal);

}  // namespace fascia
