#pragma once

#include <string>

// A small rigged file for the program: a closed tube, a metre high, on two joints ("lower",
// "upper"), with the motions "bend" (half a second) and "sway".
std::string riggedGltf();

// A character on it, named tube.gltf, with flesh in both joints.
std::string riggedCharacter();

// A motion capture file of two joints, "Root" and "Tip"; the tip bends.
std::string smallBvh();
