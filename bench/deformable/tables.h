#pragma once

namespace fascia {

// Each prints one table.
void printCosts();      // per step, the matrix factored once against in every step
void printRealTime();   // 1000 bodies, every scheme and Bullet where it is installed
void printAccuracy();   // drift, energy, period
void printStability();  // stiffness and mass ratios
void printPiles();      // bodies that collide
void printThreads();    // state hashes over numbers of threads

}  // namespace fascia
