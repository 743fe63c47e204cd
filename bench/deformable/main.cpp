// fascia_bench_body: linear deformable bodies, their cost and their accuracy. See docs/bodies.md.
#include <cstdio>
#include <exception>

#include <fascia/base/parallel.h>

#include "deformable/tables.h"

int main() {
  try {
    {
      const fascia::ThreadLimit oneThread(1);
      fascia::printCosts();
      fascia::printRealTime();
      fascia::printAccuracy();
      fascia::printStability();
      fascia::printPiles();
    }
    fascia::printThreads();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  return 0;
}
